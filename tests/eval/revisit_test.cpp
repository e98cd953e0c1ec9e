#include "flirt/eval/revisit.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace flirt {
namespace {

/// Scans of the inside of a square room of side 8 m around the origin, seen from `poses`.
ScanLog square_room(const std::vector<Pose2>& poses) {
  ScanLog log;
  for (const Pose2& pose : poses) {
    Scan scan{.beams = {-std::numbers::pi, std::numbers::pi / 180, 0, 50}};
    for (std::size_t i = 0; i < 360; ++i) {
      const double angle = pose.theta + scan.beams.angle(i);
      const double to_x = (std::cos(angle) > 0 ? 4 - pose.x : 4 + pose.x) / std::abs(std::cos(angle));
      const double to_y = (std::sin(angle) > 0 ? 4 - pose.y : 4 + pose.y) / std::abs(std::sin(angle));
      scan.ranges.push_back(std::min(to_x, to_y));
    }
    log.scans.push_back(scan);
    log.map_from_robot.push_back(pose);
  }
  return log;
}

TEST(TravelNeighbours, CountsPathNotDistance) {
  std::vector<Pose2> there_and_back;
  for (int i = 0; i <= 10; ++i) { there_and_back.push_back({static_cast<double>(i), 0, 0}); }
  for (int i = 9; i >= 0; --i) { there_and_back.push_back({static_cast<double>(i), 0, 0}); }
  const auto intervals = travel_neighbours(square_room(there_and_back), 3.0);
  EXPECT_EQ(intervals.front(), (ScanInterval{0, 4}));
  EXPECT_EQ(intervals[10], (ScanInterval{7, 14}));
  EXPECT_EQ(intervals.back(), (ScanInterval{17, 21}));
}

TEST(Overlap, EqualsThePlainLoop) {
  Rng rng(2);
  std::vector<Point2> query(200);
  std::vector<Point2> reference(300);
  for (Point2& point : query) { point = {rng.uniform(-3, 3), rng.uniform(-3, 3)}; }
  for (Point2& point : reference) { point = {rng.uniform(-3, 3), rng.uniform(-3, 3)}; }
  const Pose2 map_from_query{1, 2, 0.3};
  const Pose2 map_from_reference{1.5, 1.5, -2.5};
  std::size_t covered = 0;
  for (const Point2 q : query) {
    bool near = false;
    for (const Point2 r : reference) { near = near || norm(map_from_query * q - map_from_reference * r) <= 0.1; }
    covered += near ? 1 : 0;
  }
  ASSERT_GT(covered, 10U);
  EXPECT_DOUBLE_EQ(overlap(query, map_from_query, reference, map_from_reference, 0.1),
                   static_cast<double>(covered) / 200.0);
  EXPECT_EQ(overlap({}, {}, reference, {}, 0.1), 0);
}

TEST(Answerable, NeedsAnOldScanOfTheSamePlace) {
  std::vector<Pose2> loop;
  for (int i = 0; i < 40; ++i) { loop.push_back({std::cos(0.314 * i), std::sin(0.314 * i), 0.1 * i}); }
  const ScanLog log = square_room(loop);
  const std::vector<std::size_t> queries = {0, 20, 39};
  // The path is about 12 m long: with 10 m removed scan 20 keeps nothing, the ends see each other.
  EXPECT_EQ(answerable(log, queries, {}, 1), (std::vector<bool>{true, false, true}));
  EXPECT_EQ(answerable(log, queries, {.travel = 20}, 2), (std::vector<bool>{false, false, false}));
  ScanLog blind = log;
  blind.scans[0].ranges.assign(360, 81.83);
  EXPECT_EQ(answerable(blind, queries, {}, 1), (std::vector<bool>{false, false, true}));
}

TEST(Answerable, AReadingThatIsNoReturnIsNoneWhateverItsLength) {
  std::vector<Pose2> loop;
  for (int i = 0; i < 40; ++i) { loop.push_back({std::cos(0.314 * i), std::sin(0.314 * i), 0.1 * i}); }
  loop.back() = loop.front();
  ScanLog log = square_room(loop);
  const std::vector<std::size_t> queries = {0, 39};
  for (Scan& scan : log.scans) { scan.beams.range_max = 30; }
  EXPECT_EQ(answerable(log, queries, {}, 1), (std::vector<bool>{true, true}));
  for (Scan& scan : log.scans) { std::ranges::fill(scan.ranges, 30.0); }  // as this scanner says that it sees nothing
  EXPECT_EQ(answerable(log, queries, {}, 1), (std::vector<bool>{false, false}));
}

}  // namespace
}  // namespace flirt
