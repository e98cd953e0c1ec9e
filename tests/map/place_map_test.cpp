#include "flirt/map/place_map.hpp"

#include "tests/support/map_examples.hpp"
#include "tests/support/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace flirt {
namespace {

using testing::HasSubstr;

/// What from_columns says about a map whose columns were changed by `spoil`.
template <class Spoil>
std::string complaint_after(const Spoil& spoil) {
  PlaceMapVectors vectors = vectors_of(small_map());
  spoil(vectors);
  const Result<PlaceMap> map = PlaceMap::from_columns(views_of(vectors), 12, 16, {}, EvidenceGrid(), nullptr);
  return map ? "" : map.error().message;
}

TEST(PlaceMap, HoldsWhatWasAdded) {
  const PlaceMap map = small_map();
  ASSERT_EQ(map.size(), 3U);
  EXPECT_EQ(map.feature_count(), 5U);
  EXPECT_EQ(map.descriptor_dimension(), 12U);
  EXPECT_EQ(map.descriptor_stride(), 16U);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Scan expected = small_map_scan(i);
    EXPECT_EQ(map.map_from_sensor(i), small_map_pose(i));
    const Scan stored = map.scan(i);
    EXPECT_EQ(stored.robot_from_sensor, expected.robot_from_sensor);
    EXPECT_EQ(stored.beams.angle_min, expected.beams.angle_min);
    EXPECT_EQ(stored.beams.angle_step, expected.beams.angle_step);
    ASSERT_EQ(stored.ranges.size(), expected.ranges.size());
    const Features features = small_map_features(i);
    const FeatureColumns columns = map.features(i);
    ASSERT_EQ(columns.keypoints.size(), features.keypoints.size());
    ASSERT_EQ(columns.descriptors.count, features.keypoints.size());
    for (std::size_t k = 0; k < features.keypoints.size(); ++k) {
      EXPECT_EQ(columns.keypoints.x[k], static_cast<float>(features.keypoints[k].sensor_from_keypoint.x));
      EXPECT_EQ(columns.keypoints.y[k], static_cast<float>(features.keypoints[k].sensor_from_keypoint.y));
      EXPECT_EQ(columns.keypoints.theta[k], static_cast<float>(features.keypoints[k].sensor_from_keypoint.theta));
      EXPECT_EQ(columns.descriptors.rows[k * 16], features.descriptors.rows[k * 16]);
      EXPECT_EQ(columns.descriptors.roots[k * 16 + 1], features.descriptors.roots[k * 16 + 1]);
    }
  }
}

TEST(PlaceMap, RobotPoseTakesOffTheMounting) {
  const PlaceMap map = small_map();
  const Pose2 sensor = map.map_from_robot(1) * small_map_scan(1).robot_from_sensor;
  EXPECT_NEAR(distance(sensor, map.map_from_sensor(1)), 0, 1e-12);
  EXPECT_NEAR(heading_difference(sensor, map.map_from_sensor(1)), 0, 1e-12);
}

TEST(PlaceMap, StoresEachGeometryOnce) {
  const PlaceMap map = small_map();  // scans 0 and 2 come from the same scanner
  EXPECT_EQ(map.columns().beams.size(), 2U);
  EXPECT_EQ(map.columns().geometry[0], map.columns().geometry[2]);
  EXPECT_NE(map.columns().geometry[0], map.columns().geometry[1]);
}

TEST(PlaceMap, TakesAGeometryOfItsOwnForEachScan) {
  constexpr std::size_t scans = 50'000;
  PlaceMapBuilder builder;
  for (std::size_t i = 0; i < scans; ++i) {
    builder.add({.beams = {0, 0.01 + 1e-9 * static_cast<double>(i / 2), 0.1, 10}}, {}, {});
  }
  const PlaceMap map = std::move(builder).build();
  EXPECT_EQ(map.columns().beams.size(), scans / 2);
  EXPECT_EQ(map.columns().geometry.back(), scans / 2 - 1);
}

TEST(PlaceMap, ReadingsKeepTheirMeaningWhenRounded) {
  for (const double range_max : {80.1, 81.83, 81.91, 32.77, 51.2, 50.0}) {
    Scan scan{.beams = {0, 0.01, 0.1, range_max},
              .ranges = {range_max, range_max - 0.01, 0.1, 0.09, std::nan(""), 0, 1e300}};
    PlaceMapBuilder builder;
    builder.add(scan, {}, {});
    const PlaceMap map = std::move(builder).build();
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      EXPECT_EQ(classify(map.ranges(0)[i], map.beams(0)), classify(scan.ranges[i], scan.beams))
          << range_max << " " << i;
    }
  }
}

TEST(PlaceMap, KeepsVariancesOnlyOnRequest) {
  EXPECT_FALSE(small_map().has_variances());
  EXPECT_EQ(small_map().features(0).descriptors.variances, nullptr);
  const PlaceMap map = small_map(MapVariances::keep);
  ASSERT_TRUE(map.has_variances());
  EXPECT_EQ(map.features(2).descriptors.variances[0], small_map_features(2).descriptors.variances[0]);
}

TEST(PlaceMap, CopiesShareTheirColumns) {
  const PlaceMap map = small_map();
  const PlaceMap copy = map;  // NOLINT(performance-unnecessary-copy-initialization)
  EXPECT_EQ(copy.columns().ranges.data(), map.columns().ranges.data());
}

TEST(PlaceMap, MayBeEmpty) {
  const PlaceMap map = PlaceMapBuilder().build();
  EXPECT_EQ(map.size(), 0U);
  EXPECT_EQ(map.feature_count(), 0U);
}

TEST(PlaceMap, RejectsColumnsThatDoNotFit) {
  EXPECT_EQ(complaint_after([](PlaceMapVectors&) {}), "");
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.geometry.pop_back(); }), HasSubstr("geometry"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.geometry[1] = 2; }), HasSubstr("geometry"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.range_begin.pop_back(); }), HasSubstr("range_begin"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.range_begin[1] = 1'000'000; }), HasSubstr("range_begin"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.feature_begin[0] = 1; }), HasSubstr("feature_begin"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.feature_begin[3] = 4; }), HasSubstr("feature_begin"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.beam[4] = 5; }), HasSubstr("beam"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.y.pop_back(); }), HasSubstr("column y"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.theta[0] = std::nanf(""); }), HasSubstr("theta"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.descriptor_roots.pop_back(); }), HasSubstr("roots"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.descriptor_variances.resize(7); }), HasSubstr("variances"));
  EXPECT_THAT(
      complaint_after([](PlaceMapVectors& v) { v.map_from_sensor[2].x = std::numeric_limits<double>::infinity(); }),
      HasSubstr("map_from_sensor"));
  EXPECT_THAT(complaint_after([](PlaceMapVectors& v) { v.map_from_sensor[1].y = -2e7; }),
              HasSubstr("map_from_sensor: expected finite poses within 10 000 km, found another at 1"));
}

TEST(PlaceMap, RejectsEvidenceTooWideToSearch) {
  EvidenceGrid evidence;
  evidence.count({0, 0}, {.hits = 1, .passes = 0});
  evidence.count({400'000, 400'000}, {.hits = 1, .passes = 0});  // 20 km
  const PlaceMapVectors vectors = vectors_of(small_map());
  const auto map = PlaceMap::from_columns(views_of(vectors), 12, 16, {}, std::move(evidence), nullptr);
  EXPECT_THAT(map.error().message, HasSubstr("expected scans near each other, in a box of up to 100 km²"));
}

TEST(BuildPlaceMap, RejectsScansTooFarFromEachOther) {
  ScanLog log;
  for (const double x : {0.0, 20e3}) {
    log.scans.push_back(small_map_scan(0));
    log.map_from_robot.push_back({x, x, 0});
  }
  EXPECT_THAT(build_place_map(log).error().message, HasSubstr("found one of 20106 m x 20106 m"));
  log.map_from_robot[1] = {6e3, 6e3, 0};
  EXPECT_TRUE(build_place_map(log).has_value());
}

TEST(PlaceMap, RejectsImpossibleDescriptorShapes) {
  const PlaceMapVectors vectors = vectors_of(small_map());
  for (const auto& [dimension, stride] : {std::pair{17U, 16U}, {12U, 15U}, {0U, 16U}, {12U, 0U}, {12U, 1U << 30U}}) {
    EXPECT_FALSE(PlaceMap::from_columns(views_of(vectors), dimension, stride, {}, EvidenceGrid(), nullptr).has_value())
        << dimension << " " << stride;
  }
}

TEST(BuildPlaceMap, IsTheSameOnAnyNumberOfThreads) {
  const std::vector<Pose2> poses = poses_around(1.5, 7);
  const ScanLog log = log_of(furnished_room(), poses);
  const Result<PlaceMap> one = build_place_map(log, {}, 1);
  ASSERT_TRUE(one.has_value());
  EXPECT_GT(one->feature_count(), 7U * 5U);
  for (const std::size_t threads : {2U, 5U}) {
    const Result<PlaceMap> many = build_place_map(log, {}, threads);
    ASSERT_TRUE(many.has_value());
    EXPECT_TRUE(equal_columns(*one, *many)) << threads;
  }
}

TEST(BuildPlaceMap, NeedsAFinitePoseForEachScan) {
  const std::vector<Pose2> poses = poses_around(1.5, 2);
  ScanLog log = log_of(furnished_room(), poses);
  log.map_from_robot[1].theta = std::nan("");
  const Result<PlaceMap> not_finite = build_place_map(log);
  ASSERT_FALSE(not_finite.has_value());
  EXPECT_THAT(not_finite.error().message, HasSubstr("scan 1"));
  log.map_from_robot.clear();
  const Result<PlaceMap> none = build_place_map(log);
  ASSERT_FALSE(none.has_value());
  EXPECT_THAT(none.error().message, HasSubstr("poses"));
}

}  // namespace
}  // namespace flirt
