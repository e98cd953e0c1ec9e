#include "flirt/match/verify.hpp"

#include "flirt/core/rng.hpp"

#include "tests/support/numbers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace flirt {
namespace {

/// Distance from a point inside the room −4 ≤ x ≤ 6, −3 ≤ y ≤ 5 to its wall.
double range_in_room(Point2 from, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  double range = std::numeric_limits<double>::infinity();
  if (c > 0.0) { range = std::min(range, (6.0 - from.x) / c); }
  if (c < 0.0) { range = std::min(range, (-4.0 - from.x) / c); }
  if (s > 0.0) { range = std::min(range, (5.0 - from.y) / s); }
  if (s < 0.0) { range = std::min(range, (-3.0 - from.y) / s); }
  return range;
}

Scan scan_of_room(const Pose2& room_from_sensor, const Beams& beams, std::size_t count) {
  Scan scan;
  scan.beams = beams;
  for (std::size_t i = 0; i < count; ++i) {
    scan.ranges.push_back(range_in_room(room_from_sensor.translation(), room_from_sensor.theta + beams.angle(i)));
  }
  return scan;
}

const Beams half_turn{-pi / 2, pi / 360, 0.0, 50.0};
const Beams whole_turn{-pi, pi / 180, 0.0, 50.0};
const Beams clockwise{pi, -pi / 180, 0.0, 50.0};
const Pose2 room_from_reference{0.3, 0.4, 0.2};
const Pose2 room_from_query{0.9, -0.2, 0.7};

TEST(Verify, AcceptsTheTruePoseOfARoom) {
  const Pose2 reference_from_query = inverse(room_from_reference) * room_from_query;
  for (const auto& [beams, count] : {std::pair{whole_turn, 360U}, std::pair{clockwise, 360U}}) {
    const Scan reference = scan_of_room(room_from_reference, beams, count);
    const Scan query = scan_of_room(room_from_query, half_turn, 361);
    const Verification found = verify(query, reference, reference_from_query);
    EXPECT_EQ(found.query_points, 361U);
    EXPECT_EQ(found.line_points, 361U);
    EXPECT_DOUBLE_EQ(found.near_share, 1.0);
    EXPECT_EQ(found.free_points, 0U);
    EXPECT_LT(found.median_line_residual, 1e-9);
    EXPECT_LT(found.mean_line_residual, 0.005);  // lines are rounded at the four corners
  }
}

TEST(Verify, MeasuresAShiftAsItsResidual) {
  const Scan scan = scan_of_room({0, 0, 0}, whole_turn, 360);
  const Verification along_x = verify(scan, scan, {0.08, 0, 0});
  const Verification along_both = verify(scan, scan, {0.06, -0.06, 0});
  EXPECT_NEAR(along_both.median_line_residual, 0.06, 1e-6);
  EXPECT_LT(along_x.mean_line_residual, 0.06) << "two of four walls slide along themselves";
  EXPECT_GT(along_x.mean_line_residual, 0.02);
  EXPECT_LT(verify(scan, scan, {0.25, 0.25, 0}).near_share, 0.2);
}

TEST(Verify, FindsPointsInFreeSpace) {
  const Scan scan = scan_of_room({0, 0, 0}, whole_turn, 360);
  const Verification found = verify(scan, scan, {-1, 0, 0});  // the wall at x = 6 comes to lie at x = 5
  EXPECT_GT(found.free_share, 0.15);
  EXPECT_LT(found.free_share, 0.35);
  EXPECT_LT(verify(scan, scan, {-0.15, 0, 0}).free_share, 0.01) << "within the margin";
  EXPECT_LT(found.near_share, 0.85);
}

TEST(Verify, SaysNothingOfSpaceBehindTheReferenceWalls) {
  Scan reference = scan_of_room({0, 0, 0}, whole_turn, 360);
  for (double& range : reference.ranges) { range = 1.0; }
  const Scan query = scan_of_room({0, 0, 0}, whole_turn, 360);
  const Verification found = verify(query, reference, {});
  EXPECT_EQ(found.free_points, 0U);
  EXPECT_EQ(found.near_points, 0U);
  EXPECT_EQ(found.line_points, 0U);
  EXPECT_EQ(found.median_line_residual, 0.0);
}

TEST(Verify, TakesNoReturnAndInvalidReadingsForNoEvidence) {
  Scan reference = scan_of_room({0, 0, 0}, whole_turn, 360);
  const Scan query = reference;
  for (std::size_t i = 0; i < 360; ++i) {
    reference.ranges[i] = i % 2 == 0 ? 0.0 : std::numeric_limits<double>::quiet_NaN();
  }
  const Verification found = verify(query, reference, {-1, 0, 0});
  EXPECT_EQ(found.query_points, 360U);
  EXPECT_EQ(found.free_points + found.near_points, 0U);
  EXPECT_EQ(verify(reference, query, {}).query_points, 0U);
}

TEST(Verify, LooksAcrossTheSeamOfAFullTurn) {
  const Scan reference = scan_of_room({0, 0, 0}, whole_turn, 360);  // seam at ±π
  Scan query;
  query.beams = {pi - 0.02, 0.01, 0.0, 50.0};
  query.ranges = {4.0, 4.0, 4.0, 4.0, 4.0};
  EXPECT_EQ(verify(query, reference, {}).near_points, 5U);
  for (double& range : query.ranges) { range = 2.0; }
  EXPECT_EQ(verify(query, reference, {}).free_points, 5U);
}

TEST(Verify, KnowsNothingOutsideTheFieldOfView) {
  const Scan reference = scan_of_room({0, 0, 0}, half_turn, 361);
  Scan query;
  query.beams = {pi - 0.02, 0.01, 0.0, 50.0};
  query.ranges = {2.0, 2.0, 2.0};
  EXPECT_EQ(verify(query, reference, {}).free_points, 0U);
}

/// The same counts by comparing all points with all points.
TEST(Verify, FindsTheSameNearPointsAsComparingAllWithAll) {
  Rng rng(1);
  for (int trial = 0; trial < 50; ++trial) {
    Scan reference;
    reference.beams = {rng.uniform(-pi, pi), rng.uniform() < 0.5 ? 0.0175 : -0.0175, 0.0, 50.0};
    for (int i = 0; i < 359; ++i) { reference.ranges.push_back(rng.uniform(0.01, 0.6)); }
    Scan query = reference;
    for (double& range : query.ranges) { range = rng.uniform(0.01, 0.6); }
    const Pose2 reference_from_query{rng.normal(0.0, 0.2), rng.normal(0.0, 0.2), rng.uniform(-pi, pi)};
    const VerifyParams params{.near_distance = 0.01, .line_distance = 0.02};
    std::uint32_t near = 0;
    for (const BeamPoint& q : hit_points(query)) {
      double squared = 1.0;
      for (const BeamPoint& r : hit_points(reference)) {
        squared = std::min(squared, squared_norm(reference_from_query * q.point - r.point));
      }
      near += squared <= 0.01 * 0.01 ? 1U : 0U;
    }
    EXPECT_EQ(verify(query, reference, reference_from_query, params).near_points, near);
  }
}

TEST(Verify, OfEmptyScansIsEmpty) {
  EXPECT_EQ(verify({}, {}, {}).query_points, 0U);
  const Scan scan = scan_of_room({0, 0, 0}, whole_turn, 360);
  EXPECT_EQ(verify(scan, {}, {}).near_points, 0U);
  EXPECT_EQ(verify({}, scan, {}).query_points, 0U);
}

TEST(VerifyParams, DefaultsAreWithinTheirRanges) {
  EXPECT_EQ(out_of_range(VerifyParams{}), "");
}

}  // namespace
}  // namespace flirt
