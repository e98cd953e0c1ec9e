#include "flirt/arena/point_histograms.hpp"

#include "flirt/arena/falko.hpp"
#include "flirt/match/match.hpp"

#include "tests/arena/corners.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace flirt {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;

/// Bearing in degrees.
Point2 at(double bearing, double away) {
  return {away * std::cos(radians_from_degrees(bearing)), away * std::sin(radians_from_degrees(bearing))};
}

Surroundings three_points(double turn, double direction) {
  return {{at(10 + turn, 0.55), at(100 + turn, 0.7), at(190 + turn, 0.2)}, 1, radians_from_degrees(direction)};
}

std::vector<std::pair<std::size_t, std::size_t>> set_bits(const Surroundings& around) {
  const std::vector<char> bits = bsc_bits(around, {});
  std::vector<std::pair<std::size_t, std::size_t>> set;
  for (std::size_t k = 0; k < bits.size(); ++k) {
    if (bits[k] != 0) { set.emplace_back(k / 16, k % 16); }
  }
  return set;
}

std::uint32_t bsc(const Surroundings& a, const Surroundings& b, std::uint32_t max_shift = 0) {
  return bsc_distance(bsc_bits(a, {}), bsc_bits(b, {}), 16, max_shift);
}

TEST(Bsc, SetsABitPerRingAndSector) {
  EXPECT_THAT(set_bits(three_points(0, 0)), ElementsAre(std::pair(1, 8), std::pair(4, 0), std::pair(5, 4)));
  EXPECT_THAT(set_bits({{{0.4, 0.02}, {0.02, -0.6}, {0.9, 0.045}}, 1, 0}),
              ElementsAre(std::pair(3, 0), std::pair(4, 12), std::pair(7, 0)));
}

TEST(Bsc, TakesTheEdgeButNotTheKeypointItself) {
  EXPECT_THAT(set_bits({{{0.6, 0.8}, {0.61, 0.81}, {0, 0}}, 1, 0}), ElementsAre(std::pair(7, 2)));
}

TEST(Bsc, IsEqualUnderRotation) {
  EXPECT_EQ(bsc(three_points(30, 30), three_points(0, 0)), 0U);
}

TEST(Bsc, FindsATurnByWholeSectors) {
  EXPECT_EQ(bsc(three_points(22.5, 0), three_points(0, 0)), 6U);
  EXPECT_EQ(bsc(three_points(22.5, 0), three_points(0, 0), 1), 0U);
  EXPECT_EQ(bsc(three_points(45, 0), three_points(0, 0), 1), 6U);
  EXPECT_EQ(bsc(three_points(45, 0), three_points(0, 0), 2), 0U);
}

TEST(Bsc, CountsDifferentBits) {
  const Surroundings two{{{0.4, 0.02}, {-0.02, 0.6}}, 1, 0};
  const Surroundings three{{{0.4, 0.02}, {0.02, -0.6}, {0.9, 0.045}}, 1, 0};
  EXPECT_EQ(bsc(two, three), 3U);
  EXPECT_EQ(bsc(three_points(0, 0), {{}, 1, 0}), 3U);
}

std::vector<double> cgh(std::vector<double> bearings, double direction = 0) {
  Surroundings around{.radius = 1, .direction = radians_from_degrees(direction)};
  for (const double bearing : bearings) { around.offsets.push_back(at(bearing, 0.5)); }
  return cgh_bins(around, {});
}

TEST(Cgh, GrowsWithTheAngleBetweenNeighbours) {
  EXPECT_NEAR(cgh_distance(cgh({10}), cgh({10})), 0, 1e-12);
  EXPECT_NEAR(cgh_distance(cgh({10}), cgh({30})), 0.523810, 1e-6);
  EXPECT_NEAR(cgh_distance(cgh({10}), cgh({50})), 0.857143, 1e-6);
  EXPECT_NEAR(cgh_distance(cgh({10}), cgh({70})), 1, 1e-12);
  EXPECT_NEAR(cgh_distance(cgh({10}), cgh({190})), 1, 1e-12);
}

TEST(Cgh, SpreadsEveryNeighbourOverThreeSectors) {
  const std::vector<double> bins = cgh({10, 10, 100});
  EXPECT_NEAR(bins[0], 0.476190, 1e-6);
  EXPECT_NEAR(bins[1], 0.095238, 1e-6);
  EXPECT_NEAR(bins[15], 0.095238, 1e-6);
  EXPECT_NEAR(bins[3], 0.047619, 1e-6);
  EXPECT_NEAR(bins[4], 0.238095, 1e-6);
  EXPECT_NEAR(bins[5], 0.047619, 1e-6);
}

TEST(Cgh, IsEqualUnderRotation) {
  EXPECT_NEAR(cgh_distance(cgh({10, 75, 200}), cgh({40, 105, 230}, 30)), 0, 1e-12);
}

TEST(Cgh, IsFarFromEverythingWhenEmpty) {
  EXPECT_EQ(cgh_distance(cgh({}), cgh({10})), 1);
  EXPECT_EQ(cgh_distance(cgh({}), cgh({})), 1);
}

/// Two different corners in one scan.
Scan two_corners() {
  Scan scan = corner_scan(50);
  const Scan other = scan_of(corner({0, 2.5}, 35), {}, scan.beams, scan.ranges.size());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) { scan.ranges[i] = std::min(scan.ranges[i], other.ranges[i]); }
  return scan;
}

TEST(PointHistogramRows, HaveTheDistancesOfTheirDescriptors) {
  const Scan scan = two_corners();
  const std::vector<Keypoint> keypoints = detect_falko(scan, tuned_falko());
  ASSERT_GE(keypoints.size(), 2U);
  const Descriptors bits = describe_bsc(scan, keypoints);
  const Descriptors bins = describe_cgh(scan, keypoints);
  ASSERT_EQ(bits.size(), keypoints.size());
  const auto around = [&](std::size_t i) {
    Surroundings own{.radius = keypoints[i].support_radius, .direction = keypoints[i].sensor_from_keypoint.theta};
    const PolarScan polar = polar_scan(scan, {});
    for (std::size_t j = 0; j < polar.size(); ++j) {
      if (polar.has_return(j)) { own.offsets.push_back(polar.points[j] - polar.points[keypoints[i].beam]); }
    }
    return own;
  };
  const std::uint32_t differing = bsc(around(0), around(1));
  EXPECT_GT(differing, 0U);
  EXPECT_NEAR(descriptor_distance(Distance::chi_square, rows_of(bits), 0, rows_of(bits), 1), differing / 128.0, 1e-6);
  const double apart = cgh_distance(cgh_bins(around(0), {}), cgh_bins(around(1), {}));
  EXPECT_GT(apart, 0);
  EXPECT_NEAR(descriptor_distance(Distance::chi_square, rows_of(bins), 0, rows_of(bins), 1), apart, 1e-6);
}

TEST(PointHistogramRows, AreFiniteForKeypointsWithoutAReturn) {
  const std::vector<Keypoint> keypoints{
      {.support_radius = 0.5F, .beam = 7},
      {.support_radius = 0.5F, .beam = 100000},
      {.sensor_from_keypoint = {0, 0, std::numeric_limits<double>::quiet_NaN()}, .support_radius = 0.5F, .beam = 180}};
  Scan scan = corner_scan(50);
  scan.ranges[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(describe_bsc(scan, keypoints).rows, Each(0.0F));
  const Descriptors bins = describe_cgh(scan, keypoints);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    EXPECT_EQ(bins.row(i)[16], 1.0F);
    EXPECT_EQ(bins.row(i)[0], 0.0F);
  }
  EXPECT_THAT(describe_bsc(Scan{}, {}).rows, IsEmpty());
}

}  // namespace
}  // namespace flirt
