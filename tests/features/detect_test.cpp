#include "flirt/features/detect.hpp"

#include "flirt/core/rng.hpp"

#include "tests/support/numbers.hpp"
#include "tests/support/print.hpp"
#include "tests/support/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace flirt {
namespace {

using ::testing::IsEmpty;

std::vector<DetectorParams> all_detectors() {
  return {CurvatureParams{}, RangeParams{}, NormalEdgeParams{}, NormalBlobParams{}};
}

/// A room of 8 × 6 m with two cupboards and a pillar.
Scene furnished_room() {
  Scene scene = box({0, 0, 0}, 8.0, 6.0);
  scene = joined(scene, box({-2.5, 1.7, 0.3}, 1.2, 0.7));
  scene = joined(scene, box({2.2, -1.9, -0.8}, 0.9, 1.4));
  return joined(scene, box({1.4, 1.6, 0.1}, 0.5, 0.5));
}

/// The room as 720 beams over a full turn. One beam in 40 has no return.
Scan turn_scan() {
  Scan scan = scan_of(furnished_room(), {-0.4, -0.3, 0.2}, turn_beams(), turn_beam_count);
  for (std::size_t i = 7; i < scan.ranges.size(); i += 40) { scan.ranges[i] = infinity; }
  return scan;
}

/// The room as 541 beams over 270°.
Scan open_scan() {
  const Beams beams{.angle_min = -0.75 * pi, .angle_step = pi / 360, .range_min = 0.05, .range_max = 30};
  return scan_of(furnished_room(), {-0.4, -0.3, 0.2}, beams, 541);
}

/// The same beams recorded by a scanner that turns the other way.
Scan reversed(Scan scan) {
  scan.beams.angle_min = scan.beams.angle(scan.ranges.size() - 1);
  scan.beams.angle_step = -scan.beams.angle_step;
  std::ranges::reverse(scan.ranges);
  return scan;
}

/// The same full turn, begun `shift` beams later.
Scan begun_later(Scan scan, std::size_t shift) {
  scan.beams.angle_min = scan.beams.angle(shift);
  std::ranges::rotate(scan.ranges, scan.ranges.begin() + static_cast<std::ptrdiff_t>(shift));
  return scan;
}

/// Every keypoint of `expected`, moved, is among `found` with the same scale, and the other way around.
void expect_same(const std::vector<Keypoint>& found, const std::vector<Keypoint>& expected,
                 const Pose2& found_from_expected) {
  EXPECT_EQ(found.size(), expected.size());
  for (const Keypoint& keypoint : expected) {
    const Pose2 place = found_from_expected * keypoint.sensor_from_keypoint;
    const bool present = std::ranges::any_of(found, [&](const Keypoint& other) {
      return distance(other.sensor_from_keypoint, place) < 1e-4 &&
             heading_difference(other.sensor_from_keypoint, place) < 1e-4 && other.level == keypoint.level &&
             std::abs(other.support_radius - keypoint.support_radius) < 1e-4F;
    });
    EXPECT_TRUE(present) << "level " << int{keypoint.level} << " at " << place.x << ", " << place.y;
  }
}

class EveryDetector : public testing::TestWithParam<DetectorParams> {};
INSTANTIATE_TEST_SUITE_P(Detect, EveryDetector, testing::ValuesIn(all_detectors()), [](const auto& instance) {
  std::string name(detector_name(instance.param));
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(DetectorNames, LeadToTheDetectorsAndBack) {
  for (const DetectorParams& params : all_detectors()) {
    const auto found = detector_from_name(detector_name(params));
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->index(), params.index());
  }
  EXPECT_FALSE(detector_from_name("curvatur").has_value());
}

TEST_P(EveryDetector, HasParametersInRangeWithDistinctNames) {
  std::visit(
      [](const auto& params) {
        EXPECT_EQ(out_of_range(params), "");
        std::set<std::string> names;
        visit_fields(params, [&](const auto& /*value*/, const flirt::Field& field) {
          EXPECT_TRUE(names.insert(std::string(field.name)).second) << field.name;
        });
        EXPECT_GE(names.size(), 15U);
      },
      GetParam());
}

TEST_P(EveryDetector, FindsKeypointsOnTheCurveInOrder) {
  const Scan scan = open_scan();
  const std::vector<Keypoint> keypoints = detect(scan, GetParam());
  EXPECT_GE(keypoints.size(), 5U);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const Keypoint& keypoint = keypoints[i];
    const double range = scan.ranges[keypoint.beam];
    EXPECT_NEAR(keypoint.sensor_from_keypoint.x, range * std::cos(scan.beams.angle(keypoint.beam)), 1e-9);
    EXPECT_NEAR(keypoint.sensor_from_keypoint.y, range * std::sin(scan.beams.angle(keypoint.beam)), 1e-9);
    EXPECT_GT(keypoint.support_radius, 0.0F);
    if (i > 0) { EXPECT_LE(keypoints[i - 1].level, keypoint.level); }
  }
}

TEST_P(EveryDetector, TurnsWithTheSensor) {
  const std::vector<Keypoint> expected = detect(open_scan(), GetParam());
  for (const double angle : {0.3, 1.7, 3.1, -2.2}) {
    Scan scan = open_scan();
    scan.beams.angle_min += angle;
    expect_same(detect(scan, GetParam()), expected, {0, 0, angle});
  }
}

TEST_P(EveryDetector, DoesNotCareWhichWayTheScannerTurns) {
  expect_same(detect(reversed(open_scan()), GetParam()), detect(open_scan(), GetParam()), {});
  expect_same(detect(reversed(turn_scan()), GetParam()), detect(turn_scan(), GetParam()), {});
}

TEST_P(EveryDetector, DoesNotCareWhereAFullTurnBegins) {
  const std::vector<Keypoint> expected = detect(turn_scan(), GetParam());
  EXPECT_GE(expected.size(), 5U);
  for (const std::size_t shift : {1U, 100U, 237U, 400U, 555U, 719U}) {
    expect_same(detect(begun_later(turn_scan(), shift), GetParam()), expected, {});
  }
}

TEST_P(EveryDetector, SeesTheSameAfterTheSensorTurnsOnTheSpot) {
  const Pose2 map_from_sensor{-0.4, -0.3, 0.2};
  const auto seen = [&](int beams_turned) {
    const Pose2 turned{map_from_sensor.x, map_from_sensor.y, map_from_sensor.theta + beams_turned * pi / 360};
    return detect(scan_of(furnished_room(), turned, turn_beams(), turn_beam_count), GetParam());
  };
  const std::vector<Keypoint> expected = seen(0);
  for (const int turned : {90, 200, 471}) { expect_same(seen(turned), expected, {0, 0, -turned * pi / 360}); }
}

TEST_P(EveryDetector, RepeatsItselfBitByBit) {
  Detector detector(GetParam());
  const std::vector<Scan> scans{open_scan(), turn_scan(), reversed(open_scan())};
  for (int round = 0; round < 2; ++round) {
    for (const Scan& scan : scans) {
      const auto found = detector.detect(scan);
      EXPECT_EQ(std::vector<Keypoint>(found.begin(), found.end()), detect(scan, GetParam()));
    }
  }
}

TEST_P(EveryDetector, TracesWithoutChangingTheResult) {
  DetectorTrace trace;
  const Scan scan = turn_scan();
  EXPECT_EQ(detect(scan, GetParam(), &trace), detect(scan, GetParam()));
  const std::size_t n = hit_points(scan).size();
  EXPECT_EQ(trace.beams.size(), n);
  EXPECT_EQ(trace.points.size(), n);
  EXPECT_EQ(trace.signal.size(), n);
  ASSERT_EQ(trace.scales.size(), 5U);
  const bool curvature = std::holds_alternative<CurvatureParams>(GetParam());
  for (const ScaleTrace& scale : trace.scales) {
    EXPECT_EQ(scale.response.size(), n);
    EXPECT_EQ(scale.smoothed_curve.size(), curvature ? n : 0);
    EXPECT_EQ(scale.smoothed_signal.size(), curvature ? 0 : n);
    for (const std::uint32_t peak : scale.peaks) { EXPECT_GT(std::abs(scale.response[peak]), 0.34); }
  }
}

TEST_P(EveryDetector, ReturnsNothingWhenThereIsNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Beams open{.angle_min = -1, .angle_step = 0.01, .range_min = 0.1, .range_max = 30};
  for (const double value : {0.0, infinity, -infinity, nan, -1.0, 0.05, 31.0}) {
    DetectorTrace trace;
    EXPECT_THAT(detect({.beams = open, .ranges = std::vector<double>(200, value)}, GetParam(), &trace), IsEmpty());
    EXPECT_THAT(trace.beams, IsEmpty());
  }
  EXPECT_THAT(detect({}, GetParam()), IsEmpty());
  for (const std::size_t hits : {1U, 2U}) {
    std::vector<double> ranges(200, infinity);
    for (std::size_t i = 0; i < hits; ++i) { ranges[50 + 100 * i] = 3.0; }
    EXPECT_THAT(detect({.beams = open, .ranges = ranges}, GetParam()), IsEmpty());
    EXPECT_THAT(detect({.beams = turn_beams(), .ranges = ranges}, GetParam()), IsEmpty());
  }
}

TEST_P(EveryDetector, CopesWithAnyNumberOfBeams) {
  Detector detector(GetParam());
  Rng rng(1);
  for (const std::size_t count : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U, 9U, 15U, 16U, 17U, 33U, 180U, 361U, 1081U, 8000U}) {
    for (const double turn : {2.0 * pi, -2.0 * pi, pi}) {
      Scan scan{.beams = {.angle_step = turn / static_cast<double>(count), .range_max = 30}};
      for (std::size_t i = 0; i < count; ++i) { scan.ranges.push_back(rng.uniform(0.0, 33.0)); }
      for (const Keypoint& keypoint : detector.detect(scan)) {
        EXPECT_TRUE(is_finite(keypoint.sensor_from_keypoint));
        ASSERT_LT(keypoint.beam, count);
        EXPECT_EQ(classify(scan.ranges[keypoint.beam], scan.beams), Reading::hit);
      }
    }
  }
}

TEST_P(EveryDetector, SurvivesAbsurdRanges) {
  Scan scan{.beams = {.angle_step = 0.01, .range_max = infinity}, .ranges = std::vector<double>(100, 1e300)};
  for (std::size_t i = 0; i < 100; i += 3) { scan.ranges[i] = 1e-300; }
  for (const Keypoint& keypoint : detect(scan, GetParam())) { EXPECT_LT(keypoint.beam, 100U); }
}

TEST_P(EveryDetector, KeepsAllScalesOnRequest) {
  const auto with_radius = [&](double radius) {
    DetectorParams params = GetParam();
    std::visit([&](auto& alternative) { alternative.selection.duplicate_radius = radius; }, params);
    return detect(turn_scan(), params);
  };
  const std::vector<Keypoint> all = with_radius(0.0);
  const std::vector<Keypoint> some = with_radius(0.2);
  EXPECT_GT(all.size(), some.size());
  for (const Keypoint& a : some) {
    EXPECT_THAT(all, testing::Contains(a));
    for (const Keypoint& b : some) {
      if (!(a == b)) { EXPECT_GE(distance(a.sensor_from_keypoint, b.sensor_from_keypoint), 0.2); }
    }
  }
}

/// Share of the keypoints of `reference` that have one of `other` within half of their scale.
double share_found_again(const std::vector<Keypoint>& reference, const std::vector<Keypoint>& other) {
  const auto found = std::ranges::count_if(reference, [&](const Keypoint& keypoint) {
    return std::ranges::any_of(other, [&](const Keypoint& candidate) {
      return distance(keypoint.sensor_from_keypoint, candidate.sensor_from_keypoint) <
             0.5 * static_cast<double>(keypoint.scale);
    });
  });
  return static_cast<double>(found) / static_cast<double>(reference.size());
}

TEST(CurvatureDetector, FindsNearlyTheSameInAResampledScan) {
  const Scan scan = scan_of(furnished_room(), {-0.4, -0.3, 0.2}, turn_beams(), turn_beam_count);
  const std::vector<Keypoint> keypoints = detect(scan);
  ASSERT_GE(keypoints.size(), 10U);
  Scan half{.beams = scan.beams};
  Scan twice{.beams = scan.beams};
  half.beams.angle_step *= 2.0;
  twice.beams.angle_step /= 2.0;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (i % 2 == 0) { half.ranges.push_back(scan.ranges[i]); }
    twice.ranges.push_back(scan.ranges[i]);
    twice.ranges.push_back(0.5 * (scan.ranges[i] + scan.ranges[(i + 1) % scan.ranges.size()]));
  }
  EXPECT_GE(share_found_again(keypoints, detect(half)), 0.9);
  EXPECT_GE(share_found_again(keypoints, detect(twice)), 0.9);
}

/// A wall with a right-angled corner at distance 3, straight ahead: convex towards the sensor, or concave.
Scan corner_scan(double sign, double noise) {
  const Point2 corner{3.0, 0.0};
  const Scene scene{{{3.0 + sign * 4.0, -4.0}, corner}, {corner, {3.0 + sign * 4.0, 4.0}}};
  Scan scan = scan_of(scene, {}, {.angle_min = -0.6, .angle_step = 0.004, .range_max = 30}, 301);
  Rng rng(4);
  for (double& range : scan.ranges) { range += rng.normal(0.0, noise); }
  return scan;
}

TEST(CurvatureDetector, FindsARightAngledCornerAndPointsInwards) {
  for (const double noise : {0.0, 0.005}) {
    const double tolerance = radians_from_degrees(noise > 0.0 ? 5.0 : 0.5);
    for (const double sign : {1.0, -1.0}) {
      const std::vector<Keypoint> keypoints = detect(corner_scan(sign, noise));
      ASSERT_FALSE(keypoints.empty());
      const Pose2& pose = keypoints.front().sensor_from_keypoint;
      EXPECT_LT(norm(pose.translation() - Point2{3.0, 0.0}), noise > 0.0 ? 0.05 : 0.02);
      EXPECT_LT(std::abs(wrap_angle(pose.theta - (sign > 0.0 ? 0.0 : pi))), tolerance);
      EXPECT_EQ(keypoints.front().level, 0);
      EXPECT_FLOAT_EQ(keypoints.front().scale, 0.2F);
      EXPECT_FLOAT_EQ(keypoints.front().support_radius, 0.4F);
      EXPECT_NEAR(keypoints.front().response, 0.365, 0.004);
    }
  }
}

TEST(CurvatureDetector, FindsNothingOnAStraightWall) {
  const Scan scan =
      scan_of({{{2.0, -40.0}, {2.0, 40.0}}}, {}, {.angle_min = -1.2, .angle_step = 0.005, .range_max = 30}, 481);
  EXPECT_THAT(detect(scan), IsEmpty());
}

TEST(CurvatureDetector, FindsNothingNearTheEndsOfAnOpenScan) {
  const Scan scan = open_scan();
  const std::vector<BeamPoint> hits = hit_points(scan);
  CurvatureParams params;
  params.end_margin = 5.0;
  const std::vector<Keypoint> keypoints = detect(scan, params);
  EXPECT_FALSE(keypoints.empty());
  for (const Keypoint& keypoint : keypoints) {
    const Point2 point = keypoint.sensor_from_keypoint.translation();
    EXPECT_GE(norm(point - hits.front().point), 5.0 * static_cast<double>(keypoint.scale) - 1e-6);
    EXPECT_GE(norm(point - hits.back().point), 5.0 * static_cast<double>(keypoint.scale) - 1e-6);
  }
  params.end_margin = 0.0;
  EXPECT_GT(detect(scan, params).size(), keypoints.size());
}

TEST(CurvatureDetector, GoesOnAcrossDroppedBeamsOrTakesThemAtMaximumRange) {
  Scan scan = corner_scan(1.0, 0.0);
  scan.beams.range_max = 8.0;
  for (std::size_t i = 200; i < 230; ++i) { scan.ranges[i] = infinity; }
  CurvatureParams params;
  const std::vector<Keypoint> dropped = detect(scan, params);
  params.selection.no_return = NoReturn::at_range_max;
  DetectorTrace trace;
  const std::vector<Keypoint> kept = detect(scan, params, &trace);
  EXPECT_EQ(trace.beams.size(), scan.ranges.size());
  EXPECT_NE(dropped, kept);
  for (const Keypoint& keypoint : kept) {
    EXPECT_FALSE(keypoint.beam >= 200 && keypoint.beam < 230) << "no keypoint without a return";
  }
}

TEST(CurvatureDetector, OverSpanningTreesFindsTheSameOnASmoothCurve) {
  // A single tree follows a curve whose neighbours are much nearer than any other points.
  CurvatureParams params;
  const Scan scan = corner_scan(1.0, 0.001);
  const std::vector<Keypoint> by_arc = detect(scan, params);
  params.geodesic = Geodesic::spanning_trees;
  params.spanning_trees = 1;
  expect_same(detect(scan, params), by_arc, {});
}

TEST(CurvatureDetector, OverSpanningTreesTurnsWithTheSensor) {
  CurvatureParams params;
  params.geodesic = Geodesic::spanning_trees;
  const std::vector<Keypoint> expected = detect(open_scan(), params);
  EXPECT_GE(expected.size(), 8U);
  Scan scan = open_scan();
  scan.beams.angle_min += 1.1;
  expect_same(detect(scan, params), expected, {0, 0, 1.1});
}

class SignalDetector : public testing::TestWithParam<DetectorParams> {};
INSTANTIATE_TEST_SUITE_P(Detect, SignalDetector, testing::Values(RangeParams{}, NormalEdgeParams{}, NormalBlobParams{}),
                         [](const auto& instance) {
                           std::string name(detector_name(instance.param));
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST_P(SignalDetector, FindsNothingNearTheEndsOfAnOpenScan) {
  Rng rng(3);
  std::size_t beside = 0;
  for (int round = 0; round < 20; ++round) {  // peaks everywhere
    Scan scan{.beams = {.angle_min = -0.75 * pi, .angle_step = pi / 180, .range_max = 30}};
    for (int i = 0; i < 270; ++i) { scan.ranges.push_back(rng.uniform(2.0, 6.0)); }
    DetectorTrace trace;
    EXPECT_FALSE(detect(scan, GetParam(), &trace).empty());
    for (const ScaleTrace& scale : trace.scales) {
      const auto margin = static_cast<std::size_t>(std::ceil(scale.t));
      for (const std::uint32_t peak : scale.peaks) {
        EXPECT_GT(peak, margin) << "t " << scale.t;
        EXPECT_LT(peak + margin + 1, 270U) << "t " << scale.t;
        beside += peak == margin + 1 || peak + margin + 2 == 270 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(beside, 5U) << "no more than that is left out";
}

/// A post of 0.4 m in front of a wall, 25° to the left of straight ahead; both have their normal straight ahead.
Scan post_scan() {
  const Scene scene{{{4.0, -6.0}, {4.0, 6.0}}, {{2.0, 0.8}, {2.0, 1.2}}};
  return scan_of(scene, {}, {.angle_min = -0.9, .angle_step = 0.01, .range_max = 30}, 181);
}

template <class Params>
void expect_normals_of_post_and_wall(Params params) {
  params.normal.smooth_ranges = false;  // which would bend the normals at the post's sides
  for (const Anchor anchor : {Anchor::keypoint, Anchor::peak}) {
    params.selection.anchor = anchor;
    const std::vector<Keypoint> keypoints = detect(post_scan(), params);
    for (const double surface : {2.0, 4.0}) {
      EXPECT_TRUE(std::ranges::any_of(keypoints, [surface](const Keypoint& keypoint) {
        return std::abs(keypoint.sensor_from_keypoint.x - surface) < 1e-6;
      })) << surface;
    }
    for (const Keypoint& keypoint : keypoints) { EXPECT_NEAR(keypoint.sensor_from_keypoint.theta, 0.0, 1e-6); }
  }
}

TEST(RangeDetector, PointsAlongTheNormalOfTheSurface) {
  expect_normals_of_post_and_wall(RangeParams{});
}

TEST(NormalEdgeDetector, PointsAlongTheNormalOfTheSurface) {
  expect_normals_of_post_and_wall(NormalEdgeParams{});
}

/// A right-angled corner at distance 3, straight ahead, whose walls have the normals turn ± 45°.
Scan turned_corner_scan(double turn) {
  const Scene corner{{{0.0, 0.0}, {4.0, -4.0}}, {{0.0, 0.0}, {4.0, 4.0}}};
  return scan_of(moved(corner, {3.0, 0.0, turn}), {}, {.angle_min = -0.6, .angle_step = 0.004, .range_max = 30}, 301);
}

TEST(NormalEdgeDetector, PointsBetweenTheNormalsOfACorner) {
  for (const double turn : {-0.3, 0.0, 0.3}) {
    DetectorTrace trace;
    const std::vector<Keypoint> keypoints = detect(turned_corner_scan(turn), NormalEdgeParams{}, &trace);
    ASSERT_EQ(keypoints.size(), 1U);
    const Keypoint& keypoint = keypoints.front();
    const auto point = std::ranges::find(trace.beams, keypoint.beam) - trace.beams.begin();
    const double normal = wrap_angle(trace.signal[static_cast<std::size_t>(point)]);
    EXPECT_NEAR(keypoint.sensor_from_keypoint.theta, normal, 1e-12);
    EXPECT_LT(std::abs(normal - turn), pi / 4) << "between those of the walls";
  }
}

TEST(NormalBlobDetector, PointsAlongTheNormalsOfBothSidesOfACorner) {
  NormalBlobParams params;
  params.peaks.threshold = 0.1;
  params.selection.duplicate_radius = 0.0;
  params.normal.smooth_ranges = false;
  for (const double turn : {-0.3, 0.0, 0.3}) {
    const std::vector<Keypoint> keypoints = detect(turned_corner_scan(turn), params);
    EXPECT_GE(keypoints.size(), 10U) << "both sides on five scales";
    for (const Keypoint& keypoint : keypoints) {
      const Pose2& pose = keypoint.sensor_from_keypoint;
      EXPECT_NEAR(pose.theta, turn + (pose.y < 0.0 ? pi / 4 : -pi / 4), 1e-6);
    }
  }
}

TEST(NormalEdgeDetector, FindsTheCornerWhereTheNormalTurns) {
  for (const double sign : {1.0, -1.0}) {
    const std::vector<Keypoint> keypoints = detect(corner_scan(sign, 0.0), NormalEdgeParams{});
    ASSERT_FALSE(keypoints.empty());
    EXPECT_LT(norm(keypoints.front().sensor_from_keypoint.translation() - Point2{3.0, 0.0}), 0.05);
  }
}

TEST(NormalBlobDetector, FindsBothSidesOfTheCornerWhereTheTurnBeginsAndEnds) {
  NormalBlobParams params;
  params.peaks.threshold = 0.1;
  DetectorTrace trace;
  EXPECT_FALSE(detect(corner_scan(1.0, 0.0), params, &trace).empty());
  const ScaleTrace& finest = trace.scales.front();
  ASSERT_EQ(finest.peaks.size(), 2U);
  EXPECT_EQ(trace.beams[finest.peaks[0]] + trace.beams[finest.peaks[1]], 300U);  // symmetric about beam 150
  EXPECT_LT(finest.response[finest.peaks[0]] * finest.response[finest.peaks[1]], 0.0);
}

}  // namespace
}  // namespace flirt
