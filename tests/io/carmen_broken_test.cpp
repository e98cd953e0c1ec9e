#include "flirt/core/rng.hpp"

#include "tests/io/carmen_text.hpp"
#include "tests/io/gzip.hpp"
#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>

namespace flirt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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
  EXPECT_THAT(error_of(robotlaser("3 1 2 3", "0 0 0 0 0 0", "0 -1 3 0 40")),
              HasSubstr("expected angles within one turn, found 3 beams in steps of 0 rad from -1"));
  EXPECT_TRUE(read_text(robotlaser("1 2", "0 0 0 0 0 0", "0 0 0 0 40")));
}

TEST(Carmen, RefusesAnglesBeyondOneTurn) {
  const auto of_head = [](std::string_view head) { return robotlaser("3 1 2 3", "0 0 0 0 0 0", head); };
  EXPECT_TRUE(read_text(of_head("0 -3.14159 6.2832 2.0944 40")));   // a whole turn
  EXPECT_TRUE(read_text(of_head("0 -3.14159 6.2832 3.14159 40")));  // with the first beam given twice
  EXPECT_TRUE(read_text(of_head("0 3.14159 6.2832 -2.0944 40")));
  for (const std::string_view head : {"0 -1.5 3.0 1e308 40", "0 -1.5 3.0 -1e308 40", "0 -1.5 3.0 45 40",
                                      "0 -1.5 3.0 4.3 40", "0 -90 180 1 40", "0 1e300 3.0 0.5 40"}) {
    const std::string text = of_head("0 -1.5 3.0 0.5 40") + of_head(head);
    EXPECT_THAT(error_of(text), HasSubstr("test.log:2: ROBOTLASER1: expected angles within one turn, found 3 beams"));
    const LoadedLog loaded = read_text(text, lenient).value();
    EXPECT_EQ(loaded.log.scans.size(), 1U);
    EXPECT_EQ(loaded.report.broken_lines, 1U);
  }
}

TEST(Carmen, RefusesPlacesThatNoMapCanHold) {
  EXPECT_TRUE(read_text(flaser(3, "0 9999999 0 0 0 0")));
  EXPECT_THAT(error_of(flaser(3, "1e7 1e7 0 0 0 0")),
              HasSubstr("test.log:1: FLASER: expected a place within 10 000 km for the pose, found '1e7 1e7 0"));
  EXPECT_THAT(error_of(flaser(3, "0 0 0 0 -1e300 0")), HasSubstr("within 10 000 km for the odometry"));
  EXPECT_THAT(error_of(robotlaser("3 1 2 3", "2000 2 0 1 2 0")), HasSubstr("the laser within 1 km of the robot"));
  EXPECT_THAT(error_of("PARAM robot_frontlaser_offset 1e300 nohost 0\n" + flaser(3)),
              HasSubstr("expected a number within 1000 for robot_frontlaser_offset, found '1e300'"));
}

TEST(Carmen, RefusesScansOfMoreBeamsThanAnyScannerHas) {
  EXPECT_EQ(read_text(flaser(20000)).value().log.scans[0].ranges.size(), 20000U);
  EXPECT_THAT(error_of(flaser(20001)), HasSubstr("test.log:1: FLASER: expected up to 20000 ranges, found 20001"));
}

TEST(Carmen, TakesAnInfiniteLongestRangeForNone) {
  const LoadedLog loaded = read_text(robotlaser("3 1 2 3", "0 0 0 0 0 0", "0 -1.5 3.0 0.5 inf")).value();
  EXPECT_EQ(loaded.log.scans[0].beams.range_max, 50);
  EXPECT_EQ(loaded.report.range_max_source, RangeMaxSource::assumed);
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
  EXPECT_THAT(error_of(""), HasSubstr("test.log: expected a CARMEN log or a recording of ROS (.bag, .mcap, .db3 or the "
                                      "folder of one), found an empty file"));
  EXPECT_THAT(error_of("hello\nworld\n"), HasSubstr("found none, beginning with 'hello'"));
  EXPECT_THAT(error_of("# FLASER is only named here\n"), HasSubstr("expected a CARMEN log or"));
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

}  // namespace
}  // namespace flirt
