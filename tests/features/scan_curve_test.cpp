#include "flirt/features/scan_curve.hpp"

#include "tests/support/numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>

namespace flirt {
namespace {

using ::testing::ElementsAre;

Scan example(double step) {
  return {.beams = {.angle_min = -0.4, .angle_step = step, .range_min = 0.1, .range_max = 20},
          .ranges = {1, nan_value, 2, infinity, 3, 0.05, 25, 4}};
}

TEST(ScanCurve, HoldsTheHitsInOrderOfIncreasingAngle) {
  ScanCurveReader reader;
  for (const double step : {0.1, -0.1}) {
    const Scan scan = example(step);
    const ScanCurve& curve = reader.read(scan, NoReturn::drop);
    const std::vector<BeamPoint> hits = hit_points(scan);
    ASSERT_EQ(curve.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(curve.beams[i], hits[i].beam);
      EXPECT_DOUBLE_EQ(curve.x[i], hits[i].point.x);
      EXPECT_DOUBLE_EQ(curve.y[i], hits[i].point.y);
      EXPECT_EQ(curve.ranges[i], scan.ranges[curve.beams[i]]);
      EXPECT_TRUE(curve.hit[i]);
    }
    EXPECT_FALSE(curve.closed);
  }
}

TEST(ScanCurve, PutsBeamsWithoutReturnAtTheMaximumRangeOnRequest) {
  ScanCurveReader reader;
  Scan scan = example(0.1);
  const ScanCurve& curve = reader.read(scan, NoReturn::at_range_max);
  EXPECT_THAT(curve.beams, ElementsAre(0, 2, 3, 4, 6, 7));
  EXPECT_THAT(curve.ranges, ElementsAre(1, 2, 20, 3, 20, 4));
  EXPECT_THAT(curve.hit, ElementsAre(true, true, false, true, false, true));
  scan.beams.range_max = infinity;
  EXPECT_THAT(reader.read(scan, NoReturn::at_range_max).beams, ElementsAre(0, 2, 4, 6, 7));
}

TEST(ScanCurve, KnowsWhichPointsAreNeighbouringBeams) {
  ScanCurveReader reader;
  Scan scan{.beams = {.angle_min = 0, .angle_step = 0.01, .range_max = 20}, .ranges = {1, 1, 0, 1}};
  const ScanCurve& curve = reader.read(scan, NoReturn::drop);
  EXPECT_TRUE(curve.adjacent(0, 1));
  EXPECT_TRUE(curve.adjacent(1, 0));
  EXPECT_FALSE(curve.adjacent(1, 2));
  EXPECT_FALSE(curve.adjacent(2, 0));
  scan.beams.angle_step = std::numbers::pi / 2;
  EXPECT_TRUE(reader.read(scan, NoReturn::drop).closed);
  EXPECT_TRUE(curve.adjacent(2, 0));
}

TEST(ScanCurve, FollowsAChangeOfTheBeams) {
  ScanCurveReader reader;
  Scan scan{.beams = {.angle_min = 0, .angle_step = 0.1, .range_max = 20}, .ranges = {1, 1, 1}};
  reader.read(scan, NoReturn::drop);
  scan.beams.angle_min = 1.0;
  EXPECT_DOUBLE_EQ(reader.read(scan, NoReturn::drop).x[0], std::cos(1.0));
  scan.ranges.push_back(2.0);
  EXPECT_DOUBLE_EQ(reader.read(scan, NoReturn::drop).x[3], 2.0 * std::cos(1.3));
}

}  // namespace
}  // namespace flirt
