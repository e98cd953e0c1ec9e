#include "flirt/io/carmen.hpp"

#include "flirt/core/rng.hpp"

#include "tests/io/gzip.hpp"
#include "tests/support/numbers.hpp"
#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <string>

namespace flirt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::Pair;
using testing::UnorderedElementsAre;

constexpr ReadOptions lenient{.broken_lines = BrokenLines::lenient};

Result<LoadedLog> read_text(std::string_view text, const ReadOptions& options = {}) {
  const TemporaryFolder folder;
  return read_log(folder.file("test.log", text), options);
}

std::string error_of(std::string_view text, const ReadOptions& options = {}) {
  const auto loaded = read_text(text, options);
  return loaded ? "no error" : loaded.error().message;
}

std::string repeated(std::string_view word, std::size_t n) {
  std::string text;
  for (std::size_t i = 0; i < n; ++i) { text.append(" ").append(word); }
  return text;
}

/// A FLASER line of n equal ranges.
std::string flaser(std::size_t n, std::string_view poses = "1 2 0.5 1 2 0.5", std::string_view stamp = "7.25",
                   std::string_view range = "1.5") {
  return "FLASER " + std::to_string(n) + repeated(range, n) + ' ' + std::string(poses) + ' ' + std::string(stamp) +
         " host 0.5\n";
}

std::string robotlaser(std::string_view ranges = "3 1 2 3", std::string_view poses = "1.5 2 0 1 2 0",
                       std::string_view head = "0 -1.5 3.0 0.5 40") {
  return "ROBOTLASER1 " + std::string(head) + " 0.1 0 " + std::string(ranges) + " 0 " + std::string(poses) +
         " 0 0 0 0 0 7.25 host 0.5\n";
}

std::string rawlaser(std::string_view stamp = "7.25", std::string_view kind = "RAWLASER1") {
  return std::string(kind) + " 0 -1.5 3.0 0.5 40 0.1 0 3 1 2 3 0 " + std::string(stamp) + " host 0.5\n";
}

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

void expect_pose(const Pose2& found, const Pose2& expected) {
  EXPECT_NEAR(found.x, expected.x, 1e-9);
  EXPECT_NEAR(found.y, expected.y, 1e-9);
  EXPECT_NEAR(heading_difference(found, expected), 0, 1e-9);
}

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
  EXPECT_FALSE(read_text(flaser(1)).value().report.stamps_constant);
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

// --- Broken lines ----------------------------------------------------------------------------------------------------

struct BrokenCase {
  std::string line;
  std::string complaint;

  friend void PrintTo(const BrokenCase& broken, std::ostream* out) { *out << broken.complaint; }
};
class BrokenCarmenLine : public testing::TestWithParam<BrokenCase> {};

TEST_P(BrokenCarmenLine, IsAnErrorWithItsPlaceAndSkippedWhenLenient) {
  const auto& [line, complaint] = GetParam();
  const std::string text = "# first\n" + flaser(3) + line + "\n" + flaser(3);
  EXPECT_THAT(error_of(text), HasSubstr("test.log:3: FLASER: expected " + complaint));
  const LoadedLog loaded = read_text(text, lenient).value();
  EXPECT_EQ(loaded.log.scans.size(), 2U);
  EXPECT_EQ(loaded.report.broken_lines, 1U);
  EXPECT_THAT(loaded.report.broken_messages, ElementsAre(HasSubstr("test.log:3:")));
  EXPECT_THAT(observations(loaded.report), testing::Contains("1 broken line skipped"));
}

INSTANTIATE_TEST_SUITE_P(
    Lines, BrokenCarmenLine,
    testing::Values(BrokenCase{"FLASER", "a count for ranges, found the end of the line"},
                    BrokenCase{"FLASER -3 1 1 1 0 0 0 0 0 0 1 h 1", "a count for ranges, found '-3'"},
                    BrokenCase{"FLASER x 1 1 1 0 0 0 0 0 0 1 h 1", "a count for ranges, found 'x'"},
                    BrokenCase{"FLASER 3.5 1 1 1 0 0 0 0 0 0 1 h 1", "a count for ranges, found '3.5'"},
                    BrokenCase{"FLASER 18446744073709551615 1 1", "18446744073709551615 ranges, found at most 2"},
                    BrokenCase{"FLASER 99999999999999999999999 1 1", "a count for ranges"},
                    BrokenCase{"FLASER 14 1 1 1 0 0 0 0 0 0 1 h 1", "14 ranges, found at most 12 fields"},
                    BrokenCase{"FLASER 4 1 1 1 0 0 0 0 0 0 1 h 1", "a finite number for the stamp, found 'h'"},
                    BrokenCase{"FLASER 2 1 1 1 0 0 0 0 0 0 1 h 1", "a number for the logger stamp, found 'h'"},
                    BrokenCase{"FLASER 3 1 one 1 0 0 0 0 0 0 1 h 1", "a number for a range, found 'one'"},
                    BrokenCase{"FLASER 3 1 1,5 1 0 0 0 0 0 0 1 h 1", "a number for a range, found '1,5'"},
                    BrokenCase{"FLASER 3 1 1 1 nan 0 0 0 0 0 1 h 1", "a finite number for the pose, found 'nan'"},
                    BrokenCase{"FLASER 3 1 1 1 0 0 0 0 inf 0 1 h 1", "a finite number for the odometry, found 'inf'"},
                    BrokenCase{"FLASER 3 1 1 1 0 0 0 0 0 0 nan h 1", "a finite number for the stamp, found 'nan'"},
                    BrokenCase{"FLASER 3 1 1 1 0 0 0 0 0 0 1 h 1 9",
                               "the end of the line after the logger stamp, found '9'"},
                    BrokenCase{"FLASER 3 1 1 1 0 0 0 0 0 0 1", "a word for the host, found the end of the line"}));

TEST(Carmen, FindsAnImpossibleStepOfRobotlaser) {
  EXPECT_THAT(error_of(robotlaser("3 1 2 3", "0 0 0 0 0 0", "0 -1 3 0 40")), HasSubstr("an angular step other than 0"));
  EXPECT_TRUE(read_text(robotlaser("1 2", "0 0 0 0 0 0", "0 0 0 0 40")));
}

TEST(Carmen, ReadsRemissionsAndSkipsThem) {
  std::string line = robotlaser();
  line.replace(line.find(" 0 1.5 2 0"), 2, " 3 0.5 0.25 0.125");
  expect_pose(read_text(line).value().log.map_from_robot[0], {1, 2, 0});
}

TEST(Carmen, ReportsALastLineThatIsCutShort) {
  std::string text = flaser(180) + flaser(180);
  text.resize(text.size() - 300);
  EXPECT_THAT(error_of(text), HasSubstr("test.log:2: FLASER: "));
  EXPECT_THAT(error_of(text), HasSubstr("(the last line, which has no end)"));
  const LoadedLog loaded = read_text(text, lenient).value();
  EXPECT_EQ(loaded.log.scans.size(), 1U);
  EXPECT_EQ(loaded.report.broken_lines, 1U);
}

TEST(Carmen, ReadsGzipThatIsCutShortOnlyWhenLenient) {
  std::string text;
  for (int i = 0; i < 2000; ++i) { text += flaser(20, std::to_string(i * 7919 % 1000) + " 0 0 0 0 0"); }
  std::string zipped = gzipped(text);
  zipped.resize(zipped.size() / 2);
  EXPECT_THAT(error_of(zipped), HasSubstr("gzip data that is cut short"));
  const LoadedLog loaded = read_text(zipped, lenient).value();
  EXPECT_GT(loaded.log.scans.size(), 500U);
  EXPECT_EQ(loaded.report.broken_lines, 1U);
}

TEST(Carmen, ReadsScansOfAnySize) {
  EXPECT_TRUE(read_text(flaser(0)).value().log.scans[0].ranges.empty());
  EXPECT_EQ(read_text(flaser(1)).value().log.scans[0].ranges.size(), 1U);
  const std::string wide = flaser(8000, "1 2 0.5 1 2 0.5", "1", "12.345");
  ASSERT_GT(wide.size(), 50'000U);
  EXPECT_EQ(read_text(wide).value().log.scans[0].ranges.size(), 8000U);
}

TEST(Carmen, RefusesWhatIsNoLog) {
  EXPECT_THAT(error_of(""), HasSubstr("test.log: expected lines of a CARMEN log, found an empty file"));
  EXPECT_THAT(error_of("hello\nworld\n"), HasSubstr("found none, beginning with 'hello'"));
  EXPECT_THAT(error_of("# FLASER is only named here\n"), HasSubstr("expected lines of a CARMEN log"));
  EXPECT_THAT(error_of("ODOM 0 0 0 0 0 0 1 host 1\n"),
              HasSubstr("expected scan lines (FLASER, ROBOTLASER1, RAWLASER1), found none; the log holds ODOM (1)"));
  const TemporaryFolder folder;
  EXPECT_THAT(read_log(folder.path()).error().message, HasSubstr("found a folder"));
  EXPECT_THAT(read_log(folder.path() / "none").error().message, HasSubstr("found nothing"));
}

TEST(Carmen, KeepsOnlyTheFirstMessagesOfManyBrokenLines) {
  std::string text = flaser(3);
  for (int i = 0; i < 100; ++i) { text += "FLASER x\n"; }
  const LogReport report = read_text(text, lenient).value().report;
  EXPECT_EQ(report.broken_lines, 100U);
  EXPECT_EQ(report.broken_messages.size(), 5U);
}

TEST(Carmen, SurvivesDamageOfAnyKind) {
  const std::string good = "PARAM robot_frontlaser_offset 0.1 nohost 0\nODOM 1 2 3 0 0 0 1.5 host 1\n" + flaser(8) +
                           robotlaser() + rawlaser() + "TRUEPOS 9 8 0.5 1 2 0 7.25 host 0\nNEFF 3\n" + flaser(20);
  const TemporaryFolder folder;
  Rng rng(20260101);
  std::size_t readable = 0;
  for (int round = 0; round < 1000; ++round) {
    std::string text = round % 8 == 0 ? gzipped(good) : good;
    for (std::uint32_t k = 0; k < 1 + rng.below(6); ++k) {
      const std::size_t place = rng.below(static_cast<std::uint32_t>(text.size()));
      switch (rng.below(4)) {
        case 0:
          text[place] = static_cast<char>(rng.below(256));
          break;
        case 1:
          text.erase(place, 1 + rng.below(20));
          break;
        case 2:
          text.insert(place, 1 + rng.below(3), "0123456789-.e \n"[rng.below(15)]);
          break;
        default:
          text.resize(1 + place);
          break;
      }
      if (text.empty()) { text = "x"; }
    }
    const auto path = folder.file("test.log", text);
    const auto loaded = read_log(path, lenient);
    readable += loaded.has_value() ? 1U : 0U;
    if (const auto strict = read_log(path)) {
      EXPECT_TRUE(loaded.has_value());
      EXPECT_EQ(strict->log.scans.size(), loaded->log.scans.size());
    }
  }
  EXPECT_GT(readable, 500U);
}

// --- Writing ---------------------------------------------------------------------------------------------------------

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
