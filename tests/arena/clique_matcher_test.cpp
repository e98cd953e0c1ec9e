#include "flirt/arena/clique_matcher.hpp"

#include "tests/arena/point_sets.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace flirt {
namespace {

using testing::ElementsAre;

const std::vector<Point2> five{{0, 0}, {4, 0}, {0, 3}, {5.5, 6.1}, {-2.3, 1.7}};

/// Fit of `b` onto `a`, by all pairs.
std::optional<PointAlignment> align(const std::vector<Point2>& a, const std::vector<Point2>& b,
                                    const CliqueParams& params = {}) {
  const PointSets points{b, a};
  return align_by_clique(points, all_pairs(points), params);
}

TEST(CliqueMatcher, FindsTheMotionOfMovedPoints) {
  const std::vector<Point2> a{{0, 0}, {4, 0}, {0, 3}};
  const auto found = align(a, moved(a, quarter_turn));
  ASSERT_TRUE(found);
  EXPECT_THAT(found->pairs, ElementsAre(IndexPair{0, 0}, IndexPair{1, 1}, IndexPair{2, 2}));
  EXPECT_NEAR(found->reference_from_query.x, -5, 1e-9);
  EXPECT_NEAR(found->reference_from_query.y, 10, 1e-9);
  EXPECT_NEAR(found->reference_from_query.theta, -std::numbers::pi / 2, 1e-9);
  EXPECT_TRUE(found->is_proven);
}

TEST(CliqueMatcher, RefusesAMirrorImageAndAnotherLength) {
  EXPECT_FALSE(align({{0, 0}, {4, 0}, {0, 3}}, moved(std::vector<Point2>{{0, 0}, {4, 0}, {0, -3}}, quarter_turn)));
  EXPECT_FALSE(align({{0, 0}, {1, 0}}, {{0, 0}, {5, 0}}));
}

TEST(CliqueMatcher, FindsThePlantedSubsetAmidOutliers) {
  std::vector<Point2> a = five;
  a.insert(a.end(), {{9.1, -3.3}, {-7.7, -8.2}});
  std::vector<Point2> b{{20, 20}, {-15, 3}};
  for (const Point2 point : moved(five, quarter_turn)) { b.push_back(point); }
  const auto found = align(a, b);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->pairs,
              ElementsAre(IndexPair{2, 0}, IndexPair{3, 1}, IndexPair{4, 2}, IndexPair{5, 3}, IndexPair{6, 4}));
  EXPECT_NEAR(distance(found->reference_from_query, inverse(quarter_turn)), 0, 1e-9);
}

TEST(CliqueMatcher, FitsNoisyPointsByLeastSquares) {
  std::vector<Point2> noisy = five;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    noisy[i] = noisy[i] + Point2{i % 2 == 0 ? -0.02 : 0.02, i % 3 == 0 ? -0.02 : 0.02};
  }
  const auto found = align(five, moved(noisy, quarter_turn));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->pairs.size(), 5U);
  EXPECT_NEAR(found->reference_from_query.x, -5.016520, 1e-5);
  EXPECT_NEAR(found->reference_from_query.y, 9.979101, 1e-5);
  EXPECT_NEAR(found->reference_from_query.theta, -1.568175, 1e-5);
}

TEST(CliqueMatcher, LeavesOutShortSegmentsWhenAsked) {
  EXPECT_TRUE(align({{0, 0}, {0.06, 0}}, {{0, 0}, {0.02, 0}}));
  EXPECT_FALSE(align({{0, 0}, {0.06, 0}}, {{0, 0}, {0.02, 0}}, {.distance_min = 0.1}));
}

TEST(CliqueMatcher, TakesAllPointsOfASquare) {
  const std::vector<Point2> square{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  const auto found = align(square, square);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->pairs.size(), 4U);
  EXPECT_EQ(*found, *align(square, square));
}

TEST(CliqueMatcher, ChoosesAmongTheCandidatesOnly) {
  const PointSets points{five, five};
  const std::vector<IndexPair> candidates{{0, 0}, {1, 3}, {2, 2}, {4, 4}};
  const auto found = align_by_clique(points, candidates);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->pairs, ElementsAre(IndexPair{0, 0}, IndexPair{2, 2}, IndexPair{4, 4}));
}

TEST(CliqueMatcher, FindsNothingWithoutPoints) {
  EXPECT_FALSE(align({}, five));
  EXPECT_FALSE(align(five, {}));
  EXPECT_FALSE(align({{1, 1}}, five));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(align({{nan, nan}, {nan, 0}, {0, nan}}, five));
}

}  // namespace
}  // namespace flirt
