#include "flirt/eval/matching_counts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace flirt {
namespace {

// Two interest points of the reference, three of the other scan; (0, 0) and (1, 2) are the same place.
const std::vector<float> distances{0.1F, 0.3F, 0.9F,  //
                                   0.2F, 0.8F, 0.5F};
const std::vector<RegionPair> same_place{{0, 0}, {1, 2}};

TEST(MatchingCurve, OfAllPairsIsTheOneByHand) {
  // By rising distance: right .1, wrong .2, wrong .3, right .5, wrong .8, wrong .9.
  const MatchingCounts counts = count_matches(distances, 3, same_place, Distance::chi_square, PairRule::all);
  EXPECT_EQ(counts.correspondences, 2U);
  const auto curve = matching_curve(counts);
  ASSERT_EQ(curve.size(), 6U);
  EXPECT_DOUBLE_EQ(curve[0].precision, 1);
  EXPECT_DOUBLE_EQ(curve[0].recall, 0.5);
  EXPECT_DOUBLE_EQ(curve[2].precision, 1.0 / 3);
  EXPECT_DOUBLE_EQ(curve[3].precision, 0.5);
  EXPECT_DOUBLE_EQ(curve[3].recall, 1);
  EXPECT_DOUBLE_EQ(curve[5].precision, 2.0 / 6);
  EXPECT_DOUBLE_EQ(average_precision(counts), 0.5 * 1 + 0.5 * 0.5);
}

TEST(MatchingCurve, OfNearestNeighboursHasOneMatchPerPoint) {
  // Point 0 takes (0, 0), right; point 1 takes (1, 0) at .2, wrong.
  const MatchingCounts counts = count_matches(distances, 3, same_place, Distance::chi_square, PairRule::nearest);
  EXPECT_EQ(counts.correspondences, 2U);
  EXPECT_EQ(std::accumulate(counts.matches.begin(), counts.matches.end(), 0U), 2U);
  EXPECT_DOUBLE_EQ(average_precision(counts), 0.5);
}

TEST(MatchingCounts, AddUpOverPairsOfScans) {
  MatchingCounts twice = count_matches(distances, 3, same_place, Distance::chi_square, PairRule::all);
  const double once = average_precision(twice);
  twice += MatchingCounts(twice);
  EXPECT_EQ(twice.correspondences, 4U);
  EXPECT_DOUBLE_EQ(average_precision(twice), once);
}

TEST(MatchingCounts, OfNothingAreNothing) {
  const MatchingCounts counts = count_matches({}, 0, {}, Distance::chi_square, PairRule::all);
  EXPECT_TRUE(matching_curve(counts).empty());
  EXPECT_EQ(average_precision(counts), 0);
}

TEST(DistanceThreshold, RisesToInfinity) {
  for (const auto& [distance, name] : enum_names(Distance{})) {
    for (std::size_t k = 1; k < threshold_count; ++k) {
      EXPECT_GT(distance_threshold(distance, k), distance_threshold(distance, k - 1)) << name;
    }
    EXPECT_TRUE(std::isinf(distance_threshold(distance, threshold_count - 1)));
  }
}

TEST(MatchingCounts, TakeAnInfiniteDistance) {
  const std::vector<float> far{INFINITY};
  const MatchingCounts counts = count_matches(far, 1, {}, Distance::bhattacharyya, PairRule::all);
  EXPECT_EQ(counts.matches.back(), 1U);
}

}  // namespace
}  // namespace flirt
