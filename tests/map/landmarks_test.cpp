#include "flirt/map/landmarks.hpp"

#include "flirt/features/extract.hpp"

#include "tests/support/map_examples.hpp"
#include "tests/support/room_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace flirt {
namespace {

/// One keypoint ahead of the sensor whose descriptor is one bin.
Features one_feature(const Pose2& sensor_from_keypoint, std::size_t bin) {
  Features features;
  features.keypoints.push_back({.sensor_from_keypoint = sensor_from_keypoint});
  features.descriptors = {.dimension = 16, .stride = 16, .rows = std::vector<float>(16), .roots = {}, .variances = {}};
  features.descriptors.rows[bin] = 1;
  features.descriptors.roots = features.descriptors.rows;
  return features;
}

Landmarks landmarks_of(const std::vector<std::pair<Pose2, Features>>& scans) {
  PlaceMapBuilder builder;
  for (const auto& [pose, features] : scans) { builder.add({.ranges = {1.0}}, pose, features); }
  return {std::move(builder).build(), {}};
}

TEST(Landmarks, OnePlaceSeenFromManyScansIsOneLandmark) {
  std::vector<std::pair<Pose2, Features>> scans;
  for (const Pose2& map_from_sensor : {Pose2{0, 0, 0}, Pose2{1, 0.5, 0.3}, Pose2{2, -1, -2}}) {
    scans.emplace_back(map_from_sensor, one_feature(inverse(map_from_sensor) * Pose2{4, 1, 0.5}, 3));
  }
  EXPECT_EQ(landmarks_of(scans).size(), 1U);
}

TEST(Landmarks, OtherPlacesDirectionsAndLooksAreOtherLandmarks) {
  const auto count = [](const Pose2& second, std::size_t bin) {
    return landmarks_of({{Pose2{}, one_feature({4, 1, 0.5}, 3)}, {Pose2{}, one_feature(second, bin)}}).size();
  };
  EXPECT_EQ(count({4.05, 1, 0.5}, 3), 1U);
  EXPECT_EQ(count({4.5, 1, 0.5}, 3), 2U);
  EXPECT_EQ(count({4, 1, 1.5}, 3), 2U);
  EXPECT_EQ(count({4, 1, 0.5}, 7), 2U);
}

TEST(Landmarks, DirectionsAcrossPiAreNeighbours) {
  const double pi = std::numbers::pi;
  EXPECT_EQ(
      landmarks_of({{Pose2{}, one_feature({4, 1, pi - 0.05}, 3)}, {Pose2{}, one_feature({4, 1, 0.05 - pi}, 3)}}).size(),
      1U);
}

TEST(Landmarks, OneCorrespondenceFixesThePoseToABin) {
  const Landmarks landmarks = landmarks_of({{Pose2{10, 20, 1}, one_feature({4, 1, 0.5}, 3)}});
  const Pose2 truth{9, 21, -2.9};
  const Pose2 map_from_landmark = Pose2{10, 20, 1} * Pose2{4, 1, 0.5};
  const std::vector<Pose2> places = landmarks.vote(one_feature(inverse(truth) * map_from_landmark, 3));
  ASSERT_EQ(places.size(), 8U);  // the bins around the pose
  for (const Pose2& place : places) { EXPECT_TRUE(is_near(place, truth, 0.71, 0.22)); }
}

TEST(Landmarks, TheTruthIsAmongThePlacesThatAScanOfTheRoomVotesFor) {
  const Landmarks landmarks(room_map(), {});
  EXPECT_LT(landmarks.size(), room_map().feature_count());
  for (const Pose2& truth : {Pose2{0.3, 0.2, 1.0}, Pose2{-0.6, 0.9, -2.8}, Pose2{1.0, -1.2, 0.1}}) {
    const std::vector<Pose2> places = landmarks.vote(extract(room_scan(truth)));
    ASSERT_GE(places.size(), 20U);
    EXPECT_TRUE(std::ranges::any_of(std::span(places).first(20),
                                    [&](const Pose2& place) { return is_near(place, truth, 0.71, 0.22); }));
  }
}

TEST(Landmarks, ExcludedScansLeaveNone) {
  const Landmarks none(room_map(), {}, {0, room_map().size()});
  EXPECT_EQ(none.size(), 0U);
  EXPECT_TRUE(none.vote(extract(room_scan({}))).empty());
}

TEST(Landmarks, AKeypointBeyondAnySensorIsNone) {
  EXPECT_EQ(landmarks_of({{{}, one_feature({3e9, 0, 0}, 3)}, {{}, one_feature({0, -2e6, 0}, 3)}}).size(), 0U);
}

TEST(Landmarks, AScanWithoutKeypointsVotesForNothing) {
  EXPECT_TRUE(Landmarks(room_map(), {}).vote({}).empty());
}

}  // namespace
}  // namespace flirt
