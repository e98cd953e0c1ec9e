#include "flirt/slam/scan_overlap.hpp"

#include "tests/slam/buildings.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>
#include <set>
#include <utility>

namespace flirt {
namespace {

/// 2 m of wall, 1 m ahead of the robot, facing it.
SurfacePoints wall_ahead() {
  SurfacePoints points;
  for (int i = 0; i <= 20; ++i) {
    points.x.push_back(1);
    points.y.push_back(-1 + 0.1F * static_cast<float>(i));
    points.normal_x.push_back(-1);
    points.normal_y.push_back(0);
  }
  return points;
}

bool are_partners(const Pose2& first, const Pose2& second) {
  // Far-away poses in between, so that the two are not neighbours in time.
  const std::vector<Pose2> poses{first, {100, 0, 0}, {200, 0, 0}, {300, 0, 0}, second};
  const std::vector<ScanPair> pairs = overlapping_pairs(poses, std::vector<SurfacePoints>(5, wall_ahead()), 4);
  return std::ranges::any_of(pairs, [](const ScanPair& pair) { return pair.a == 0 && pair.b == 4; });
}

TEST(OverlappingPairs, SeeTheSameSurfaceFromWhereverTheyAre) {
  EXPECT_TRUE(are_partners({}, {0.02, 0, 0}));
  EXPECT_TRUE(are_partners({}, {0.02, 0.7, 0}));
  EXPECT_FALSE(are_partners({}, {0, 5, 0}));
  EXPECT_FALSE(are_partners({}, {0, 0, 1}));
}

TEST(OverlappingPairs, DoNotSeeAWallFromItsTwoSides) {
  EXPECT_FALSE(are_partners({}, {2, 0, std::numbers::pi}));
}

TEST(OverlappingPairs, AreNeighboursInTimeAndOtherVisits) {
  constexpr std::size_t most = 4;
  const std::vector<Pose2>& poses = short_drive().map_from_robot;
  const std::vector<ScanPair> pairs = overlapping_pairs(poses, points_of(short_drive_scans()), most);
  std::vector<std::vector<std::uint32_t>> others(poses.size());
  std::set<std::pair<std::uint32_t, std::uint32_t>> known;
  for (const ScanPair& pair : pairs) {
    ASSERT_LT(pair.a, pair.b);
    EXPECT_TRUE(known.insert({pair.a, pair.b}).second);
    if (pair.b - pair.a > 3) { others[pair.b].push_back(pair.a); }
  }
  for (std::uint32_t b = 1; b < poses.size(); ++b) { EXPECT_TRUE(known.contains({b - 1, b})); }
  EXPECT_EQ(std::ranges::max(others, {}, [](const auto& of_scan) { return of_scan.size(); }).size(), most);
  for (std::vector<std::uint32_t>& of_scan : others) {
    std::ranges::sort(of_scan);
    for (std::size_t i = 1; i < of_scan.size(); ++i) { EXPECT_GE(of_scan[i] - of_scan[i - 1], 4U); }
  }
}

/// Poses that take turns, so that the robot moves and sees the same.
std::vector<Pose2> to_and_fro(std::size_t count) {
  std::vector<Pose2> poses(count);
  for (std::size_t i = 1; i < count; i += 2) { poses[i].y = 0.06; }
  return poses;
}

TEST(OverlappingPairs, AreNotSoughtWithEveryVisitOfManyToOnePlace) {
  constexpr std::size_t visits = 400;
  const std::vector<ScanPair> pairs =
      overlapping_pairs(to_and_fro(visits), std::vector<SurfacePoints>(visits, wall_ahead()), 4);
  std::size_t late = 0;
  for (const ScanPair& pair : pairs) {
    if (pair.b - pair.a <= 3) { continue; }
    EXPECT_LE(pair.a, 100U);
    late += pair.b > 300 ? 1 : 0;
  }
  EXPECT_EQ(late, 4 * 99U);
}

TEST(OverlappingPairs, AreOneForEachScanOfARobotThatStands) {
  const std::vector<Pose2> poses{{}, {0.02, 0, 0.02}, {0.031, 0, 3.14}, {0.05, 0, -3.14}, {0.04, 0, -3.1}};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
  for (const ScanPair& pair : overlapping_pairs(poses, std::vector<SurfacePoints>(5, wall_ahead()), 4)) {
    found.emplace_back(pair.a, pair.b);
  }
  using testing::Pair;
  EXPECT_THAT(found, testing::ElementsAre(Pair(0, 1), Pair(0, 2), Pair(2, 3), Pair(0, 4), Pair(2, 4)));
}

}  // namespace
}  // namespace flirt
