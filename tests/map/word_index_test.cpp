#include "flirt/map/word_index.hpp"

#include "flirt/features/extract.hpp"
#include "flirt/map/solution_set.hpp"

#include "tests/support/room_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace flirt {
namespace {

using testing::Contains;
using testing::ElementsAreArray;
using testing::IsEmpty;
using testing::SizeIs;

constexpr WordParams few_words{.words = 32, .samples = 500, .rounds = 3, .query_words = 2, .candidates = 5};

Features features_of_map_scan(const PlaceMap& map, std::size_t i) {
  return extract(map.scan(i), map.feature_params());
}

TEST(WordIndex, LeavesTheMapScanThatIsAsked) {
  const PlaceMap map = room_map();
  const WordIndex index(map, few_words);
  for (std::uint32_t scan = 0; scan < map.size(); ++scan) {
    EXPECT_THAT(index.most_alike(features_of_map_scan(map, scan)), Contains(scan));
  }
}

TEST(WordIndex, LeavesAsManyMapScansAsAskedInAscendingOrder) {
  const PlaceMap map = room_map();
  ASSERT_GT(map.size(), few_words.candidates);
  const std::vector<std::uint32_t> left = WordIndex(map, few_words).most_alike(features_of_map_scan(map, 0));
  EXPECT_THAT(left, SizeIs(few_words.candidates));
  EXPECT_TRUE(std::ranges::is_sorted(left));
  EXPECT_EQ(std::ranges::adjacent_find(left), left.end());
}

TEST(WordIndex, IsTheSameOnAnyNumberOfThreads) {
  const PlaceMap map = room_map();
  const WordIndex one(map, few_words, 1);
  const WordIndex three(map, few_words, 3);
  for (std::size_t scan = 0; scan < map.size(); ++scan) {
    const Features features = features_of_map_scan(map, scan);
    EXPECT_THAT(three.most_alike(features), ElementsAreArray(one.most_alike(features)));
  }
}

TEST(WordIndex, OfAnEmptyMapLeavesNothing) {
  const PlaceMap map = PlaceMapBuilder().build();
  EXPECT_THAT(WordIndex(map).most_alike(features_of_map_scan(room_map(), 0)), IsEmpty());
}

TEST(WordIndex, LeavesNothingForAScanWithoutKeypoints) {
  EXPECT_THAT(WordIndex(room_map(), few_words).most_alike({}), IsEmpty());
}

TEST(SolutionSet, AmongAllMapScansIsThatOfTheWholeMap) {
  const PlaceMap map = room_map();
  const Features features = features_of_map_scan(map, 1);
  std::vector<std::uint32_t> all(map.size());
  std::iota(all.begin(), all.end(), 0U);
  SolutionSetFinder finder(map);
  const SolutionSet whole = finder.find(features);
  const SolutionSet among = finder.find_among(features, all);
  ASSERT_EQ(among.hypotheses.size(), whole.hypotheses.size());
  ASSERT_FALSE(whole.hypotheses.empty());
  EXPECT_EQ(among.confidence, whole.confidence);
  EXPECT_EQ(among.best()->map_from_sensor, whole.best()->map_from_sensor);
  for (std::size_t i = 0; i < whole.hypotheses.size(); ++i) {
    EXPECT_EQ(among.hypotheses[i].map_scan, whole.hypotheses[i].map_scan);
    EXPECT_EQ(among.hypotheses[i].residual, whole.hypotheses[i].residual);
  }
}

TEST(SolutionSet, AmongSomeMapScansHasHypothesesOfThoseAlone) {
  const PlaceMap map = room_map();
  const std::vector<std::uint32_t> some{1, 2};
  const SolutionSet found = SolutionSetFinder(map).find_among(features_of_map_scan(map, 1), some);
  ASSERT_FALSE(found.hypotheses.empty());
  for (const Hypothesis& hypothesis : found.hypotheses) { EXPECT_THAT(some, Contains(hypothesis.map_scan)); }
}

}  // namespace
}  // namespace flirt
