#include "flirt/registration/search.hpp"

#include "rooms.hpp"
#include "tests/support/print.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace flirt {
namespace {

using rooms::asymmetric_room;
using rooms::evidence_of;
using rooms::moved;
using rooms::scan_of;
using rooms::walk;

constexpr double half_turn = std::numbers::pi;
constexpr double full_turn = 2 * std::numbers::pi;

class SearchInARoom : public testing::TestWithParam<Pose2> {};

TEST_P(SearchInARoom, FindsThePoseForHalfAndFullTurns) {
  const Pose2 map_from_room = GetParam();
  const auto walls = moved(asymmetric_room(), map_from_room);
  const MapFields fields = map_fields(evidence_of(walls, walk(map_from_room)));
  Rng rng(11);
  for (const double field_of_view : {half_turn, full_turn}) {
    for (const Pose2& room_from_sensor : {Pose2{3.1, 3.3, 0.4}, Pose2{6.2, 1.4, 2.9}, Pose2{1.7, 3.9, -1.1}}) {
      const Pose2 truth = map_from_room * room_from_sensor;
      const auto found = search(fields, scan_of(walls, truth, field_of_view, &rng));
      ASSERT_FALSE(found.empty());
      EXPECT_LT(distance(found[0].map_from_sensor, truth), 0.03) << field_of_view;
      EXPECT_LT(heading_difference(found[0].map_from_sensor, truth), radians_from_degrees(0.7)) << field_of_view;
      EXPECT_GT(found[0].score.likelihood, 0.8);
      EXPECT_LT(found[0].score.through, 0.05);
      if (found.size() > 1) { EXPECT_GT(found[0].score.preference - found[1].score.preference, 1.0); }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(WhereverTheMapIs, SearchInARoom,
                         testing::Values(Pose2{0, 0, 0}, Pose2{576.3, -41.7, 0}, Pose2{-12, 7, 0.6}));

TEST(Search, GivesBothModesOfTwinRoomsEqualScores) {
  // The second room a whole number of coarse cells away: the same cells, so the same score.
  const Pose2 map_from_twin{0, 12.8, 0};
  auto walls = asymmetric_room();
  EvidenceGrid grid;
  for (const Pose2& pose : walk({})) {
    const Scan scan = scan_of(walls, pose, full_turn);
    grid.add(scan, pose);
    grid.add(scan, map_from_twin * pose);
  }
  const Pose2 truth{3.1, 3.3, 0.4};
  const auto found = search(map_fields(grid), scan_of(walls, truth, half_turn));
  ASSERT_GE(found.size(), 2U);
  const bool first_is_twin = distance(found[0].map_from_sensor, truth) > 1;
  const Pose2 here = found[first_is_twin ? 1 : 0].map_from_sensor;
  const Pose2 there = found[first_is_twin ? 0 : 1].map_from_sensor;
  EXPECT_LT(distance(here, truth), 0.04);
  EXPECT_LT(distance(there, map_from_twin * truth), 0.04);
  EXPECT_NEAR(found[0].score.preference, found[1].score.preference, 0.1);
}

TEST(Search, OnePersonDoesNotVeto) {
  const auto walls = asymmetric_room();
  const MapFields fields = map_fields(evidence_of(walls, walk({})));
  const Pose2 truth{3.1, 3.3, 0.4};
  Scan scan = scan_of(walls, truth, half_turn);
  for (std::size_t i = 60; i < 90; ++i) { scan.ranges[i] = std::min(scan.ranges[i], 0.9); }
  const auto found = search(fields, scan);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(distance(found[0].map_from_sensor, truth), 0.03);
}

TEST(Search, AnswersNothingWithoutPointsOrWithoutAMap) {
  const auto walls = asymmetric_room();
  const MapFields fields = map_fields(evidence_of(walls, walk({})));
  EXPECT_TRUE(search(fields, Scan{}).empty());
  Scan blind{.beams = {0, 0.1, 0, 50}, .ranges = std::vector<double>(30, std::numeric_limits<double>::quiet_NaN())};
  EXPECT_TRUE(search(fields, blind).empty());
  EXPECT_TRUE(search(map_fields(EvidenceGrid{}), scan_of(walls, {3, 3, 0}, half_turn)).empty());
}

TEST(Search, TakesScansOfAFewPoints) {
  const MapFields fields = map_fields(evidence_of(asymmetric_room(), walk({})));
  const Scan one{.beams = {0, 0.1, 0, 50}, .ranges = {2.0}};
  for (const ScoredPose& pose : search(fields, one)) {
    EXPECT_TRUE(is_finite(pose.map_from_sensor));
    EXPECT_TRUE(pose.covariance.allFinite());
  }
}

TEST(Search, FinalistsAreThoseOfHeatsThatLeaveNothingOut) {
  const auto walls = asymmetric_room();
  const MapFields fields = map_fields(evidence_of(walls, walk({})));
  const ScanPoints points = scan_points(scan_of(walls, {3.1, 3.3, 0.4}, half_turn));
  SearchParams params;
  params.refined = 20;
  params.first_heat_points = params.second_heat_points = 1000;  // all
  params.heat_rays = 1000;
  const std::vector<CoarsePose> coarse = dense_search(fields, points, params.dense);
  const EvidenceScorer scorer(fields, params.score);
  const RefineParams one_step{.iterations = 1};
  const auto drawn = [&](const std::vector<Pose2>& poses, bool beams_count, std::size_t most) {
    std::vector<std::pair<double, Pose2>> valued;
    for (const Pose2& start : poses) {
      const Pose2 pose = refined_pose(fields, points, start, one_step);
      const EvidenceScore score = beams_count ? scorer.score(points, pose) : scorer.score_of_end_points(points, pose);
      valued.emplace_back(score.preference, pose);
    }
    std::ranges::stable_sort(valued, std::ranges::greater{}, &std::pair<double, Pose2>::first);
    std::vector<Pose2> best;
    for (std::size_t i = 0; i < std::min(most, valued.size()); ++i) { best.push_back(valued[i].second); }
    return best;
  };
  std::vector<Pose2> starts;
  for (const CoarsePose& pose : coarse) { starts.push_back(pose.map_from_sensor); }
  const std::vector<Pose2> slow = drawn(drawn(starts, false, params.second_heat), true, params.refined);
  const std::vector<Pose2> quick = finalists(fields, points, coarse, params);
  ASSERT_EQ(quick.size(), 20U);
  for (std::size_t i = 0; i < quick.size(); ++i) { EXPECT_LT(distance(quick[i], slow[i]), 1e-9) << i; }
}

TEST(Search, FinalistsFindATruthThatIsFarDownTheCoarseList) {
  const auto walls = asymmetric_room();
  const MapFields fields = map_fields(evidence_of(walls, walk({})));
  const Pose2 truth{3.1, 3.3, 0.4};
  const ScanPoints points = scan_points(scan_of(walls, truth, half_turn));
  SearchParams params;
  params.refined = 5;
  std::vector<CoarsePose> coarse = dense_search(fields, points, params.dense);
  std::ranges::reverse(coarse);  // the order must not matter
  ASSERT_GT(coarse.size(), params.second_heat);
  const std::vector<Pose2> found = finalists(fields, points, coarse, params);
  ASSERT_EQ(found.size(), 5U);
  EXPECT_LT(distance(found[0], truth), 0.06);
  EXPECT_LT(heading_difference(found[0], truth), radians_from_degrees(1));
}

TEST(Search, ThereAreNoMoreFinalistsThanCoarsePoses) {
  const auto walls = asymmetric_room();
  const MapFields fields = map_fields(evidence_of(walls, walk({})));
  const ScanPoints points = scan_points(scan_of(walls, {3.1, 3.3, 0.4}, half_turn));
  const std::vector<CoarsePose> three{{{3, 3, 0}}, {{2, 4, 1}}, {{6, 2, 2}}};
  EXPECT_EQ(finalists(fields, points, three).size(), 3U);
  EXPECT_TRUE(finalists(fields, points, {}).empty());
}

}  // namespace
}  // namespace flirt
