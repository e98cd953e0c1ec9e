#include "flirt/eval/repeatability.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace flirt {
namespace {

TEST(OverlapError, OfEqualDisjointAndNestedDiscs) {
  EXPECT_NEAR(overlap_error({{1, 2}, 0.5}, {{1, 2}, 0.5}), 0, 1e-15);
  EXPECT_EQ(overlap_error({{0, 0}, 0.5}, {{1, 0}, 0.5}), 1) << "they touch";
  EXPECT_NEAR(overlap_error({{0, 0}, 2}, {{0.5, 0}, 1}), 0.75, 1e-15) << "a quarter of the area";
  EXPECT_EQ(overlap_error({{0, 0}, 0}, {{0, 0}, 0}), 0);
  EXPECT_EQ(overlap_error({{0, 0}, 0}, {{1, 0}, 0}), 1);
  EXPECT_EQ(overlap_error({{0, 0}, 1}, {{0, 0}, 0}), 1) << "a point in a disc";
}

TEST(OverlapError, OfEqualDiscsOneRadiusApartIsTheTextbookLens) {
  // Vesica piscis: intersection 2π/3 − √3/2 of the unit disc's π.
  const double common = 2 * std::numbers::pi / 3 - std::sqrt(3.0) / 2;
  EXPECT_NEAR(overlap_error({{0, 0}, 1}, {{0, 1}, 1}), 1 - common / (2 * std::numbers::pi - common), 1e-14);
}

TEST(OverlapError, EqualsAreasCountedOnAGrid) {
  Rng rng(4);
  for (int trial = 0; trial < 20; ++trial) {
    const Region a{{rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)}, rng.uniform(0.2, 1)};
    const Region b{{rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)}, rng.uniform(0.2, 1)};
    int both = 0;
    int either = 0;
    for (int i = 0; i < 400; ++i) {
      for (int j = 0; j < 400; ++j) {
        const Point2 p{-1.5 + 3.0 * (i + 0.5) / 400, -1.5 + 3.0 * (j + 0.5) / 400};
        const bool in_a = norm(p - a.centre) < a.radius;
        const bool in_b = norm(p - b.centre) < b.radius;
        both += in_a && in_b ? 1 : 0;
        either += in_a || in_b ? 1 : 0;
      }
    }
    EXPECT_NEAR(overlap_error(a, b), 1 - static_cast<double>(both) / either, 0.01);
    EXPECT_DOUBLE_EQ(overlap_error(a, b), overlap_error(b, a));
  }
}

TEST(ModifiedHausdorff, IsTheMeanOfNearestDistancesOneWay) {
  const Region region{{0, 0}, 1};
  const std::vector<Point2> from{{0, 0}, {0.5, 0}, {3, 0}};
  const std::vector<Point2> to{{0, 0.1}, {0.5, 0.3}, {0.9, 0}, {3, 0}};
  EXPECT_NEAR(modified_hausdorff(region, from, to), (0.1 + 0.3) / 2, 1e-12) << "points outside do not count";
  EXPECT_NEAR(modified_hausdorff(region, to, from), (0.1 + 0.3 + 0.4) / 3, 1e-12) << "directed";
  EXPECT_EQ(modified_hausdorff({{9, 9}, 1}, from, to), std::numeric_limits<double>::infinity());
  EXPECT_EQ(modified_hausdorff(region, from, {}), std::numeric_limits<double>::infinity());
}

TEST(OneToOnePairs, TakesTheBestFirstAndNoRegionTwice) {
  const std::vector<Region> reference{{{0, 0}, 1}, {{0.3, 0}, 1}};
  const std::vector<Region> other{{{0.25, 0}, 1}, {{5, 5}, 1}};
  EXPECT_EQ(overlapping_pairs(reference, other, 0.6), (std::vector<RegionPair>{{0, 0}, {1, 0}}));
  EXPECT_EQ(one_to_one_pairs(reference, other, 0.6), (std::vector<RegionPair>{{1, 0}}));
  EXPECT_TRUE(one_to_one_pairs(reference, other, 0.0).empty());
}

TEST(Repeatability, CountsOnlyWhatIsPresentInBothScans) {
  // Three interest points: found again; present but not found; gone from the other scan although a region is there.
  const RegionScan reference{{{{0, 0}, 0.5}, {{5, 0}, 0.5}, {{9, 0}, 0.5}}, {{0, 0}, {5, 0}, {9, 0}}};
  const RegionScan other{{{{0.1, 0}, 0.5}, {{9, 0}, 0.5}}, {{0.05, 0}, {5, 0.05}, {9.2, 0}}};
  const RepeatabilityCounts counts = repeatability(reference, other);
  EXPECT_EQ(counts.keypoints, 3U);
  EXPECT_EQ(counts.present, 2U);
  EXPECT_EQ(counts.corresponding, 1U);
  EXPECT_EQ(counts.scans, 1U);
}

TEST(RegionsOf, MoveWithTheirScan) {
  const std::vector<Keypoint> keypoints{{.sensor_from_keypoint = {1, 0, 0.3}, .support_radius = 0.25F}};
  const Pose2 quarter_turn{2, 3, std::numbers::pi / 2};
  const Region native = regions_of(keypoints, quarter_turn, RegionRule::native, 0.5).front();
  EXPECT_NEAR(native.centre.x, 2, 1e-12);
  EXPECT_NEAR(native.centre.y, 4, 1e-12);
  EXPECT_EQ(native.radius, 0.25);
  EXPECT_EQ(regions_of(keypoints, quarter_turn, RegionRule::common, 0.5).front().radius, 0.5);
}

}  // namespace
}  // namespace flirt
