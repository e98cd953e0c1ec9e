// Recordings of ROS as logs: which scans, where the scanner sits, which poses, and what is said when there are none.
#include "flirt/io/ros_log.hpp"

#include "flirt/io/format.hpp"
#include "flirt/io/log.hpp"

#include "tests/io/ros_bytes.hpp"
#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace flirt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

constexpr double half_turn = std::numbers::pi;

/// A recording as a list of messages, written as a ROS 1 bag.
struct Recording {
  std::vector<BagMessage> messages{};

  void scan(double stamp, std::string frame = "laser", std::string topic = "/scan") {
    const ros::LaserScan scan{.stamp = stamp,
                              .frame = std::move(frame),
                              .beams = {.angle_min = -0.5, .angle_step = 0.25, .range_min = 0.125, .range_max = 30.0},
                              .ranges = {1.5, 2.0, 2.5, 2.25, 2.0}};
    add(std::move(topic), std::string(ros::laser_scan_type), scan_bytes(scan, bag::Serialization::ros1));
  }
  void transform(double stamp, std::string parent, std::string child, const Eigen::Isometry3d& pose) {
    const ros::Transform transform{stamp, std::move(parent), std::move(child), pose};
    add("/tf", "tf2_msgs/TFMessage", transform_bytes({transform}, bag::Serialization::ros1));
  }
  void odometry(double stamp, const Pose2& pose, std::string child = "base", std::string topic = "/odom") {
    const ros::Transform transform{stamp, "odom", std::move(child), in_space(pose)};
    add(std::move(topic), std::string(ros::odometry_type), odometry_bytes(transform, bag::Serialization::ros1));
  }
  void add(std::string topic, std::string type, std::string bytes) {
    messages.push_back({std::move(topic), std::move(type), bag::Serialization::ros1, std::move(bytes)});
  }

  [[nodiscard]] Result<LoadedLog> read(const ReadOptions& options = {}) const {
    const TemporaryFolder folder;
    return read_log(folder.file("run.bag", rosbag1_file(messages)), options);
  }
};

void expect_near(const Pose2& found, const Pose2& expected) {
  EXPECT_NEAR(found.x, expected.x, 1e-9);
  EXPECT_NEAR(found.y, expected.y, 1e-9);
  EXPECT_NEAR(heading_difference(found, expected), 0.0, 1e-9);
}

TEST(RosLog, ScansAsTheyWereRecorded) {
  Recording recording;
  recording.scan(1.0);
  recording.scan(0.5);
  recording.add("/camera", "sensor_msgs/Image", "pixels");
  const LoadedLog loaded = recording.read().value();
  ASSERT_EQ(loaded.log.scans.size(), 2U);
  EXPECT_EQ(loaded.log.scans[0].stamp, 1.0);
  EXPECT_THAT(loaded.log.scans[0].ranges, ElementsAre(1.5, 2.0, 2.5, 2.25, 2.0));
  EXPECT_EQ(loaded.log.scans[0].beams.angle_step, 0.25);
  EXPECT_EQ(loaded.report.format, "ROS 1 bag");
  EXPECT_EQ(loaded.report.message, "/scan");
  EXPECT_EQ(loaded.report.lines, 3U);
  EXPECT_THAT(loaded.report.lines_used, ElementsAre(Pair("/scan", 2)));
  EXPECT_THAT(loaded.report.lines_skipped, ElementsAre(Pair("/camera", 1)));
  EXPECT_EQ(loaded.report.stamps_backwards, 1U);
  EXPECT_EQ(loaded.report.poses, PoseSource::none);
  EXPECT_THAT(observations(loaded.report), testing::Contains(HasSubstr("does not say where the scanner sits")));
}

TEST(RosLog, FirstScannerUnlessAnotherIsWanted) {
  Recording recording;
  recording.scan(1.0, "front", "/front");
  recording.scan(2.0, "back", "/back");
  EXPECT_EQ(recording.read()->log.scans.at(0).stamp, 1.0);
  EXPECT_EQ(recording.read({.message = "/back"})->log.scans.at(0).stamp, 2.0);
  EXPECT_THAT(recording.read({.message = "/left"}).error().message,
              HasSubstr("run.bag: expected scans on /left, found them on /front, /back"));
}

TEST(RosLog, WithoutScansSaysWhatThereIs) {
  Recording recording;
  recording.add("/camera", "sensor_msgs/Image", "pixels");
  EXPECT_THAT(recording.read().error().message,
              HasSubstr("expected a topic of type sensor_msgs/LaserScan, found only /camera"));
}

TEST(RosLog, OdometryOfTransformsIsInterpolated) {
  Recording recording;
  recording.transform(0.0, "base", "laser", in_space({0.3, 0.1, half_turn}));
  recording.scan(1.25);  // before the poses around it
  recording.transform(1.0, "odom", "base", in_space({1, 2, 0.5}));
  recording.transform(2.0, "odom", "base", in_space({3, 2, 0.9}));
  const LoadedLog loaded = recording.read().value();
  EXPECT_EQ(loaded.report.poses, PoseSource::odometry);
  EXPECT_FALSE(loaded.report.is_mounting_unknown);
  expect_near(loaded.log.scans[0].robot_from_sensor, {0.3, 0.1, half_turn});
  expect_near(*loaded.log.scans[0].odom_from_robot, {1.5, 2, 0.6});
  expect_near(loaded.log.map_from_robot.at(0), {1.5, 2, 0.6});
}

TEST(RosLog, ARobotThatStoodMovesWhenItDid) {
  Recording recording;
  recording.transform(0.0, "base", "laser", in_space({0.3, 0.1, 1.0}));
  for (const double stamp : {0.0, 1.0, 2.0, 3.0}) { recording.transform(stamp, "odom", "base", in_space({1, 2, 0.5})); }
  recording.transform(4.0, "odom", "base", in_space({2, 2, 0.5}));
  for (const double stamp : {1.5, 3.0, 3.25}) { recording.scan(stamp); }
  const LoadedLog loaded = recording.read().value();
  expect_near(*loaded.log.scans[0].odom_from_robot, {1, 2, 0.5});
  expect_near(*loaded.log.scans[1].odom_from_robot, {1, 2, 0.5});
  expect_near(*loaded.log.scans[2].odom_from_robot, {1.25, 2, 0.5});
  EXPECT_EQ(loaded.log.scans[0].robot_from_sensor, loaded.log.scans[2].robot_from_sensor);
}

TEST(RosLog, TransformsGoBeforeOdometryMessages) {
  Recording recording;
  recording.transform(0.0, "base", "laser", in_space({}));
  recording.transform(1.0, "odom", "base", in_space({1, 0, 0}));
  recording.odometry(1.0, {5, 5, 0});
  recording.scan(1.0);
  expect_near(*recording.read()->log.scans[0].odom_from_robot, {1, 0, 0});
}

TEST(RosLog, OdometryMessagesWhereTransformsDoNotMove) {
  Recording recording;
  recording.transform(0.0, "base_link", "laser", in_space({0.2, 0, 0}));
  recording.transform(0.0, "base_footprint", "base_link", in_space({0.1, 0, 0}));
  recording.odometry(1.0, {5, 5, 1}, "base_link");
  recording.odometry(1.0, {7, 7, 1}, "base_link", "/filtered");
  recording.scan(1.0);
  const LoadedLog loaded = recording.read().value();
  expect_near(*loaded.log.scans[0].odom_from_robot, {5, 5, 1});
  expect_near(loaded.log.scans[0].robot_from_sensor, {0.2, 0, 0});
  EXPECT_THAT(loaded.report.lines_skipped, ElementsAre(Pair("/filtered", 1)));
}

TEST(RosLog, PosesInTheMapAreCorrected) {
  Recording recording;
  recording.transform(0.0, "robot/base", "laser", in_space({}));
  recording.transform(1.0, "robot/odom", "robot/base", in_space({1, 0, 0}));
  recording.transform(1.0, "/robot/map", "/robot/odom", in_space({0, 10, half_turn / 2}));
  recording.scan(1.0);
  const LoadedLog loaded = recording.read().value();
  EXPECT_EQ(loaded.report.poses, PoseSource::corrected_and_odometry);
  expect_near(*loaded.log.scans[0].odom_from_robot, {1, 0, 0});
  expect_near(loaded.log.map_from_robot.at(0), {0, 11, half_turn / 2});
}

TEST(RosLog, PosesInTheMapWithoutOdometry) {
  Recording recording;
  recording.transform(0.0, "base", "laser", in_space({}));
  recording.transform(1.0, "map", "base", in_space({4, 0, 0}));
  recording.scan(1.0);
  const LoadedLog loaded = recording.read().value();
  EXPECT_EQ(loaded.report.poses, PoseSource::corrected);
  EXPECT_FALSE(loaded.log.scans[0].odom_from_robot);
  expect_near(loaded.log.map_from_robot.at(0), {4, 0, 0});
}

TEST(RosLog, NoOdometryLongAfterItsEnd) {
  Recording recording;
  recording.odometry(1.0, {1, 0, 0});
  recording.odometry(2.0, {2, 0, 0});
  recording.scan(2.9);
  recording.scan(3.1);
  const LoadedLog loaded = recording.read().value();
  expect_near(*loaded.log.scans[0].odom_from_robot, {2, 0, 0});
  EXPECT_FALSE(loaded.log.scans[1].odom_from_robot);
  EXPECT_TRUE(loaded.log.map_from_robot.empty());
}

TEST(RosLog, AClockThatIsSetBackDoesNotMixTwoStretches) {
  Recording recording;
  for (int i = 0; i < 100; ++i) {
    const double stamp = 100.0 + 0.5 * i - (i < 50 ? 0 : 20);  // after 25 s 20 s back
    const double x = 0.5 * i;
    if (i != 50) { recording.odometry(stamp, {x, 0, 0}); }
    recording.scan(stamp + 0.01, "base");
    if (i == 50) { recording.odometry(stamp, {x, 0, 0}); }  // the first scan came before its odometry
  }
  const LoadedLog loaded = recording.read().value();
  ASSERT_EQ(loaded.log.scans.size(), 100U);
  for (int i = 0; i < 100; ++i) {
    const auto& odometry = loaded.log.scans[static_cast<std::size_t>(i)].odom_from_robot;
    ASSERT_TRUE(odometry) << i;
    EXPECT_NEAR(odometry->x, 0.5 * i, 0.02) << i;
  }
}

TEST(RosLog, TransformsOfTwoStretchesAreNotMixed) {
  Recording recording;
  recording.transform(0.0, "base", "laser", in_space({0.2, 0, 0}));
  for (int i = 0; i < 100; ++i) {
    const double stamp = 100.0 + 0.5 * i - (i < 50 ? 0 : 20);
    recording.transform(stamp, "odom", "base", in_space({0.5 * i, 0, 0}));
    recording.transform(stamp, "map", "odom", in_space({0, 0.5 * i, 0}));
    recording.scan(i == 50 ? 124.51 : stamp + 0.01);  // the last scan of the first stretch came late
  }
  const LoadedLog loaded = recording.read().value();
  for (int i = 0; i < 100; ++i) {
    const auto scan = static_cast<std::size_t>(i);
    const double x = i == 50 ? 24.5 : 0.5 * i;
    EXPECT_NEAR(loaded.log.scans[scan].odom_from_robot.value_or(Pose2{}).x, x, 0.02) << i;
    EXPECT_NEAR(loaded.log.map_from_robot[scan].y, x, 0.02) << i;
  }
}

TEST(RosLog, ARobotThatStandsWhenItsClockIsSetBackKeepsItsPose) {
  Recording recording;
  for (int i = 0; i < 60; ++i) {
    const double stamp = 100.0 + i - (i < 30 ? 0 : 20);
    const double x = i < 30 ? i : 100;  // odometry begins anew and rests; its stamps pass those of the first stretch
    recording.odometry(stamp, {x, 0, 0});
    recording.scan(stamp, "base");
  }
  const LoadedLog loaded = recording.read().value();
  for (std::size_t i = 30; i < 60; ++i) { expect_near(*loaded.log.scans[i].odom_from_robot, {100, 0, 0}); }
}

TEST(RosLog, PosesThatComeOutOfOrderByLessThanASecondAreSorted) {
  Recording recording;
  for (const double stamp : {1.0, 2.0, 1.5, 2.5}) { recording.odometry(stamp, {stamp, 0, 0}); }
  recording.scan(1.75, "base");
  expect_near(*recording.read()->log.scans[0].odom_from_robot, {1.75, 0, 0});
}

TEST(RosLog, NoOdometryIsMadeUpWhereItIsMissing) {
  Recording recording;
  for (const double stamp : {1.0, 2.0, 32.0, 33.0, 50.0}) {
    recording.odometry(stamp, {std::min(stamp, 33.0), 0, 0});
    recording.scan(stamp, "base");
  }
  for (const double stamp : {2.1, 17.0, 31.9, 40.0}) { recording.scan(stamp, "base"); }
  const LoadedLog loaded = recording.read().value();
  for (std::size_t i = 0; i < 5; ++i) { EXPECT_TRUE(loaded.log.scans[i].odom_from_robot) << i; }
  for (std::size_t i = 5; i < 8; ++i) { EXPECT_FALSE(loaded.log.scans[i].odom_from_robot) << i; }
  expect_near(*loaded.log.scans[8].odom_from_robot, {33, 0, 0});  // stood all the while
}

TEST(RosLog, UpsideDownScannerIsSeenFromAbove) {
  Recording recording;
  const Eigen::Isometry3d upside_down(Eigen::Translation3d(0.2, 0, 0.5) *
                                      Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(half_turn, Eigen::Vector3d::UnitX()));
  recording.transform(0.0, "base", "laser", upside_down);
  recording.scan(1.0);
  const Scan scan = recording.read()->log.scans.at(0);
  // Where beam 0 ends, by the three-dimensional mounting and by the planar one.
  const Eigen::Vector3d in_sensor(1.5 * std::cos(-0.5), 1.5 * std::sin(-0.5), 0.0);
  const Eigen::Vector3d on_robot = upside_down * in_sensor;
  const double angle = scan.beams.angle(0);
  const Point2 found = scan.robot_from_sensor * Point2{1.5 * std::cos(angle), 1.5 * std::sin(angle)};
  EXPECT_NEAR(found.x, on_robot.x(), 1e-6);
  EXPECT_NEAR(found.y, on_robot.y(), 1e-6);
  EXPECT_EQ(scan.beams.angle_step, -0.25);
}

TEST(RosLog, TiltedScannerIsRefused) {
  Recording recording;
  recording.transform(0.0, "base", "laser", Eigen::Isometry3d(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY())));
  recording.scan(1.0);
  EXPECT_THAT(recording.read().error().message, HasSubstr("/scan: expected a level scanner, found one tilted by 29"));
}

TEST(RosLog, BrokenMessagesStopOrAreCounted) {
  Recording recording;
  recording.scan(1.0);
  recording.add("/scan", std::string(ros::laser_scan_type), "short");
  EXPECT_THAT(recording.read().error().message, HasSubstr("run.bag: message 2, /scan: expected a message of type"));
  const LoadedLog loaded = recording.read({.broken_lines = BrokenLines::lenient}).value();
  EXPECT_EQ(loaded.log.scans.size(), 1U);
  EXPECT_THAT(observations(loaded.report), testing::Contains("1 broken message skipped"));
}

TEST(RosLog, WhatIsLeftOfACutFileIsReadWhenLenient) {
  Recording recording;
  for (int i = 0; i < 4; ++i) { recording.scan(i); }
  const TemporaryFolder folder;
  const std::string whole = rosbag1_file(recording.messages, {.packing = Packing::lz4, .finished = false});
  const auto path = folder.file("cut.bag", whole.substr(0, whole.size() - 10));
  EXPECT_FALSE(read_log(path));
  const LoadedLog loaded = read_log(path, {.broken_lines = BrokenLines::lenient}).value();
  EXPECT_EQ(loaded.log.scans.size(), 2U);
  EXPECT_EQ(loaded.report.broken_lines, 1U);
}

TEST(RosLog, McapAndSqliteSayTheSame) {
  const ros::LaserScan scan{.stamp = 3.5,
                            .frame = "laser",
                            .beams = {.angle_min = -1, .angle_step = 0.5, .range_min = 0.1, .range_max = 10},
                            .ranges = {1, 2, 3}};
  const std::vector<BagMessage> messages{
      {"/scan", std::string(ros::laser_scan_type), bag::Serialization::cdr, scan_bytes(scan, bag::Serialization::cdr)}};
  const TemporaryFolder folder;
  const auto mcap = folder.file("run.mcap", mcap_file(messages, {.packing = Packing::zstd}));
  const std::filesystem::path db3 = mcap.parent_path() / "run.db3";
  write_db3(db3, messages);
  write_metadata(mcap.parent_path(), std::vector<std::string>{"run.db3"});
  for (const auto& path : {mcap, db3, mcap.parent_path()}) {
    const auto loaded = read_log(path);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->log.scans.at(0).stamp, 3.5);
    EXPECT_THAT(loaded->log.scans.at(0).ranges, ElementsAre(1, 2, 3));
    EXPECT_EQ(format_of(path).value(), FileFormat::ros);
  }
}

}  // namespace
}  // namespace flirt
