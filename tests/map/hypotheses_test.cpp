#include "flirt/map/hypotheses.hpp"

#include "flirt/core/rng.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace flirt {
namespace {

Hypothesis hypothesis(const Pose2& map_from_sensor, std::uint32_t inliers, double residual,
                      std::uint32_t map_scan = 0) {
  return {.map_from_sensor = map_from_sensor, .map_scan = map_scan, .inliers = inliers, .residual = residual};
}

std::vector<std::uint32_t> map_scans(const std::vector<Hypothesis>& hypotheses) {
  std::vector<std::uint32_t> scans;
  for (const Hypothesis& each : hypotheses) { scans.push_back(each.map_scan); }
  return scans;
}

TEST(Hypotheses, WeightsAreInverseResidualsOfSumOne) {
  std::vector<Hypothesis> hypotheses{hypothesis({}, 3, 0.01), hypothesis({}, 3, 0.03), hypothesis({}, 9, 0.06)};
  set_weights(hypotheses);
  EXPECT_DOUBLE_EQ(hypotheses[0].weight, 6.0 / 9.0);
  EXPECT_DOUBLE_EQ(hypotheses[1].weight, 2.0 / 9.0);
  EXPECT_DOUBLE_EQ(hypotheses[2].weight, 1.0 / 9.0);
}

TEST(Hypotheses, AnExactMatchDoesNotSilenceTheOthers) {
  std::vector<Hypothesis> hypotheses{hypothesis({}, 3, 0.0), hypothesis({}, 3, 1e-6)};
  set_weights(hypotheses);
  EXPECT_DOUBLE_EQ(hypotheses[0].weight, 0.5);
  EXPECT_DOUBLE_EQ(hypotheses[1].weight, 0.5);
}

TEST(Hypotheses, OrderIsThePapers) {
  std::vector<Hypothesis> hypotheses{hypothesis({}, 5, 0.02, 0), hypothesis({}, 9, 0.02, 1), hypothesis({}, 4, 0.01, 2),
                                     hypothesis({}, 9, 0.03, 3), hypothesis({}, 5, 0.02, 4)};
  sort_hypotheses(hypotheses, HypothesisOrder::corresp);
  EXPECT_THAT(map_scans(hypotheses), testing::ElementsAre(1, 3, 0, 4, 2));
  sort_hypotheses(hypotheses, HypothesisOrder::residual);
  EXPECT_THAT(map_scans(hypotheses), testing::ElementsAre(2, 1, 0, 4, 3));
}

TEST(Hypotheses, NearPosesAreOnePlace) {
  const double pi = std::numbers::pi;
  std::vector<Hypothesis> hypotheses{
      hypothesis({0, 0, pi}, 9, 0.01),             // founds the first place
      hypothesis({0.4, 0.2, -pi + 0.1}, 8, 0.02),  // the same place, across the seam of the angle
      hypothesis({0.6, 0, pi}, 7, 0.02),           // 0.6 m away
      hypothesis({0, 0, pi - 0.2}, 6, 0.04),       // 0.2 rad away
  };
  set_weights(hypotheses);
  const std::vector<Place> places = distinct_places(hypotheses, 0.5, radians_from_degrees(10));
  ASSERT_EQ(places.size(), 3U);
  EXPECT_EQ(places[0].hypothesis, 0U);
  EXPECT_EQ(places[0].support, 2U);
  EXPECT_EQ(places[0].inliers, 9U);
  EXPECT_DOUBLE_EQ(places[0].weight, hypotheses[0].weight + hypotheses[1].weight);
  EXPECT_EQ(places[1].hypothesis, 2U);
  EXPECT_EQ(places[2].hypothesis, 3U);
  EXPECT_DOUBLE_EQ(places[0].weight + places[1].weight + places[2].weight, 1.0);
}

TEST(Hypotheses, PlacesComeInTheOrderOfTheirBestMatch) {
  std::vector<Hypothesis> hypotheses{hypothesis({0, 0, 0}, 9, 0.01), hypothesis({5, 0, 0}, 8, 0.012),
                                     hypothesis({5.1, 0, 0}, 8, 0.013)};
  set_weights(hypotheses);
  const std::vector<Place> places = distinct_places(hypotheses, 0.5, 0.2);
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[0].hypothesis, 0U);
  EXPECT_LT(places[0].weight, places[1].weight);
}

/// The definition, all hypotheses against all places.
std::vector<Place> plain_places(const std::vector<Hypothesis>& sorted, double max_distance, double max_heading) {
  std::vector<Place> places;
  for (std::uint32_t i = 0; i < sorted.size(); ++i) {
    auto place = std::ranges::find_if(places, [&](const Place& candidate) {
      const Pose2& founder = sorted[candidate.hypothesis].map_from_sensor;
      return distance(founder, sorted[i].map_from_sensor) <= max_distance &&
             heading_difference(founder, sorted[i].map_from_sensor) <= max_heading;
    });
    if (place == places.end()) { place = places.insert(place, {.hypothesis = i}); }
    place->support += 1;
    place->inliers = std::max(place->inliers, sorted[i].inliers);
    place->weight += sorted[i].weight;
  }
  return places;
}

TEST(Hypotheses, PlacesAreThoseOfAllAgainstAllBitByBit) {
  Rng rng(1);
  for (const double distance : {0.0, 0.1, 0.5, 3.0, 1000.0}) {
    for (const double offset : {0.0, -1e6}) {
      std::vector<Hypothesis> hypotheses;
      for (std::uint32_t i = 0; i < 400; ++i) {  // multiples of 0.1: many lie at the distance itself, and on cell edges
        const Pose2 pose{offset + 0.1 * rng.below(60), 0.1 * rng.below(60), rng.uniform(-3.14, 3.14)};
        hypotheses.push_back(hypothesis(pose, 3 + rng.below(9), 0.001 * rng.uniform(), i));
      }
      sort_hypotheses(hypotheses, HypothesisOrder::residual);
      set_weights(hypotheses);
      const std::vector<Place> places = distinct_places(hypotheses, distance, 0.5);
      const std::vector<Place> expected = plain_places(hypotheses, distance, 0.5);
      ASSERT_EQ(places.size(), expected.size());
      for (std::size_t i = 0; i < places.size(); ++i) {
        EXPECT_EQ(places[i].hypothesis, expected[i].hypothesis);
        EXPECT_EQ(places[i].support, expected[i].support);
        EXPECT_EQ(places[i].inliers, expected[i].inliers);
        EXPECT_EQ(places[i].weight, expected[i].weight);
      }
    }
  }
}

TEST(Hypotheses, TheScoreIsTheShareThatIsExplained) {
  EXPECT_DOUBLE_EQ(score_from_residual(0, 0.1), 1);
  EXPECT_DOUBLE_EQ(score_from_residual(0.25 * 5.99 * 0.01, 0.1), 0.75);
  EXPECT_NEAR(score_from_residual(5.99 * 0.01, 0.1), 0, 1e-15);
}

TEST(Hypotheses, NoHypothesesAreNoPlaces) {
  set_weights({});
  EXPECT_TRUE(distinct_places({}, 0.5, 0.2).empty());
}

}  // namespace
}  // namespace flirt
