#include "flirt/io/carmen.hpp"

#include "tests/io/carmen_text.hpp"
#include "tests/io/gzip.hpp"
#include "tests/support/numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <ostream>
#include <string>

namespace flirt {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::Pair;
using testing::UnorderedElementsAre;

Beams beams_of(std::size_t n) {
  return read_text(flaser(n)).value().log.scans[0].beams;
}

// --- Angles of lines that do not tell them ---------------------------------------------------------------------------

struct AngleCase {
  std::size_t beams;
  double first;  ///< degrees
  double last;   ///< degrees

  friend void PrintTo(const AngleCase& angles, std::ostream* out) {
    *out << angles.beams << " beams from " << angles.first << " to " << angles.last << " degrees";
  }
};
class FlaserAngles : public testing::TestWithParam<AngleCase> {};

TEST_P(FlaserAngles, FollowTheNumberOfBeams) {
  const AngleCase expected = GetParam();
  const Beams beams = beams_of(expected.beams);
  EXPECT_NEAR(degrees_from_radians(beams.angle(0)), expected.first, 1e-9);
  EXPECT_NEAR(degrees_from_radians(beams.angle(expected.beams - 1)), expected.last, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Counts, FlaserAngles,
                         testing::Values(AngleCase{180, -90, 89}, AngleCase{181, -90, 90}, AngleCase{360, -90, 89.5},
                                         AngleCase{361, -90, 90}, AngleCase{90, -90, 88}, AngleCase{721, -90, 90},
                                         AngleCase{401, -50, 50}, AngleCase{541, -135, 135}, AngleCase{1081, -135, 135},
                                         AngleCase{682, -119.70703125, 119.70703125}, AngleCase{1, 0, 0}));

TEST(Carmen, TakesTheStepRatherThanTheFieldOfViewOfRobotlaser) {
  const Scan scan = read_text(robotlaser()).value().log.scans[0];
  EXPECT_EQ(scan.beams.angle_min, -1.5);
  EXPECT_EQ(scan.beams.angle_step, 0.5);
  EXPECT_THAT(scan.ranges, ElementsAre(1, 2, 3));
}

// --- Readings without return -----------------------------------------------------------------------------------------

TEST(Carmen, UnderstandsEveryWayToWriteNoReturn) {
  const std::string text = "FLASER 10 81.83 81.91 50 51.3 80 0 inf nan 3.5 -1 0 0 0 0 0 0 1 host 1\n";
  const Scan scan = read_text(text).value().log.scans[0];
  for (const std::size_t i : {0U, 1U, 2U, 3U, 4U, 5U, 6U}) {
    EXPECT_EQ(classify(scan.ranges[i], scan.beams), Reading::no_return) << scan.ranges[i];
  }
  EXPECT_EQ(classify(scan.ranges[7], scan.beams), Reading::invalid);
  EXPECT_EQ(classify(scan.ranges[8], scan.beams), Reading::hit);
  EXPECT_EQ(classify(scan.ranges[9], scan.beams), Reading::invalid);
}

/// A log of 60 readings on a slanted wall, with `n` readings of one value in between.
std::string log_with_pile(std::string_view value, std::size_t n) {
  std::string text = "FLASER " + std::to_string(60 + n);
  for (std::size_t i = 0; i < 60; ++i) { text += ' ' + std::to_string(2.0 + 0.37 * static_cast<double>(i)); }
  return text + repeated(value, n) + " 0 0 0 0 0 0 1 host 1\n";
}

TEST(Carmen, DetectsAValueForNoReturnBelowTheLongestRange) {
  const LoadedLog loaded = read_text(log_with_pile("32.77", 40)).value();
  EXPECT_EQ(loaded.log.scans[0].beams.range_max, 32.77);
  EXPECT_EQ(loaded.report.range_max_source, RangeMaxSource::detected);
  EXPECT_THAT(observations(loaded.report), testing::Contains(HasSubstr("pile up")));
}

TEST(Carmen, TakesAFewEqualLongReadingsForAWall) {
  const LoadedLog loaded = read_text(log_with_pile("32.77", 9)).value();
  EXPECT_EQ(loaded.log.scans[0].beams.range_max, 50);
  EXPECT_EQ(loaded.report.range_max_source, RangeMaxSource::assumed);
}

TEST(Carmen, TakesReadingsThatAreAllEqualForARoundRoom) {
  EXPECT_EQ(read_text(flaser(180)).value().log.scans[0].beams.range_max, 50);
}

TEST(Carmen, PrefersTheDeclaredLongestRangeAndTheCallersAboveAll) {
  EXPECT_EQ(read_text(robotlaser()).value().log.scans[0].beams.range_max, 40);
  EXPECT_EQ(read_text(robotlaser("3 1 2 3", "0 0 0 0 0 0", "0 -1 3 1 0")).value().log.scans[0].beams.range_max, 50);
  const std::string by_parameter = "PARAM robot_front_laser_max 80.99 nohost 0\n" + flaser(180);
  EXPECT_EQ(read_text(by_parameter).value().log.scans[0].beams.range_max, 80.99);
  const LoadedLog by_option = read_text(by_parameter, {.range_max = 12.5}).value();
  EXPECT_EQ(by_option.log.scans[0].beams.range_max, 12.5);
  EXPECT_EQ(by_option.report.range_max_source, RangeMaxSource::option);
  EXPECT_THAT(error_of(by_parameter, {.range_max = -1.0}), HasSubstr("expected more than 0 m"));
}

// --- Poses and the laser on the robot --------------------------------------------------------------------------------

TEST(Carmen, ReadsLaserAndRobotOfRobotlaserAsOdometry) {
  const LoadedLog loaded = read_text(robotlaser("3 1 2 3", "1 2.78 1.5707963267948966 1 2 1.5707963267948966")).value();
  expect_pose(loaded.log.scans[0].robot_from_sensor, {0.78, 0, 0});
  expect_pose(loaded.log.map_from_robot[0], {1, 2, pi / 2});
  expect_pose(*loaded.log.scans[0].odom_from_robot, {1, 2, pi / 2});
  EXPECT_EQ(loaded.report.poses, PoseSource::odometry);
}

TEST(Carmen, TakesPosesBesideVertexLinesForCorrectedAndNotForOdometry) {
  const LoadedLog loaded = read_text("VERTEX2 0 1 2 0\n" + robotlaser() + "EDGE2 0 1 1 0 0 1 0 1 1 0 0\n").value();
  expect_pose(loaded.log.map_from_robot[0], {1, 2, 0});
  EXPECT_FALSE(loaded.log.scans[0].odom_from_robot.has_value());
  EXPECT_EQ(loaded.report.poses, PoseSource::corrected);
  EXPECT_THAT(loaded.report.lines_skipped, UnorderedElementsAre(Pair("EDGE2", 1), Pair("VERTEX2", 1)));
}

TEST(Carmen, KeepsTheLaserInPlaceUnderRoundedPoses) {
  std::string text;
  for (int i = 0; i < 50; ++i) {
    const Pose2 robot{0.1234567 * i, 0.7654321 * i, wrap_angle(0.31 * i)};
    const Pose2 laser = robot * Pose2{-0.04, 0, 0};
    std::array<char, 200> poses{};
    std::snprintf(poses.data(), poses.size(), "%f %f %f %f %f %f", laser.x, laser.y, laser.theta, robot.x, robot.y,
                  robot.theta);
    text += robotlaser("3 1 2 3", poses.data());
  }
  const ScanLog log = read_text(text).value().log;
  for (const Scan& scan : log.scans) { EXPECT_EQ(scan.robot_from_sensor, log.scans[0].robot_from_sensor); }
  EXPECT_NEAR(log.scans[0].robot_from_sensor.x, -0.04, 1e-5);
}

TEST(Carmen, PutsALaserAtTheRobotsPoseExactlyThere) {
  const std::string pose = "576.536523 0.106594 -2.255213";
  EXPECT_EQ(read_text(robotlaser("3 1 2 3", pose + ' ' + pose)).value().log.scans[0].robot_from_sensor, Pose2{});
}

TEST(Carmen, TakesTheFirstPoseOfFlaserForTheLasers) {
  const LoadedLog loaded =
      read_text("PARAM robot_frontlaser_offset -0.04 nohost 0\n" + flaser(180, "1 2 0 5 6 0.1")).value();
  expect_pose(loaded.log.scans[0].robot_from_sensor, {-0.04, 0, 0});
  expect_pose(loaded.log.map_from_robot[0], {1.04, 2, 0});
  expect_pose(loaded.log.map_from_sensor(0), {1, 2, 0});
  expect_pose(*loaded.log.scans[0].odom_from_robot, {5, 6, 0.1});
  EXPECT_EQ(loaded.report.poses, PoseSource::corrected_and_odometry);
}

TEST(Carmen, TurnsTheRearLaserBackwards) {
  std::string text = flaser(180, "1 2 0 5 6 0.1");
  text.front() = 'R';  // RLASER has the layout of FLASER
  const LoadedLog loaded = read_text("PARAM robot_rearlaser_offset -0.3 nohost 0\n" + text).value();
  expect_pose(loaded.log.scans[0].robot_from_sensor, {-0.3, 0, pi});
  expect_pose(loaded.log.map_from_robot[0] * loaded.log.scans[0].robot_from_sensor, {1, 2, 0});
}

TEST(Carmen, LeavesOutOdometryThatRepeatsCorrectedPoses) {
  const LoadedLog loaded = read_text(flaser(180) + "NEFF 30\n").value();
  EXPECT_FALSE(loaded.log.scans[0].odom_from_robot.has_value());
  EXPECT_TRUE(loaded.report.odometry_repeats_pose);
  EXPECT_EQ(loaded.report.poses, PoseSource::corrected);
  EXPECT_THAT(observations(loaded.report), testing::Contains(HasSubstr("there is no odometry")));
}

TEST(Carmen, TakesEqualPosesOfARawLogForOdometry) {
  const LoadedLog loaded = read_text(flaser(180)).value();
  expect_pose(*loaded.log.scans[0].odom_from_robot, {1, 2, 0.5});
  EXPECT_FALSE(loaded.report.odometry_repeats_pose);
  EXPECT_EQ(loaded.report.poses, PoseSource::odometry);
}

TEST(Carmen, FindsTheLaserFromAConstantMotionBetweenBothPoses) {
  std::string text;
  for (int i = 0; i < 30; ++i) {
    const Pose2 robot{0.1 * i, 0, 0.05 * i};
    const Pose2 laser = robot * Pose2{0.2, 0, 0};
    text +=
        flaser(180, std::to_string(laser.x) + ' ' + std::to_string(laser.y) + ' ' + std::to_string(laser.theta) + ' ' +
                        std::to_string(robot.x) + ' ' + std::to_string(robot.y) + ' ' + std::to_string(robot.theta));
  }
  const LoadedLog loaded = read_text(text).value();
  EXPECT_EQ(loaded.report.poses, PoseSource::odometry);
  EXPECT_NEAR(loaded.log.scans[9].robot_from_sensor.x, 0.2, 1e-5);
  expect_pose(loaded.log.map_from_robot[29], *loaded.log.scans[29].odom_from_robot);
}

TEST(Carmen, TakesPosesOneConstantMotionApartForCorrectedWhenTheLogIs) {
  std::string text("NEFF 30\n");
  for (int i = 0; i < 30; ++i) {
    const std::string y = std::to_string(0.1 * i);
    text += flaser(180, "0.2 " + y + " 0 0 " + y + " 0");
  }
  const LoadedLog loaded = read_text(text).value();
  EXPECT_EQ(loaded.report.poses, PoseSource::corrected);
  EXPECT_TRUE(loaded.report.odometry_repeats_pose);
  EXPECT_NEAR(loaded.log.scans[9].robot_from_sensor.x, 0.2, 1e-5);
  EXPECT_NEAR(loaded.log.map_from_robot[9].y, 0.9, 1e-9);
  for (const Scan& scan : loaded.log.scans) { EXPECT_FALSE(scan.odom_from_robot); }
}

TEST(Carmen, GivesRawlaserTheOdometryOfItsStampOrTheLastBefore) {
  const std::string text = rawlaser("1") +  // none yet
                           "ODOM 1 0 0 0 0 0 2.0 host 0\n" + rawlaser("2.5") + rawlaser("3.0") +
                           "ODOM 3 0 0 0 0 0 3.0 host 0\n" + rawlaser("4.0");
  const LoadedLog loaded = read_text(text).value();
  EXPECT_FALSE(loaded.log.scans[0].odom_from_robot.has_value());
  EXPECT_EQ(loaded.log.scans[1].odom_from_robot->x, 1);
  EXPECT_EQ(loaded.log.scans[2].odom_from_robot->x, 3);
  EXPECT_EQ(loaded.log.scans[3].odom_from_robot->x, 3);
  EXPECT_TRUE(loaded.log.map_from_robot.empty());
  EXPECT_THAT(loaded.report.lines_used, UnorderedElementsAre(Pair("ODOM", 2), Pair("RAWLASER1", 4)));
}

TEST(Carmen, ReadsRawlaserWithoutAnyOdometry) {
  const LoadedLog loaded = read_text(rawlaser()).value();
  EXPECT_EQ(loaded.report.poses, PoseSource::none);
  EXPECT_TRUE(loaded.log.map_from_robot.empty());
}

TEST(Carmen, ReadsTruePosesBesideOdometry) {
  const LoadedLog loaded = read_text("TRUEPOS 9 8 0.5 1 2 0 7.25 host 0\n" + robotlaser()).value();
  expect_pose(loaded.log.map_from_robot[0], {9, 8, 0.5});
  expect_pose(*loaded.log.scans[0].odom_from_robot, {1, 2, 0});
  EXPECT_EQ(loaded.report.poses, PoseSource::corrected_and_odometry);
}

TEST(Carmen, KeepsCoordinatesFarFromTheOrigin) {
  const LoadedLog loaded = read_text(flaser(361, "576.536523 0.106594 -2.255213 576.5 0.1 -2.2")).value();
  EXPECT_EQ(loaded.log.map_from_robot[0].x, 576.536523);
}

// --- Stamps ----------------------------------------------------------------------------------------------------------

TEST(Carmen, KeepsTheOrderOfTheFileWhenStampsRunBackwards) {
  const LoadedLog loaded = read_text(flaser(1, "0 0 0 0 0 0", "5.125") + flaser(1, "1 0 0 1 0 0", "4.1234567") +
                                     flaser(1, "2 0 0 2 0 0", "6"))
                               .value();
  EXPECT_EQ(loaded.log.scans[1].stamp, 4.1234567);
  EXPECT_EQ(loaded.log.map_from_robot[2].x, 2);
  EXPECT_EQ(loaded.report.stamps_backwards, 1U);
  EXPECT_EQ(loaded.report.stamp_digits, 8);
  EXPECT_THAT(observations(loaded.report), testing::Contains(HasSubstr("backwards 1 time:")));
}

TEST(Carmen, NotesConstantAndRoundedStamps) {
  const LoadedLog loaded =
      read_text(flaser(1, "0 0 0 0 0 0", "1.07108e+09") + flaser(1, "1 0 0 1 0 0", "1.07108e+09")).value();
  EXPECT_TRUE(loaded.report.stamps_constant);
  EXPECT_EQ(loaded.report.stamp_digits, 6);
  EXPECT_THAT(observations(loaded.report), testing::Contains(HasSubstr("written with 6 digits at most")));
  EXPECT_FALSE(read_text(flaser(1)).value().report.stamps_constant);
}

TEST(Carmen, TakesShortStampsForRoundedOnlyWhereDigitsWentMissing) {
  const auto note = HasSubstr("they are rounded");
  const auto read = [](std::string_view first, std::string_view second) {
    return observations(read_text(flaser(1, "0 0 0 0 0 0", first) + flaser(1, "1 0 0 1 0 0", second)).value().report);
  };
  EXPECT_THAT(read("667.5", "667.6"), Not(Contains(note)));
  EXPECT_THAT(read("0", "1"), Not(Contains(note)));
  EXPECT_THAT(read("9999.95", "9999.99"), Not(Contains(note)));
  EXPECT_THAT(read("1071078718.46", "1071078718.96"), Not(Contains(note)));
  EXPECT_THAT(read("1.07108e+09", "1.07109e+09"), Contains(note));
  EXPECT_THAT(read("99999.9", "100000"), Contains(note));
  EXPECT_THAT(read("123456", "123457"), Contains(note));
}

// --- Lines of other kinds --------------------------------------------------------------------------------------------

TEST(Carmen, SkipsAndCountsWhatItDoesNotUse) {
  const std::string text =
      "# message formats defined: PARAM SYNC ODOM FLASER RLASER\n# FLASER num_readings [range_readings] x y\n\n"
      "PARAM robot_width 0.41 nohost 0\nSYNC go\n" +
      flaser(180) +
      "ODOM 0 0 0 0 0 0 1 host 1\nNEFF 30\n\x01\x02 binary\n"
      "FROBNICATE 1 2 3\n" +
      flaser(180);
  const LoadedLog loaded = read_text(text).value();
  EXPECT_EQ(loaded.log.scans.size(), 2U);
  EXPECT_THAT(loaded.report.lines_used, UnorderedElementsAre(Pair("FLASER", 2)));
  EXPECT_THAT(loaded.report.lines_skipped,
              UnorderedElementsAre(Pair("#", 2), Pair("PARAM", 1), Pair("SYNC", 1), Pair("ODOM", 1), Pair("NEFF", 1),
                                   Pair("FROBNICATE", 1), Pair("(unreadable)", 1)));
  EXPECT_EQ(loaded.report.lines, 11U);
}

TEST(Carmen, ReadsTheSameFromAnyLineEndAndFromGzip) {
  const std::string text = "# comment\n" + flaser(180) + flaser(180);
  std::string with_returns;
  for (const char c : text) { with_returns += c == '\n' ? std::string("\r\n") : std::string(1, c); }
  const auto expected = read_text(text).value();
  for (const std::string& other : {with_returns, gzipped(text)}) {
    const LoadedLog loaded = read_text(other).value();
    ASSERT_EQ(loaded.log.scans.size(), 2U);
    EXPECT_EQ(loaded.log.scans[1].ranges, expected.log.scans[1].ranges);
    EXPECT_EQ(loaded.log.scans[1].stamp, expected.log.scans[1].stamp);
  }
  EXPECT_TRUE(read_text(gzipped(text)).value().report.is_gzip);
}

TEST(Carmen, ReadsTheFirstKindOfScanLinesUnlessToldOtherwise) {
  const std::string text = rawlaser("1") + flaser(180) + rawlaser("2") + flaser(180) + flaser(180);
  EXPECT_EQ(read_text(text).value().log.scans.size(), 2U);
  const LoadedLog loaded = read_text(text, {.message = "FLASER"}).value();
  EXPECT_EQ(loaded.log.scans.size(), 3U);
  EXPECT_EQ(loaded.report.message, "FLASER");
  EXPECT_THAT(loaded.report.lines_skipped, UnorderedElementsAre(Pair("RAWLASER1", 2)));
  EXPECT_THAT(error_of(text, {.message = "RAWLASER2"}),
              HasSubstr("expected RAWLASER2 lines, found none; the log holds FLASER (3), RAWLASER1 (2)"));
}

}  // namespace
}  // namespace flirt
