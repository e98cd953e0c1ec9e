#include "flirt/features/beta_grid.hpp"

#include "flirt/core/rng.hpp"

#include "tests/features/slow_beta_grid.hpp"
#include "tests/support/numbers.hpp"
#include "tests/support/print.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <ostream>

namespace flirt {
namespace {

using testing::Each;

/// Bins reach from 0.1 to 0.5 m in steps of 0.1; angular bins of 90° start at −180°.
BetaGridParams four_by_four() {
  BetaGridParams params;
  params.angular_bins = 4;
  params.inner_radius = 0.1;
  return params;
}

struct Counts {
  std::vector<std::uint32_t> hits;
  std::vector<std::uint32_t> misses;
};

Counts count(const Scan& scan, const Pose2& sensor_from_keypoint, const BetaGridParams& params) {
  BeamFan fan;
  fan.assign(scan, params.no_return);
  BetaGrid grid(params);
  grid.count(fan, Keypoint{sensor_from_keypoint, 0.2F, 0.4F, 0, 0, 0});
  return {{grid.hits().begin(), grid.hits().end()}, {grid.misses().begin(), grid.misses().end()}};
}

/// One beam along `angle`, with neighbours that say nothing.
Scan single_beam(double angle, double range) {
  return {.stamp = 0, .beams = {angle, 0.01, 0, 50}, .ranges = {range}, .robot_from_sensor = {}, .odom_from_robot = {}};
}

std::vector<std::uint32_t> ones_at(std::initializer_list<std::size_t> bins, std::size_t size = 16) {
  std::vector<std::uint32_t> counts(size);
  for (const std::size_t bin : bins) { counts[bin] = 1; }
  return counts;
}

// The beam runs 0.25 m to the left of the keypoint, which is 2 m ahead and looks along the beam: it comes in by
// angular bin 3 (behind, left) at 0.5 m, passes its nearest point between bins 3 and 2 and leaves by bin 2 (ahead,
// left).
const Pose2 right_of_beam{2.0, -0.25, 0.0};

TEST(BetaGrid, ABeamThatPassesCrossesTheBinsOnItsWay) {
  const Counts counts = count(single_beam(0.0, 10.0), right_of_beam, four_by_four());
  EXPECT_THAT(counts.hits, Each(0U));
  EXPECT_EQ(counts.misses, ones_at({3 * 4 + 3, 3 * 4 + 2, 3 * 4 + 1, 2 * 4 + 1, 2 * 4 + 2, 2 * 4 + 3}));
}

TEST(BetaGrid, ABeamThatEndsInABinHitsItAndMissesThoseBefore) {
  const Counts counts = count(single_beam(0.0, 2.2), right_of_beam, four_by_four());  // 0.32 m away, ahead
  EXPECT_EQ(counts.hits, ones_at({2 * 4 + 2}));
  EXPECT_EQ(counts.misses, ones_at({3 * 4 + 3, 3 * 4 + 2, 3 * 4 + 1, 2 * 4 + 1}));
}

TEST(BetaGrid, ABeamThatEndsBeforeSaysNothing) {
  const Counts counts = count(single_beam(0.0, 1.5), right_of_beam, four_by_four());
  EXPECT_THAT(counts.hits, Each(0U));
  EXPECT_THAT(counts.misses, Each(0U));
}

TEST(BetaGrid, ABinThatIsLeftAndEnteredAgainCountsOnce) {
  const Pose2 looking_left{2.0, -0.25, 0.75 * pi};  // the beam's nearest point lies at −45°: the middle of wedge 1
  const Counts passing = count(single_beam(0.0, 10.0), looking_left, four_by_four());
  EXPECT_EQ(passing.misses[1 * 4 + 2], 1U);  // 0.3 to 0.4 m, passed on the way in and out
  EXPECT_EQ(passing.misses[1 * 4 + 1], 1U);
  const Counts ending = count(single_beam(0.0, 2.2), looking_left, four_by_four());  // ends at 0.32 m, on the way out
  EXPECT_EQ(ending.hits, ones_at({1 * 4 + 2}));
  EXPECT_EQ(ending.misses[1 * 4 + 2], 0U) << "the bin of the end gets the hit only";
}

TEST(BetaGrid, ATangentDoesNotPass) {
  Counts counts = count(single_beam(0.0, 10.0), {2.0, -0.5, 0.0}, four_by_four());  // touches the outer arc
  EXPECT_THAT(counts.misses, Each(0U));
  counts = count(single_beam(0.0, 10.0), {2.0, -0.25, 0.0}, four_by_four());
  EXPECT_EQ(counts.misses[3 * 4 + 0], 0U);
  BetaGridParams touching = four_by_four();
  touching.inner_radius = 0.125;  // rings of 0.125: all edges exact in binary
  touching.radius = 0.625;
  counts = count(single_beam(0.0, 10.0), {2.0, -0.25, 0.0}, touching);  // touches the arc between rings 0 and 1
  EXPECT_EQ(counts.misses[3 * 4 + 0] + counts.misses[2 * 4 + 0], 0U);
  EXPECT_EQ(counts.misses[3 * 4 + 1] + counts.misses[2 * 4 + 1], 2U);
}

TEST(BetaGrid, AnEndOnAnArcBelongsToTheOuterRing) {
  BetaGridParams params = four_by_four();
  params.inner_radius = 0.0625;
  params.radius = 0.5625;  // arcs at 0.1875, 0.3125 and 0.4375 m, exact in binary
  const Counts counts = count(single_beam(0.0, 2.25), {2.0, -0.1875, 0.0}, params);  // ends 0.3125 m away: 3, 4, 5
  EXPECT_EQ(counts.hits, ones_at({2 * 4 + 2}));
  EXPECT_EQ(counts.misses, ones_at({3 * 4 + 3, 3 * 4 + 2, 3 * 4 + 1, 2 * 4 + 1}));
}

TEST(BetaGrid, TheBeamOfTheKeypointMissesWhatIsBeforeIt) {
  const double inwards = 0.1;  // rad
  const Counts counts = count(single_beam(0.0, 2.0), {2.0, 0.0, inwards}, four_by_four());
  EXPECT_THAT(counts.hits, Each(0U)) << "it ends within the inner radius";
  EXPECT_EQ(counts.misses, ones_at({12, 13, 14, 15}));  // comes from direction π − 0.1: the last wedge
}

TEST(BetaGrid, ABeamThroughTheKeypointLeavesOnTheOtherSide) {
  const Counts passing = count(single_beam(0.0, 3.0), {2.0, 0.0, 0.1}, four_by_four());
  EXPECT_EQ(passing.misses, ones_at({12, 13, 14, 15, 4, 5, 6, 7}));
  const Counts ending = count(single_beam(0.0, 2.25), {2.0, 0.0, 0.1}, four_by_four());
  EXPECT_EQ(ending.misses, ones_at({12, 13, 14, 15, 4}));
  EXPECT_EQ(ending.hits, ones_at({5}));
}

TEST(BetaGrid, ABeamAlongTheLineBetweenTwoBinsCountsForBoth) {
  for (const double noise : {-1e-13, 0.0, 1e-13}) {
    const Counts counts = count(single_beam(0.0, 2.0), {2.0, 0.0, noise}, four_by_four());
    EXPECT_EQ(counts.misses, ones_at({0, 1, 2, 3, 12, 13, 14, 15}));
  }
}

TEST(BetaGrid, KnowsTheSensorInsideItsReach) {
  const Counts counts = count(single_beam(0.0, 10.0), {0.0, -0.25, 0.0}, four_by_four());
  EXPECT_EQ(counts.misses, ones_at({2 * 4 + 1, 2 * 4 + 2, 2 * 4 + 3})) << "nothing behind the sensor";
}

TEST(BetaGrid, NoReturnIsIgnoredOrFreeSpace) {
  BetaGridParams params = four_by_four();
  for (const double nothing : {50.0, 81.83, 0.0, infinity}) {
    params.no_return = NoReturnMeaning::ignored;
    EXPECT_THAT(count(single_beam(0.0, nothing), right_of_beam, params).misses, Each(0U));
    params.no_return = NoReturnMeaning::free_space;
    const Counts counts = count(single_beam(0.0, nothing), right_of_beam, params);
    EXPECT_EQ(counts.misses, count(single_beam(0.0, 10.0), right_of_beam, params).misses);
    EXPECT_THAT(counts.hits, Each(0U));
  }
}

TEST(BetaGrid, FreeSpaceEndsWhereTheSensorSeesNoFurther) {
  Scan scan = single_beam(0.0, infinity);
  scan.beams.range_max = 2.2;
  BetaGridParams params = four_by_four();
  params.no_return = NoReturnMeaning::free_space;
  const Counts counts = count(scan, right_of_beam, params);
  EXPECT_EQ(counts.misses, ones_at({3 * 4 + 3, 3 * 4 + 2, 3 * 4 + 1, 2 * 4 + 1, 2 * 4 + 2}));
  EXPECT_THAT(counts.hits, Each(0U));
}

TEST(BetaGrid, InvalidReadingsSayNothing) {
  for (const double invalid : {std::nan(""), -1.0, -infinity}) {
    const Counts counts = count(single_beam(0.0, invalid), right_of_beam, four_by_four());
    EXPECT_THAT(counts.misses, Each(0U));
    EXPECT_THAT(counts.hits, Each(0U));
  }
}

TEST(BetaGrid, InflatedBinsOverlap) {
  BetaGridParams params = four_by_four();
  params.angular_inflation = radians_from_degrees(10);
  params.radial_inflation = 0.03;
  // The end lies at 0.32 m and 51° from the keypoint's direction: well inside wedge 2, within 0.03 m of ring 1.
  const Counts counts = count(single_beam(0.0, 2.2), right_of_beam, params);
  EXPECT_EQ(counts.hits, ones_at({2 * 4 + 1, 2 * 4 + 2}));
  // 0.03 m ahead and 0.25 m to the left, 83° from the direction, it belongs to the wedges on both sides of 90°.
  const Counts between = count(single_beam(0.0, 2.03), right_of_beam, params);
  EXPECT_EQ(between.hits, ones_at({2 * 4 + 1, 3 * 4 + 1}));
}

TEST(BetaGrid, InflationNeverReachesTheKeypointItself) {
  BetaGridParams params = four_by_four();
  params.radial_inflation = 0.2;
  EXPECT_THAT(count(single_beam(0.0, 2.0), {2.0, 0.0, 0.1}, params).hits, Each(0U));
}

/// Walls, gaps and clutter around the sensor, without meaning.
Scan random_scan(Rng& rng, std::size_t beams, double field_of_view, double direction) {
  Scan scan;
  const double step = field_of_view / static_cast<double>(beams);
  scan.beams = {rng.uniform(-pi, pi), direction * step, 0.0, 30.0};
  double range = 2.0;
  for (std::size_t i = 0; i < beams; ++i) {
    range = rng.uniform() < 0.05 ? rng.uniform(0.2, 5.0) : std::max(0.05, range + rng.normal(0.0, 0.03));
    scan.ranges.push_back(rng.uniform() < 0.03 ? infinity : range);
  }
  return scan;
}

struct RandomCase {
  std::uint32_t angular_bins;
  double angular_inflation;
  double radial_inflation;
  NoReturnMeaning no_return;

  friend void PrintTo(const RandomCase& random, std::ostream* out) {
    *out << random.angular_bins << " bins, inflated by " << random.angular_inflation << " rad, "
         << random.radial_inflation << " m, no return " << to_string(random.no_return);
  }
};
class BetaGridOnRandomScans : public testing::TestWithParam<RandomCase> {};

TEST_P(BetaGridOnRandomScans, EqualsTheSlowDerivation) {
  BetaGridParams params;
  params.angular_bins = GetParam().angular_bins;
  params.angular_inflation = GetParam().angular_inflation;
  params.radial_inflation = GetParam().radial_inflation;
  params.no_return = GetParam().no_return;
  Rng rng(7);
  std::uint32_t hits = 0;
  std::uint32_t misses = 0;
  const std::uint32_t rounds = 1 + 40 * 12 / params.angular_bins;
  for (std::uint32_t round = 0; round < rounds; ++round) {
    const Scan scan = random_scan(rng, 90 + rng.below(200), rng.uniform(1.0, 2.0 * pi), round % 2 == 0 ? 1.0 : -1.0);
    const std::vector<BeamPoint> points = hit_points(scan);
    for (int k = 0; k < 4; ++k) {
      const Point2 at = points[rng.below(static_cast<std::uint32_t>(points.size()))].point;
      // Every other keypoint lies on the curve, the others anywhere, some beside or behind the sensor.
      const Pose2 keypoint = k % 2 == 0 ? Pose2{at.x, at.y, rng.uniform(-pi, pi)}
                                        : Pose2{rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-pi, pi)};
      const Counts fast = count(scan, keypoint, params);
      const slow::Counts slow = slow::count(scan, keypoint, params, params.radius);
      ASSERT_EQ(fast.hits, slow.hits) << "round " << round << " keypoint " << k;
      ASSERT_EQ(fast.misses, slow.misses) << "round " << round << " keypoint " << k;
      hits += std::accumulate(fast.hits.begin(), fast.hits.end(), 0U);
      misses += std::accumulate(fast.misses.begin(), fast.misses.end(), 0U);
    }
  }
  EXPECT_GT(hits, 100U) << "the test must see hits";
  EXPECT_GT(misses, 1000U) << "and misses";
}

INSTANTIATE_TEST_SUITE_P(, BetaGridOnRandomScans,
                         testing::Values(RandomCase{12, 0.0, 0.0, NoReturnMeaning::ignored},
                                         RandomCase{12, 0.0, 0.0, NoReturnMeaning::free_space},
                                         RandomCase{12, radians_from_degrees(5), 0.05, NoReturnMeaning::ignored},
                                         RandomCase{4, 0.3, 0.2, NoReturnMeaning::ignored},
                                         RandomCase{7, 0.0, 0.0, NoReturnMeaning::ignored},
                                         RandomCase{60, pi / 8.0, 0.0, NoReturnMeaning::ignored},
                                         RandomCase{120, 0.0, 0.01, NoReturnMeaning::free_space}));

TEST(BetaGrid, EqualsDenseSamplingAlongTheBeam) {
  const BetaGridParams params;
  Rng rng(3);
  constexpr double step = 2e-5;  // m
  for (int round = 0; round < 60; ++round) {
    const Pose2 keypoint{rng.uniform(0.5, 1.5), rng.uniform(-0.4, 0.4), rng.uniform(-pi, pi)};
    const double angle = rng.uniform(-0.2, 0.2);
    const double range = rng.uniform(0.5, 2.0);
    const Counts fast = count(single_beam(angle, range), keypoint, params);
    std::vector<std::uint32_t> samples(48);
    for (double t = 0; t < range; t += step) {
      const Point2 q = inverse(keypoint) * Point2{t * std::cos(angle), t * std::sin(angle)};
      const double ring = std::floor((norm(q) - 0.02) / 0.12);
      const double wedge = std::floor((std::atan2(q.y, q.x) + pi) / (pi / 6.0));
      if (ring >= 0 && ring < 4) { ++samples[static_cast<std::size_t>(4.0 * wedge + ring)]; }
    }
    for (std::uint32_t bin = 0; bin < 48; ++bin) {
      const bool is_touched = fast.hits[bin] + fast.misses[bin] > 0;
      EXPECT_EQ(samples[bin] > 0, is_touched) << "bin " << bin << " round " << round;
    }
  }
}

TEST(BetaGrid, PriorGivesThePapersFormulas) {
  const BetaGridParams params;
  EXPECT_DOUBLE_EQ(occupancy(0, 0, params).mean, 0.5);
  EXPECT_DOUBLE_EQ(occupancy(0, 0, params).variance, 1.0 / 12.0);
  EXPECT_DOUBLE_EQ(occupancy(3, 1, params).mean, 4.0 / 6.0);                          // (3 + 1) / (3 + 1 + 2)
  EXPECT_DOUBLE_EQ(occupancy(3, 1, params).variance, 4.0 * 2.0 / (6.0 * 6.0 * 7.0));  // αβ / ((α+β)² (α+β+1))
  BetaGridParams other;
  other.prior_hits = 0.5;
  other.prior_misses = 2.0;
  EXPECT_DOUBLE_EQ(occupancy(1, 0, other).mean, 1.5 / 3.5);
}

TEST(BetaGrid, RawRatioKnowsNoPrior) {
  BetaGridParams params;
  params.estimate = OccupancyEstimate::raw_ratio;
  EXPECT_DOUBLE_EQ(occupancy(0, 0, params).mean, 0.5);
  EXPECT_DOUBLE_EQ(occupancy(0, 0, params).variance, 1.0 / 12.0);
  EXPECT_DOUBLE_EQ(occupancy(1, 2, params).mean, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(occupancy(1, 2, params).variance, 2.0 / (9.0 * 4.0));
  EXPECT_DOUBLE_EQ(occupancy(0, 7, params).variance, 0.0);
}

TEST(BetaGrid, RadiusFollowsTheSupportRegionOnRequest) {
  BetaGridParams params = four_by_four();
  const Scan scan = single_beam(0.0, 2.5);
  params.radius_rule = RadiusRule::support;
  params.radius_factor = 2.0;  // the support radius is 0.4 m: rings of 0.175 m
  const Counts counts = count(scan, {2.0, 0.0, 0.1}, params);
  EXPECT_EQ(counts.hits, ones_at({4 + 2}));  // 0.45 m to 0.625 m
}

TEST(BetaGrid, CountsNothingWithoutAnArea) {
  BetaGridParams params;
  params.radius_rule = RadiusRule::support;
  BeamFan fan;
  fan.assign(single_beam(0.0, 2.0), params.no_return);
  BetaGrid grid(params);
  for (const float support : {0.0F, 0.01F, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    grid.count(fan, Keypoint{{2.1, 0.0, 0.0}, 0.2F, support, 0, 0, 0});
    EXPECT_THAT(grid.misses(), Each(0U)) << support;
    EXPECT_THAT(grid.hits(), Each(0U)) << support;
  }
}

}  // namespace
}  // namespace flirt
