#include "flirt/match/match.hpp"

#include "tests/match/random_features.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace flirt {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Features features_of(const std::vector<std::vector<float>>& rows) {
  Features features;
  for (const auto& row : rows) { test::append_row(features.descriptors, row); }
  features.keypoints.resize(rows.size());
  return features;
}

std::vector<std::pair<int, int>> pairs_of(const std::vector<Match>& matches) {
  std::vector<std::pair<int, int>> pairs;
  for (const Match& match : matches) { pairs.emplace_back(match.query, match.reference); }
  return pairs;
}

/// Query 0 and 1 look like reference 1, query 2 like nothing. Distances by hand: χ² of (a, 1−a) and (b, 1−b) is
/// ½ ((a−b)²/(a+b) + (a−b)²/(2−a−b)).
const Features& query() {
  static const Features features = features_of({{0.50F, 0.50F, 0}, {0.60F, 0.40F, 0}, {0, 0, 1}});
  return features;
}
const Features& reference() {
  static const Features features = features_of({{0.90F, 0.10F, 0}, {0.52F, 0.48F, 0}});
  return features;
}

TEST(Match, NearestTakesOneReferenceForEachQueryWithinTheThreshold) {
  const std::vector<Match> matches = match(query(), reference());
  EXPECT_THAT(pairs_of(matches), ElementsAre(std::pair(0, 1), std::pair(1, 1)));
  EXPECT_NEAR(matches[0].distance, 0.5 * (0.0004 / 1.02 + 0.0004 / 0.98), 1e-6);
  EXPECT_NEAR(matches[1].distance, 0.5 * (0.0064 / 1.12 + 0.0064 / 0.88), 1e-6);
}

TEST(Match, ThresholdIsStrict) {
  MatchParams params;
  params.max_distance = double{match(query(), reference())[1].distance};
  EXPECT_THAT(pairs_of(match(query(), reference(), params)), ElementsAre(std::pair(0, 1)));
}

TEST(Match, MutualDropsAQueryThatTheReferenceLikesLess) {
  EXPECT_THAT(pairs_of(match(query(), reference(), {.strategy = MatchStrategy::mutual})), ElementsAre(std::pair(0, 1)));
}

TEST(Match, MutualGivesATieToTheFirstQuery) {
  const Features twins = features_of({{1, 0}, {1, 0}});
  EXPECT_THAT(pairs_of(match(twins, features_of({{1, 0}}), {.strategy = MatchStrategy::mutual})),
              ElementsAre(std::pair(0, 0)));
}

TEST(Match, RatioDropsAQueryWithTwoLikelyReferences) {
  const Features two_alike = features_of({{0.52F, 0.48F, 0}, {0.48F, 0.52F, 0}, {0.9F, 0.1F, 0}});
  const MatchParams params{.strategy = MatchStrategy::ratio, .ratio = 0.8};
  EXPECT_THAT(pairs_of(match(query(), two_alike, params)), ElementsAre(std::pair(1, 0)));
  EXPECT_THAT(pairs_of(match(features_of({{1, 0}}), features_of({{0.9F, 0.1F}}), params)), ElementsAre(std::pair(0, 0)))
      << "a single reference has no second nearest";
}

TEST(Match, RatioDropsExactTwins) {
  const Features twins = features_of({{1, 0}, {1, 0}});
  EXPECT_THAT(match(features_of({{1, 0}}), twins, {.strategy = MatchStrategy::ratio}), IsEmpty());
}

TEST(Match, ThresholdTakesEveryPairNearestFirst) {
  EXPECT_THAT(pairs_of(match(query(), reference(), {.strategy = MatchStrategy::threshold})),
              ElementsAre(std::pair(0, 1), std::pair(0, 0), std::pair(1, 1), std::pair(1, 0)));
}

TEST(Match, TopKTakesTheNearestFew) {
  const Features many = features_of({{0.9F, 0.1F, 0}, {0.52F, 0.48F, 0}, {0.55F, 0.45F, 0}});
  EXPECT_THAT(pairs_of(match(query(), many, {.strategy = MatchStrategy::top_k, .k = 2})),
              ElementsAre(std::pair(0, 1), std::pair(0, 2), std::pair(1, 2), std::pair(1, 1)));
}

TEST(Match, TopOneIsNearestForEveryDistance) {
  Rng rng(1);
  Features a;
  Features b;
  a.descriptors = test::random_descriptors(rng, 30, 48);
  b.descriptors = test::random_descriptors(rng, 25, 48);
  a.keypoints.resize(30);
  b.keypoints.resize(25);
  for (const auto& [distance, name] : enum_names(Distance{})) {
    const MatchParams nearest{.distance = distance, .max_distance = 10.0};
    const MatchParams top_one{.distance = distance, .strategy = MatchStrategy::top_k, .max_distance = 10.0, .k = 1};
    const std::vector<Match> matches = match(a, b, nearest);
    EXPECT_EQ(matches.size(), 30U);
    EXPECT_EQ(matches, match(a, b, top_one)) << name;
  }
}

TEST(Match, OfAnEmptyScanIsEmpty) {
  for (const auto& [strategy, name] : enum_names(MatchStrategy{})) {
    EXPECT_THAT(match({}, reference(), {.strategy = strategy}), IsEmpty()) << name;
    EXPECT_THAT(match(query(), {}, {.strategy = strategy}), IsEmpty()) << name;
  }
}

TEST(MatchParams, DefaultsAreWithinTheirRanges) {
  EXPECT_EQ(out_of_range(MatchParams{}), "");
  EXPECT_NE(out_of_range(MatchParams{.ratio = 1.5}), "");
}

}  // namespace
}  // namespace flirt
