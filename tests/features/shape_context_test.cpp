#include "flirt/features/shape_context.hpp"

#include "tests/support/numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace flirt {
namespace {

using testing::Each;

/// Bins reach from 0.1 to 0.5 m in steps of 0.1; angular bins of 90° start at −180°.
ShapeContextParams four_by_four() {
  ShapeContextParams params;
  params.angular_bins = 4;
  params.inner_radius = 0.1;
  return params;
}

std::vector<std::uint32_t> count(const Scan& scan, const Pose2& sensor_from_keypoint,
                                 const ShapeContextParams& params) {
  BeamFan fan;
  fan.assign(scan, NoReturnMeaning::ignored);
  ShapeContext shape(params);
  shape.count(fan, Keypoint{sensor_from_keypoint, 0.2F, 0.4F, 0, 0, 0});
  return {shape.points().begin(), shape.points().end()};
}

/// Beams 0.1 rad apart, the first straight ahead.
Scan scan_of(std::vector<double> ranges) {
  Scan scan;
  scan.beams = {0.0, 0.1, 0.0, 50.0};
  scan.ranges = std::move(ranges);
  return scan;
}

std::vector<std::uint32_t> one_at(std::size_t bin) {
  std::vector<std::uint32_t> counts(16);
  counts[bin] = 1;
  return counts;
}

TEST(ShapeContext, CountsAPointInItsBin) {
  EXPECT_EQ(count(scan_of({2.2}), {2.0, -0.25, 0.0}, four_by_four()), one_at(2 * 4 + 2));       // ahead, left, 0.32 m
  EXPECT_EQ(count(scan_of({1.8}), {2.0, -0.25, 0.0}, four_by_four()), one_at(3 * 4 + 2));       // behind, left
  EXPECT_EQ(count(scan_of({1.8}), {2.0, 0.05, 0.0}, four_by_four()), one_at(0 * 4 + 1));        // behind, right, 0.21 m
  EXPECT_EQ(count(scan_of({2.2}), {2.0, 0.05, 0.0}, four_by_four()), one_at(1 * 4 + 1));        // ahead, right
  EXPECT_EQ(count(scan_of({2.2}), {2.0, 0.05, -0.5 * pi}, four_by_four()), one_at(2 * 4 + 1));  // the same, turned
}

TEST(ShapeContext, LeavesOutTheKeypointItselfAndWhatIsFar) {
  EXPECT_THAT(count(scan_of({2.0}), {2.0, 0.0, 0.0}, four_by_four()), Each(0U));
  EXPECT_THAT(count(scan_of({2.0}), {2.099, 0.0, 0.0}, four_by_four()), Each(0U));
  EXPECT_THAT(count(scan_of({2.0}), {2.501, 0.0, 0.1}, four_by_four()), Each(0U));
}

TEST(ShapeContext, PassingBeamsDoNotCount) {
  EXPECT_THAT(count(scan_of({10.0}), {2.0, -0.25, 0.0}, four_by_four()), Each(0U));
}

TEST(ShapeContext, OnlyReturnsCount) {
  for (const double nothing : {0.0, 50.0, -2.2, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(count(scan_of({nothing}), {2.0, -0.25, 0.0}, four_by_four()), Each(0U)) << nothing;
  }
}

TEST(ShapeContext, RadiusFollowsTheSupportRegionOnRequest) {
  ShapeContextParams params = four_by_four();
  params.radius_rule = RadiusRule::support;
  params.radius_factor = 2.0;  // of 0.4 m: rings of 0.175 m
  EXPECT_EQ(count(scan_of({2.7}), {2.0, -0.1, 0.0}, params), one_at(2 * 4 + 3));
}

TEST(ShapeContext, EveryPointWithinReachIsCountedOnce) {
  std::vector<double> ranges;
  for (int i = 0; i < 60; ++i) { ranges.push_back(1.0 + 0.01 * i); }
  const Scan scan = scan_of(ranges);
  ShapeContextParams params;
  for (const BeamPoint& at : hit_points(scan)) {
    std::size_t expected = 0;
    for (const BeamPoint& other : hit_points(scan)) {
      const double away = norm(other.point - at.point);
      expected += static_cast<std::size_t>(away >= params.inner_radius && away < params.radius);
    }
    std::size_t counted = 0;
    for (const std::uint32_t points : count(scan, {at.point.x, at.point.y, 0.3}, params)) { counted += points; }
    EXPECT_EQ(counted, expected);
  }
}

}  // namespace
}  // namespace flirt
