#include "flirt/features/describe.hpp"

#include "flirt/core/rng.hpp"

#include "tests/support/numbers.hpp"
#include "tests/support/print.hpp"
#include "tests/support/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flirt {
namespace {

/// A room with a pillar and a niche, none of it parallel to the axes.
Scene room() {
  const std::vector<Point2> corners{{-4, -3}, {3.5, -3.3}, {4.2, 1.0}, {2.0, 1.2}, {2.1, 2.9}, {-3.8, 3.1}};
  return joined(polygon(corners), box({1.2, -1.1, 0.4}, 0.5, 0.4));
}

Keypoint keypoint_at(const Pose2& sensor_from_keypoint) {
  Keypoint keypoint;
  keypoint.sensor_from_keypoint = sensor_from_keypoint;
  keypoint.support_radius = 0.4F;
  return keypoint;
}

/// Keypoints on the corners of the room, in the frame of a sensor at `map_from_sensor`.
std::vector<Keypoint> corner_keypoints(const Pose2& map_from_sensor) {
  std::vector<Keypoint> keypoints;
  double direction = 0.3;
  for (const Wall& wall : room()) {
    const Pose2 map_from_keypoint{wall.begin.x, wall.begin.y, wrap_angle(direction)};
    keypoints.push_back(keypoint_at(inverse(map_from_sensor) * map_from_keypoint));
    direction += 0.7;
  }
  return keypoints;
}

/// Keypoints every few beams, whatever they lie on.
std::vector<Keypoint> keypoints_along(const Scan& scan, std::size_t every) {
  std::vector<Keypoint> keypoints;
  for (const BeamPoint& at : hit_points(scan)) {
    if (at.beam % every == 0) { keypoints.push_back(keypoint_at({at.point.x, at.point.y, 0.1 * at.beam - 3.0})); }
  }
  return keypoints;
}

double largest_difference(const Descriptors& a, const Descriptors& b) {
  double largest = a.rows.size() == b.rows.size() ? 0.0 : infinity;
  for (std::size_t i = 0; i < std::min(a.rows.size(), b.rows.size()); ++i) {
    largest = std::max(largest, static_cast<double>(std::abs(a.rows[i] - b.rows[i])));
  }
  return largest;
}

void expect_proper(const Descriptors& descriptors, std::size_t count) {
  ASSERT_EQ(descriptors.size(), count);
  ASSERT_EQ(descriptors.stride % 16, 0U);
  ASSERT_EQ(descriptors.roots.size(), descriptors.rows.size());
  for (std::size_t i = 0; i < count; ++i) {
    const float* const row = descriptors.rows.data() + i * descriptors.stride;
    EXPECT_NEAR(std::accumulate(row, row + descriptors.stride, 0.0), 1.0, 1e-5);
    for (std::uint32_t k = 0; k < descriptors.stride; ++k) {
      EXPECT_TRUE(row[k] >= 0.0F && row[k] <= 1.0F);
      EXPECT_TRUE(k < descriptors.dimension || row[k] == 0.0F) << "padding";
      EXPECT_EQ(descriptors.roots[i * descriptors.stride + k], std::sqrt(row[k]));
    }
  }
  for (const float variance : descriptors.variances) { EXPECT_TRUE(variance >= 0.0F && std::isfinite(variance)); }
}

std::vector<DescriptorParams> all_descriptors() {
  BetaGridParams raw;
  raw.estimate = OccupancyEstimate::raw_ratio;
  BetaGridParams free;
  free.no_return = NoReturnMeaning::free_space;
  BetaGridParams inflated;
  inflated.angular_inflation = radians_from_degrees(5);
  inflated.radial_inflation = 0.05;
  BetaGridParams odd;
  odd.angular_bins = 7;
  odd.radial_bins = 5;
  odd.radius_rule = RadiusRule::support;
  return {BetaGridParams{}, ShapeContextParams{}, raw, free, inflated, odd};
}

class EveryDescriptor : public testing::TestWithParam<DescriptorParams> {};
INSTANTIATE_TEST_SUITE_P(, EveryDescriptor, testing::ValuesIn(all_descriptors()));

TEST_P(EveryDescriptor, RowsSumToOne) {
  const Scan scan = scan_of(room(), {0.2, 0.3, 0.1}, turn_beams(), turn_beam_count);
  const std::vector<Keypoint> keypoints = keypoints_along(scan, 5);
  ASSERT_GT(keypoints.size(), 100U);
  expect_proper(describe(scan, keypoints, GetParam()), keypoints.size());
}

TEST_P(EveryDescriptor, StaysTheSameWhenTheWorldIsMovedAndTurned) {
  const Pose2 map_from_sensor{0.2, 0.3, 0.1};
  const Scan still = scan_of(room(), map_from_sensor, turn_beams(), turn_beam_count);
  const Descriptors expected = describe(still, corner_keypoints(map_from_sensor), GetParam());
  const Pose2 moved_from_map{30.0, -20.0, 2.5};
  const Scan shifted =
      scan_of(moved(room(), moved_from_map), moved_from_map * map_from_sensor, turn_beams(), turn_beam_count);
  EXPECT_LT(largest_difference(describe(shifted, corner_keypoints(map_from_sensor), GetParam()), expected), 1e-4);
}

TEST_P(EveryDescriptor, StaysTheSameWhenBeamsStartElsewhere) {
  const Pose2 map_from_sensor{0.2, 0.3, 0.1};
  const Scan still = scan_of(room(), map_from_sensor, turn_beams(), turn_beam_count);
  const Descriptors expected = describe(still, corner_keypoints(map_from_sensor), GetParam());
  for (const std::size_t steps : {1U, 90U, 333U, 719U}) {  // the sensor turned by whole beams sees the same points
    const double turn = static_cast<double>(steps) * still.beams.angle_step;
    const Pose2 turned{map_from_sensor.x, map_from_sensor.y, map_from_sensor.theta + turn};
    Scan scan = still;
    std::rotate(scan.ranges.begin(), scan.ranges.begin() + static_cast<std::ptrdiff_t>(steps), scan.ranges.end());
    EXPECT_LT(largest_difference(describe(scan, corner_keypoints(turned), GetParam()), expected), 1e-4) << steps;
    scan = still;  // the same beams, numbered from another one on
    scan.beams.angle_min += turn;
    std::rotate(scan.ranges.begin(), scan.ranges.begin() + static_cast<std::ptrdiff_t>(steps), scan.ranges.end());
    EXPECT_LT(largest_difference(describe(scan, corner_keypoints(map_from_sensor), GetParam()), expected), 1e-4)
        << steps;
  }
}

TEST_P(EveryDescriptor, DoesNotCareWhichWayTheScannerTurns) {
  const Pose2 map_from_sensor{0.2, 0.3, 0.1};
  const Scan scan = scan_of(room(), map_from_sensor, turn_beams(), turn_beam_count);
  Scan clockwise = scan;
  std::reverse(clockwise.ranges.begin(), clockwise.ranges.end());
  clockwise.beams.angle_min = scan.beams.angle(turn_beam_count - 1);
  clockwise.beams.angle_step = -scan.beams.angle_step;
  const std::vector<Keypoint> keypoints = corner_keypoints(map_from_sensor);
  EXPECT_LT(largest_difference(describe(clockwise, keypoints, GetParam()), describe(scan, keypoints, GetParam())),
            1e-4);
}

TEST_P(EveryDescriptor, CopesWithDegenerateScans) {
  const std::vector<Keypoint> keypoints{keypoint_at({1.0, 0.0, 0.5}), keypoint_at({0.0, 0.0, pi}),
                                        keypoint_at({-0.3, 0.1, -1.0})};
  const double nan = std::nan("");
  for (const std::vector<double>& ranges :
       {std::vector<double>{}, std::vector<double>{1.0}, std::vector<double>(360, infinity),
        std::vector<double>(360, nan), std::vector<double>(360, -1.0), std::vector<double>(360, 0.0),
        std::vector<double>(360, 1e-300), std::vector<double>(360, 29.99), std::vector<double>{nan, 1.0, -infinity}}) {
    for (const double step : {0.01, -2 * pi / 360, 0.0, 1.0, 100.0, 1e-300, nan, infinity}) {
      Scan scan;
      scan.beams = {step == 1.0 ? infinity : -1.0, step, 0.0, 30.0};
      scan.ranges = ranges;
      expect_proper(describe(scan, keypoints, GetParam()), keypoints.size());
    }
  }
}

TEST_P(EveryDescriptor, CopesWithDegenerateKeypoints) {
  const Scan scan = scan_of(room(), {0.2, 0.3, 0.1}, turn_beams(), turn_beam_count);
  const double nan = std::nan("");
  std::vector<Keypoint> keypoints{keypoint_at({nan, 0, 0}), keypoint_at({0, infinity, 0}), keypoint_at({1, 1, nan}),
                                  keypoint_at({1e300, 1e300, 0}), keypoint_at({1, 1, 1e300})};
  keypoints.push_back(keypoint_at({1, 1, 0}));
  keypoints.back().support_radius = std::nanf("");
  expect_proper(describe(scan, keypoints, GetParam()), keypoints.size());
  expect_proper(describe(scan, {}, GetParam()), 0);
}

TEST_P(EveryDescriptor, CopesWithThousandsOfBeams) {
  for (const std::size_t beams : {1081U, 3600U, 8000U}) {
    const double step = 1.5 * pi / static_cast<double>(beams - 1);
    const Scan scan = scan_of(room(), {0.2, 0.3, 0.1}, {-0.75 * pi, step, 0.05, 30.0}, beams);
    const std::vector<Keypoint> keypoints = keypoints_along(scan, beams / 20);
    expect_proper(describe(scan, keypoints, GetParam()), keypoints.size());
  }
}

TEST_P(EveryDescriptor, ReusedBuffersChangeNothing) {
  Describer describer(GetParam());
  Rng rng(1);
  for (int round = 0; round < 6; ++round) {
    const Pose2 map_from_sensor{rng.uniform(-1, 1), rng.uniform(0, 1), rng.uniform(-pi, pi)};
    const std::size_t beams = round < 3 ? turn_beam_count : 180 + rng.below(400);
    const Scan scan = scan_of(room(), map_from_sensor, turn_beams(), beams);
    const std::vector<Keypoint> keypoints = keypoints_along(scan, 9);
    const Descriptors fresh = describe(scan, keypoints, GetParam());
    const Descriptors reused = describer.describe(scan, keypoints);
    EXPECT_EQ(reused.rows, fresh.rows);
    EXPECT_EQ(reused.variances, fresh.variances);
  }
}

TEST(Describe, EntriesArePosteriorMeansOverTheirSum) {
  const Scan scan = scan_of(room(), {0.2, 0.3, 0.1}, turn_beams(), turn_beam_count);
  const std::vector<Keypoint> keypoints = keypoints_along(scan, 40);
  DescriptorTrace trace;
  const Descriptors descriptors = describe(scan, keypoints, BetaGridParams{}, &trace);
  ASSERT_EQ(trace.dimension, 48U);
  ASSERT_EQ(trace.hits.size(), keypoints.size() * 48);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    double sum = 0;
    for (std::size_t k = i * 48; k < (i + 1) * 48; ++k) {
      sum += (trace.hits[k] + 1.0) / (trace.hits[k] + trace.misses[k] + 2.0);
    }
    for (std::size_t k = 0; k < 48; ++k) {
      const double alpha = trace.hits[i * 48 + k] + 1.0;
      const double beta = trace.misses[i * 48 + k] + 1.0;
      const double variance = alpha * beta / ((alpha + beta) * (alpha + beta) * (alpha + beta + 1.0));
      EXPECT_DOUBLE_EQ(trace.mean[i * 48 + k], alpha / (alpha + beta));
      EXPECT_DOUBLE_EQ(trace.variance[i * 48 + k], variance);
      EXPECT_FLOAT_EQ(descriptors.row(i)[k], static_cast<float>(alpha / (alpha + beta) / sum));
      EXPECT_FLOAT_EQ(descriptors.variances[i * descriptors.stride + k], static_cast<float>(variance / (sum * sum)));
    }
  }
}

TEST(Describe, WithoutAnyBeamKnowsThePriorOnly) {
  const std::vector<Keypoint> keypoints{keypoint_at({5.0, 5.0, 0.0})};
  const Descriptors descriptors = describe(Scan{}, keypoints);
  for (std::size_t k = 0; k < 48; ++k) {
    EXPECT_FLOAT_EQ(descriptors.row(0)[k], 1.0F / 48.0F);
    EXPECT_FLOAT_EQ(descriptors.variances[k], static_cast<float>(1.0 / 12.0 / (24.0 * 24.0)));
  }
}

TEST(Describe, ARowOfMissesOnlyIsUniformUnderTheRawRatio) {
  BetaGridParams params;
  params.estimate = OccupancyEstimate::raw_ratio;
  params.angular_bins = 4;
  params.radial_bins = 1;
  Scan scan;  // beams on all sides of the keypoint, ending far behind it
  scan.beams = {-0.3, 0.01, 0.0, 30.0};
  scan.ranges.assign(61, 20.0);
  const std::vector<Keypoint> keypoints{keypoint_at({2.0, 0.0, 0.1})};
  DescriptorTrace trace;
  const Descriptors descriptors = describe(scan, keypoints, params, &trace);
  EXPECT_THAT(trace.hits, testing::Each(0U));
  EXPECT_THAT(trace.misses, testing::Each(testing::Gt(0U)));
  for (std::size_t k = 0; k < 4; ++k) { EXPECT_FLOAT_EQ(descriptors.row(0)[k], 0.25F); }
}

TEST(Describe, ShapeContextTracesItsPointsAndHasNoVariances) {
  const Scan scan = scan_of(room(), {0.2, 0.3, 0.1}, turn_beams(), turn_beam_count);
  const std::vector<Keypoint> keypoints = keypoints_along(scan, 40);
  DescriptorTrace trace;
  const Descriptors descriptors = describe(scan, keypoints, ShapeContextParams{}, &trace);
  EXPECT_TRUE(descriptors.variances.empty());
  EXPECT_TRUE(trace.misses.empty());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const auto begin = trace.hits.begin() + static_cast<std::ptrdiff_t>(48 * i);
    const double sum = std::accumulate(begin, begin + 48, 0.0);
    for (std::size_t k = 0; k < 48; ++k) {
      EXPECT_FLOAT_EQ(descriptors.row(i)[k], static_cast<float>(trace.hits[48 * i + k] / sum));
    }
  }
}

/// ½ Σ (p − q)² / (p + q), in [0, 1].
double chi_square(std::span<const float> p, std::span<const float> q) {
  double sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double difference = static_cast<double>(p[k]) - static_cast<double>(q[k]);
    const double total = static_cast<double>(p[k]) + static_cast<double>(q[k]);
    if (total > 0) { sum += difference * difference / total; }
  }
  return 0.5 * sum;
}

/// The two walls of a right angle as seen by sensors on its two sides, keypoint and direction the same: the scan points
/// are the same too, but the free space is on opposite sides (P2 §IV-C).
TEST(Describe, BetaGridTellsConvexFromConcaveAndTheShapeContextDoesNot) {
  const std::vector<Wall> corner{{{0, 0}, {-3, 3}}, {{0, 0}, {-3, -3}}};
  const Beams beams{-0.25, 0.5 / 400, 0.05, 30.0};
  const Pose2 map_from_keypoint{0.0, 0.0, 0.0};
  const Pose2 map_from_outside{4.0, 0.0, pi};   // sees an edge that points to it
  const Pose2 map_from_inside{-4.0, 0.0, 0.0};  // sees a corner of a room
  const auto rows = [&](const Pose2& map_from_sensor, const DescriptorParams& params) {
    const std::vector<Keypoint> keypoints{keypoint_at(inverse(map_from_sensor) * map_from_keypoint)};
    return describe(scan_of(corner, map_from_sensor, beams, 401), keypoints, params);
  };
  const auto distance = [&](const DescriptorParams& params) {
    return chi_square(rows(map_from_outside, params).row(0), rows(map_from_inside, params).row(0));
  };
  const double shape = distance(ShapeContextParams{});
  const double posterior = distance(BetaGridParams{});
  BetaGridParams raw;
  raw.estimate = OccupancyEstimate::raw_ratio;
  EXPECT_LT(shape, 0.05);
  EXPECT_GT(posterior, 4.0 * shape);
  EXPECT_GT(posterior, 0.2);
  EXPECT_GT(distance(raw), 0.4) << "above the papers' threshold: not taken for the same";
}

TEST(Describe, NamesRoundTrip) {
  for (const std::string_view name : descriptor_names) {
    const std::optional<DescriptorParams> params = descriptor_from_name(name);
    ASSERT_TRUE(params.has_value());
    EXPECT_EQ(descriptor_name(*params), name);
  }
  EXPECT_FALSE(descriptor_from_name("alpha-grid").has_value());
}

TEST(Describe, DefaultsAreWithinTheirRanges) {
  EXPECT_EQ(out_of_range(BetaGridParams{}), "");
  EXPECT_EQ(out_of_range(ShapeContextParams{}), "");
  BetaGridParams params;
  params.prior_hits = 0.0;
  EXPECT_NE(out_of_range(params), "");
}

}  // namespace
}  // namespace flirt
