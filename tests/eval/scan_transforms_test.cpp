#include "flirt/eval/scan_transforms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace flirt {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Scan scan_with(std::vector<double> ranges) {
  return {.beams = {.angle_min = -0.5, .angle_step = 0.1, .range_min = 0.05, .range_max = 10},
          .ranges = std::move(ranges)};
}

TEST(Subsampled, KeepsEveryKthReadingInItsDirection) {
  const Scan scan = scan_with({1, 2, 3, 4, 5, 6, 7});
  const Scan third = subsampled(scan, 3);
  EXPECT_EQ(third.ranges, (std::vector<double>{1, 4, 7}));
  EXPECT_DOUBLE_EQ(third.beams.angle(1), scan.beams.angle(3));
  EXPECT_DOUBLE_EQ(third.beams.angle(2), scan.beams.angle(6));
  EXPECT_EQ(subsampled(scan, 1).ranges, scan.ranges);
}

TEST(Oversampled, InterpolatesRangesBetweenHits) {
  const Scan scan = scan_with({1, 4, 4});
  const Scan thrice = oversampled(scan, 3);
  ASSERT_EQ(thrice.ranges.size(), 7U);
  EXPECT_DOUBLE_EQ(thrice.ranges[1], 2);
  EXPECT_DOUBLE_EQ(thrice.ranges[2], 3);
  EXPECT_DOUBLE_EQ(thrice.ranges[3], 4);
  EXPECT_DOUBLE_EQ(thrice.beams.angle(3), scan.beams.angle(1));
  EXPECT_EQ(oversampled(scan, 1).ranges, scan.ranges);
}

TEST(Oversampled, InventsNothingBesideBeamsWithoutAHit) {
  const Scan twice = oversampled(scan_with({1, infinity, infinity, 2}), 2);
  ASSERT_EQ(twice.ranges.size(), 7U);
  EXPECT_TRUE(std::isnan(twice.ranges[1])) << "between a hit and no return";
  EXPECT_EQ(twice.ranges[3], infinity) << "between two without return";
  EXPECT_TRUE(std::isnan(twice.ranges[5]));
}

TEST(Oversampled, ClosesAFullTurn) {
  Scan scan{.beams = {.angle_min = 0, .angle_step = std::numbers::pi / 2, .range_max = 10}, .ranges = {1, 2, 3, 5}};
  const Scan twice = oversampled(scan, 2);
  EXPECT_EQ(twice.ranges, (std::vector<double>{1, 1.5, 2, 2.5, 3, 4, 5, 3}));
  EXPECT_TRUE(is_full_turn(twice));
}

TEST(Oversampled, IsUndoneBySubsampling) {
  const Scan scan = scan_with({1, 2, 0.5, 4});
  EXPECT_EQ(subsampled(oversampled(scan, 4), 4).ranges, scan.ranges);
}

TEST(RadialNoise, HasTheDeviationAskedForAndItsSeed) {
  const Scan scan = scan_with(std::vector<double>(4000, 5.0));
  const Scan noisy = with_radial_noise(scan, 0.2, 7);
  double sum = 0;
  double squares = 0;
  for (const double range : noisy.ranges) {
    sum += range - 5.0;
    squares += (range - 5.0) * (range - 5.0);
  }
  EXPECT_NEAR(sum / 4000, 0, 0.01);
  EXPECT_NEAR(std::sqrt(squares / 4000), 0.2, 0.01);
  EXPECT_EQ(with_radial_noise(scan, 0.2, 7).ranges, noisy.ranges);
  EXPECT_NE(with_radial_noise(scan, 0.2, 8).ranges, noisy.ranges);
  EXPECT_NE(with_radial_noise(scan, 0.2, 7, 1).ranges, noisy.ranges);
  EXPECT_EQ(with_radial_noise(scan, 0.0, 7).ranges, scan.ranges);
}

TEST(RadialNoise, LeavesReadingsWithoutHitAndMakesNoNegativeOnes) {
  const Scan noisy = with_radial_noise(scan_with({infinity, 0, 0.06, 0.06, 0.06, 0.06, 0.06, 0.06}), 5.0, 1);
  EXPECT_EQ(noisy.ranges[0], infinity);
  EXPECT_EQ(noisy.ranges[1], 0);
  int lost = 0;
  for (std::size_t i = 2; i < 8; ++i) {
    EXPECT_FALSE(noisy.ranges[i] <= 0);
    lost += std::isnan(noisy.ranges[i]) ? 1 : 0;
  }
  EXPECT_GT(lost, 0);
}

}  // namespace
}  // namespace flirt
