#include "flirt/arena/hough_matcher.hpp"

#include "tests/arena/point_sets.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace flirt {
namespace {

const std::vector<Point2> scattered{{2, 0}, {-1, 3}, {-3, -2}, {1.5, 4}, {4, -2.5}};
const Pose2 small_motion{0.55, -0.35, 0.2};

std::optional<HoughCell> cell_of(const std::vector<Point2>& a, const std::vector<Point2>& b,
                                 const HoughParams& params = {}) {
  const PointSets points{b, a};
  return most_voted_cell(points, all_pairs(points), params);
}

TEST(HoughMatcher, FindsThePlantedMotion) {
  const auto cell = cell_of(moved(scattered, small_motion), scattered);
  ASSERT_TRUE(cell);
  EXPECT_EQ(cell->votes, 5U);
  EXPECT_EQ(cell->turn, 5);
  EXPECT_EQ(cell->x, 5);
  EXPECT_EQ(cell->y, -4);
  EXPECT_NEAR(distance(cell->reference_from_query, small_motion), 0, 1e-9);
  EXPECT_NEAR(heading_difference(cell->reference_from_query, small_motion), 0, 1e-9);
}

TEST(HoughMatcher, FindsItAmidOutliers) {
  std::vector<Point2> a = moved(scattered, small_motion);
  a.insert(a.begin(), {{3.3, 3.1}, {-4, 0.7}});
  const PointSets points{scattered, a};
  const auto found = align_by_votes(points, all_pairs(points));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->pairs.size(), 5U);
  for (const IndexPair& pair : found->pairs) { EXPECT_EQ(pair.reference, pair.query + 2); }
  EXPECT_EQ(*found, *align_by_votes(points, all_pairs(points)));
}

TEST(HoughMatcher, CountsTheVotesOfItsCandidatesOnly) {
  const std::vector<Point2> a = moved(scattered, small_motion);
  const PointSets points{scattered, a};
  const std::vector<IndexPair> three{{0, 0}, {1, 1}, {3, 3}, {2, 4}};
  ASSERT_TRUE(most_voted_cell(points, three));
  EXPECT_EQ(most_voted_cell(points, three)->votes, 3U);
  const std::vector<IndexPair> one{{3, 3}, {2, 4}};
  EXPECT_FALSE(align_by_votes(points, one));
}

TEST(HoughMatcher, TurnsNoFartherThanAllowed) {
  const std::vector<Point2> a = moved(scattered, {0.55, -0.35, 2.48});
  EXPECT_FALSE(cell_of(a, scattered, {.turn_max = 1.57}));
  ASSERT_TRUE(cell_of(a, scattered));
  EXPECT_EQ(cell_of(a, scattered)->votes, 5U);
}

TEST(HoughMatcher, ReachesNoFartherThanAllowed) {
  EXPECT_FALSE(cell_of(moved(scattered, {7, 0, 0}), scattered));
  EXPECT_TRUE(cell_of(moved(scattered, {7, 0, 0}), scattered, {.shift_max = 8}));
}

TEST(HoughMatcher, FindsNothingWithoutPoints) {
  EXPECT_FALSE(cell_of({}, scattered));
  EXPECT_FALSE(cell_of(scattered, {}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(cell_of({{nan, nan}, {nan, 0}, {0, nan}}, scattered));
}

}  // namespace
}  // namespace flirt
