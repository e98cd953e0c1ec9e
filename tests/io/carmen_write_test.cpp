#include "flirt/core/rng.hpp"

#include "tests/io/carmen_text.hpp"
#include "tests/support/numbers.hpp"
#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace flirt {
namespace {

using testing::HasSubstr;
using testing::Not;

ScanLog random_log(bool has_odometry, bool has_poses) {
  Rng rng(5);
  ScanLog log;
  for (int i = 0; i < 20; ++i) {
    Scan scan{.stamp = 1134864629.895182 + 0.1 * i, .beams = {-2.1, 0.0061359, 0, 30.5}};
    for (int k = 0; k < 50; ++k) { scan.ranges.push_back(rng.uniform(0, 30)); }
    scan.ranges[3] = infinity;
    scan.ranges[4] = 0;
    scan.robot_from_sensor = {0.78, 0, 0};
    const Pose2 pose{576.5 + 0.1 * i, rng.normal(), wrap_angle(0.7 * i)};
    if (has_odometry) { scan.odom_from_robot = pose; }
    if (has_poses) { log.map_from_robot.push_back(Pose2{1, 2, 0.3} * pose); }
    log.scans.push_back(scan);
  }
  return log;
}

void expect_same(const ScanLog& found, const ScanLog& expected) {
  ASSERT_EQ(found.scans.size(), expected.scans.size());
  ASSERT_EQ(found.map_from_robot.size(), expected.map_from_robot.size());
  for (std::size_t i = 0; i < found.scans.size(); ++i) {
    EXPECT_EQ(found.scans[i].stamp, expected.scans[i].stamp);
    EXPECT_EQ(found.scans[i].beams, expected.scans[i].beams);
    EXPECT_EQ(found.scans[i].ranges, expected.scans[i].ranges);
    expect_pose(found.scans[i].robot_from_sensor, expected.scans[i].robot_from_sensor);
    EXPECT_EQ(found.scans[i].odom_from_robot, expected.scans[i].odom_from_robot);
    if (!expected.map_from_robot.empty()) { EXPECT_EQ(found.map_from_robot[i], expected.map_from_robot[i]); }
  }
}

TEST(CarmenWriter, KeepsOdometryAndOtherPosesApart) {
  const ScanLog log = random_log(true, true);
  const LoadedLog loaded = read_text(to_carmen(log).value()).value();
  expect_same(loaded.log, log);
  EXPECT_EQ(loaded.report.poses, PoseSource::corrected_and_odometry);
}

TEST(CarmenWriter, KeepsCorrectedPosesWithoutOdometry) {
  const ScanLog log = random_log(false, true);
  const LoadedLog loaded = read_text(to_carmen(log).value()).value();
  expect_same(loaded.log, log);
  EXPECT_EQ(loaded.report.poses, PoseSource::corrected);
}

TEST(CarmenWriter, ReadsBackOdometryAsThePosesOfTheLogWhenItHasNoOthers) {
  ScanLog log = random_log(true, false);
  const ScanLog found = read_text(to_carmen(log).value()).value().log;
  for (const Scan& scan : log.scans) { log.map_from_robot.push_back(*scan.odom_from_robot); }
  expect_same(found, log);
  EXPECT_THAT(to_carmen(log).value(), Not(HasSubstr("TRUEPOS")));
}

TEST(CarmenWriter, WritesScansWithoutPosesAsRawlaser) {
  ScanLog log = random_log(false, false);
  const std::string text = to_carmen(log).value();
  EXPECT_THAT(text, HasSubstr("\nRAWLASER1 "));
  expect_same(read_text(text).value().log, log);
  log.scans[3].robot_from_sensor.y = 0.2;
  EXPECT_THAT(to_carmen(log).error().message, HasSubstr("expected a laser straight ahead"));
}

TEST(CarmenWriter, LeavesOutOdometryThatOnlySomeScansHave) {
  for (const bool has_poses : {true, false}) {
    ScanLog log = random_log(true, has_poses);
    for (std::size_t i = 5; i < 9; ++i) { log.scans[i].odom_from_robot.reset(); }
    const LoadedLog loaded = read_text(to_carmen(log).value()).value();
    for (Scan& scan : log.scans) { scan.odom_from_robot.reset(); }
    expect_same(loaded.log, log);
    EXPECT_EQ(loaded.report.poses, has_poses ? PoseSource::corrected : PoseSource::none);
  }
}

TEST(CarmenWriter, KeepsClockwiseBeams) {
  ScanLog log = random_log(true, true);
  for (Scan& scan : log.scans) { scan.beams = {3.1, -0.1, 0, 12}; }
  for (Scan& scan : log.scans) { scan.ranges.resize(30); }
  expect_same(read_text(to_carmen(log).value()).value().log, log);
}

TEST(CarmenWriter, WritesAFile) {
  const TemporaryFolder folder;
  const ScanLog log = random_log(true, true);
  ASSERT_TRUE(write_carmen(folder.path() / "a.log", log));
  expect_same(read_log(folder.path() / "a.log").value().log, log);
  EXPECT_FALSE(write_carmen(folder.path() / "none" / "a.log", log));
}

}  // namespace
}  // namespace flirt
