#include "flirt/io/log_summary.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace flirt {
namespace {

TEST(LogSummary, CountsReadingsAndOrdersThem) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ScanLog log;
  log.scans.push_back({.beams = {0, 0.1, 0, 50}, .ranges = {3, 1, 81.83, 2, nan, 0}});
  log.scans.push_back({.beams = {0, 0.1, 0, 50}, .ranges = {4, 5, -1}});
  const LogSummary summary = summarize(log);
  EXPECT_EQ(summary.scans, 2U);
  EXPECT_EQ(summary.fewest_beams, 3U);
  EXPECT_EQ(summary.most_beams, 6U);
  EXPECT_EQ(summary.ranges.hits, 5U);
  EXPECT_EQ(summary.ranges.no_returns, 2U);
  EXPECT_EQ(summary.ranges.invalid, 2U);
  EXPECT_EQ(summary.ranges.shortest, 1);
  EXPECT_EQ(summary.ranges.median, 3);
  EXPECT_EQ(summary.ranges.percentile_95, 5);
  EXPECT_EQ(summary.ranges.longest, 5);
}

TEST(LogSummary, MeasuresStampsThatRunBackwards) {
  ScanLog log;
  for (const double stamp : {10.0, 11.0, 9.5, 10.5, 12.0}) { log.scans.push_back({.stamp = stamp}); }
  const StampSummary stamps = summarize(log).stamps;
  EXPECT_EQ(stamps.first, 10);
  EXPECT_EQ(stamps.last, 12);
  EXPECT_EQ(stamps.duration, 2.5);
  EXPECT_EQ(stamps.median_interval, 1);
}

TEST(LogSummary, MeasuresBothPaths) {
  ScanLog log;
  log.map_from_robot = {{0, 0, 0}, {3, 4, 1}, {3, -2, 1}};
  log.scans.resize(3);
  log.scans[1].odom_from_robot = Pose2{1, 0, 0};
  log.scans[2].odom_from_robot = Pose2{1, 2, 0};
  const LogSummary summary = summarize(log);
  EXPECT_EQ(summary.map.poses, 3U);
  EXPECT_EQ(summary.map.length, 11);
  EXPECT_EQ(summary.map.low, (Point2{0, -2}));
  EXPECT_EQ(summary.map.high, (Point2{3, 4}));
  EXPECT_EQ(summary.odometry.poses, 2U);
  EXPECT_EQ(summary.odometry.length, 2);
}

TEST(LogSummary, OfNothingIsZero) {
  const LogSummary summary = summarize({});
  EXPECT_EQ(summary.scans, 0U);
  EXPECT_EQ(summary.ranges.longest, 0);
  EXPECT_EQ(summary.map.poses, 0U);
}

}  // namespace
}  // namespace flirt
