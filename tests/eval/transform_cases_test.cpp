#include "flirt/eval/transform_cases.hpp"

#include "flirt/eval/revisit.hpp"

#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace flirt {
namespace {

/// Scans of the furnished room from poses on two circles.
ScanLog room_log() {
  ScanLog log;
  for (const double radius : {0.5, 2.0}) {
    for (const Pose2& pose : poses_around(radius, 6)) {
      log.scans.push_back(scan_of(furnished_room(), pose, turn_beams(), turn_beam_count));
      log.map_from_robot.push_back(pose);
    }
  }
  return log;
}

TEST(DrawLocations, GivesDifferentScansAndLongerListsBeginWithShorterOnes) {
  const ScanLog log = room_log();
  const auto few = draw_locations(log, 2, 4, 11);
  const auto many = draw_locations(log, 2, 100, 11);
  EXPECT_EQ(many.size(), log.scans.size());
  std::set<std::size_t> scans;
  for (const Location& location : many) {
    EXPECT_EQ(location.log, 2U);
    scans.insert(location.scan);
  }
  EXPECT_EQ(scans.size(), many.size());
  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
  EXPECT_NE(draw_locations(log, 2, 100, 12), many);
}

TEST(DrawLocations, PassesOverScansThatSeeNothing) {
  ScanLog log = room_log();
  for (double& range : log.scans[3].ranges) { range = 0; }
  for (const Location& location : draw_locations(log, 0, 100, 1)) { EXPECT_NE(location.scan, 3U); }
}

TEST(CasesOf, PutsEachOtherScanAtTheLevelOfItsOverlap) {
  const ScanLog log = room_log();
  const auto conditions = paper_conditions();
  const auto cases = cases_of(log, {0, 0}, conditions, {});
  std::size_t expected = 0;
  for (std::size_t i = 1; i < log.scans.size(); ++i) {
    const double share = overlap(points_of(log.scans[0], {}), log.map_from_sensor(0), points_of(log.scans[i], {}),
                                 log.map_from_sensor(i), 0.1);
    expected += share >= 0.45 && share < 0.95 ? 1 : 0;
  }
  std::size_t seen = 0;
  for (const TransformCase& one : cases) {
    if (conditions[one.condition].transform != ScanTransform::viewpoint) { continue; }
    ++seen;
    const double share =
        overlap(points_of(log.scans[0], {}), {}, points_of(one.scan, {}), one.reference_from_sensor, 0.1);
    EXPECT_NEAR(share, conditions[one.condition].level, 0.0501);
  }
  EXPECT_EQ(seen, expected);
  EXPECT_GT(seen, 2U);
}

TEST(CasesOf, DrawsAtMostSoManyPartners) {
  const ScanLog log = room_log();
  const std::vector<Condition> all{{ScanTransform::viewpoint, 0.5}};
  const TransformParams params{.overlap_half_width = 0.6, .partners = 3};
  EXPECT_EQ(cases_of(log, {0, 0}, all, {.overlap_half_width = 0.6}).size(), log.scans.size() - 1);
  EXPECT_EQ(cases_of(log, {0, 0}, all, params).size(), 3U);
}

TEST(CasesOf, ChangesTheReferenceItselfInTheOtherWays) {
  const ScanLog log = room_log();
  const std::vector<Condition> conditions{
      {ScanTransform::noise, 0.1}, {ScanTransform::subsampling, 3}, {ScanTransform::oversampling, 4}};
  const auto cases = cases_of(log, {0, 5}, conditions, {});
  ASSERT_EQ(cases.size(), 3U);
  EXPECT_EQ(cases[0].scan.ranges.size(), turn_beam_count);
  EXPECT_NE(cases[0].scan.ranges, log.scans[5].ranges);
  EXPECT_EQ(cases[1].scan.ranges.size(), turn_beam_count / 3);
  EXPECT_EQ(cases[2].scan.ranges.size(), turn_beam_count * 4);
  for (const TransformCase& one : cases) { EXPECT_EQ(one.reference_from_sensor, Pose2{}); }
}

}  // namespace
}  // namespace flirt
