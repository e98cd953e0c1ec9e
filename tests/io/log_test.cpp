// Real logs: the counts in the description of the data, and what the reader decides about them.
#include "flirt/io/log.hpp"

#include "flirt/core/fields.hpp"
#include "flirt/io/carmen.hpp"

#include "tests/support/data.hpp"
#include "tests/support/temporary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <vector>

namespace flirt {
namespace {

struct RealLog {
  std::string_view file;
  std::size_t scans;
  std::size_t beams;
  double step;      ///< degrees
  double path;      ///< m, of the poses that the log states
  double duration;  ///< s
  PoseSource poses;
  double laser_ahead;  ///< m
  double range_max;    ///< m
  std::size_t stamps_backwards;

  friend void PrintTo(const RealLog& log, std::ostream* out) { *out << log.file; }
};

constexpr auto corrected = PoseSource::corrected;
constexpr auto odometry = PoseSource::odometry;
constexpr auto both = PoseSource::corrected_and_odometry;

const std::vector<RealLog>& real_logs() {
  static const std::vector<RealLog> logs{
      {"fr079/flirtlib-fr079.log.gz", 1464, 360, 0.5, 391, 1054, corrected, -0.04, 50, 0},
      {"fr079/freiburg-079-corrected.log.gz", 4791, 360, 0.5, 423, 1061, corrected, -0.04, 80.99, 0},
      {"intel/flirtlib-intel-lab.log.gz", 2672, 180, 1, 361, 1984, corrected, 0, 50, 97},
      {"intel/intel-corrected.log.gz", 910, 180, 1, 500, 2651, corrected, 0, 50, 4},
      {"mit-csail/flirtlib-mit-cscail.log.gz", 1051, 361, 0.5, 383, 410, corrected, 0, 50, 0},
      {"aces/aces-corrected.log.gz", 440, 180, 1, 323, 1318, corrected, 0, 50, 0},
      {"fr101/freiburg-101-corrected.log.gz", 292, 360, 0.5, 211, 919, corrected, -0.04, 80.99, 0},
      {"intel/intel-910-merged.log.gz", 910, 180, 1, 500, 2651, both, 0, 50, 0},
      {"mit-csail/mit-csail.clf.gz", 1988, 361, 0.5, 374, 424, odometry, 0, 50, 0},
      {"mit-csail/mit-csail-1051-merged.log.gz", 1051, 361, 0.5, 383, 410, both, 0, 50, 0},
      {"mrpt-sena/sena_telecom_one_loop.rawlog.clf.gz", 225, 361, 0.5, 76.5, 59, odometry, 0.78, 80, 0}};
  return logs;
}

class RealLogs : public testing::TestWithParam<RealLog> {};

double path_length(const std::vector<Pose2>& poses) {
  double path = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) { path += distance(poses[i - 1], poses[i]); }
  return path;
}

TEST_P(RealLogs, AreReadAsDescribed) {
  const RealLog& expected = GetParam();
  const auto path = data_file(expected.file);
  if (!path) { GTEST_SKIP() << "no real logs here: " << expected.file; }
  const LoadedLog loaded = read_log(*path).value();
  const std::vector<Scan>& scans = loaded.log.scans;
  ASSERT_EQ(scans.size(), expected.scans);
  EXPECT_TRUE(
      std::all_of(scans.begin(), scans.end(), [&](const Scan& scan) { return scan.ranges.size() == expected.beams; }));
  EXPECT_NEAR(degrees_from_radians(scans[0].beams.angle_min), -90, 1e-3);
  EXPECT_NEAR(degrees_from_radians(scans[0].beams.angle_step), expected.step, 1e-4);
  EXPECT_NEAR(path_length(loaded.log.map_from_robot), expected.path, 0.7);  // those of the laser, in whole metres
  EXPECT_NEAR(std::abs(scans.back().stamp - scans.front().stamp), expected.duration, 1);
  EXPECT_EQ(to_string(loaded.report.poses), to_string(expected.poses));
  EXPECT_NEAR(scans[0].robot_from_sensor.x, expected.laser_ahead, 1e-5);
  EXPECT_EQ(scans[0].beams.range_max, expected.range_max);
  EXPECT_EQ(loaded.report.stamps_backwards, expected.stamps_backwards);
  EXPECT_TRUE(loaded.report.is_gzip);
}

TEST_P(RealLogs, HaveNoReadingsBetweenTheirWallsAndNoReturn) {
  const RealLog& expected = GetParam();
  const auto path = data_file(expected.file);
  if (!path) { GTEST_SKIP() << "no real logs here: " << expected.file; }
  const ScanLog log = read_log(*path).value().log;
  std::size_t no_return = 0;
  std::size_t readings = 0;
  for (const Scan& scan : log.scans) {
    readings += scan.ranges.size();
    no_return += static_cast<std::size_t>(std::count_if(scan.ranges.begin(), scan.ranges.end(), [&](double range) {
      return classify(range, scan.beams) == Reading::no_return;
    }));
    for (const double range : scan.ranges) { ASSERT_TRUE(range > 81.8 || range <= 80.0) << range; }
  }
  EXPECT_GT(no_return, readings / 200);  // 0.5 % to 40 % in these logs
  EXPECT_LT(no_return, readings / 2);
}

TEST_P(RealLogs, ReadBackTheSameAfterWriting) {
  const RealLog& expected = GetParam();
  const auto path = data_file(expected.file);
  if (!path) { GTEST_SKIP() << "no real logs here: " << expected.file; }
  const LoadedLog original = read_log(*path).value();
  const TemporaryFolder folder;
  ASSERT_TRUE(write_carmen(folder.path() / "copy.log", original.log));
  const LoadedLog copy = read_log(folder.path() / "copy.log").value();
  ASSERT_EQ(copy.log.scans.size(), original.log.scans.size());
  EXPECT_EQ(copy.report.poses, original.report.poses);
  EXPECT_EQ(copy.log.map_from_robot, original.log.map_from_robot);
  for (std::size_t i = 0; i < copy.log.scans.size(); ++i) {
    EXPECT_EQ(copy.log.scans[i].ranges, original.log.scans[i].ranges);
    EXPECT_EQ(copy.log.scans[i].beams, original.log.scans[i].beams);
    EXPECT_EQ(copy.log.scans[i].stamp, original.log.scans[i].stamp);
    EXPECT_EQ(copy.log.scans[i].odom_from_robot, original.log.scans[i].odom_from_robot);
    EXPECT_NEAR(copy.log.scans[i].robot_from_sensor.x, original.log.scans[i].robot_from_sensor.x, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Data, RealLogs, testing::ValuesIn(real_logs()), [](const auto& test) {
  std::string name(test.param.file);
  std::replace_if(name.begin(), name.end(), [](char c) { return c == '/' || c == '.' || c == '-'; }, '_');
  return name;
});

/// How blurred the map of a log is with the laser at `laser_ahead` m before its stated sensor pose: entropy of the end
/// points over cells of 5 cm, nats.
double blur(const ScanLog& log, double laser_ahead) {
  std::vector<std::int64_t> cells;
  for (std::size_t i = 0; i < log.scans.size(); i += 2) {
    const Pose2 map_from_sensor = log.map_from_sensor(i) * Pose2{laser_ahead, 0, 0};
    for (const BeamPoint& hit : hit_points(log.scans[i])) {
      if (norm(hit.point) > 15) { continue; }
      const Point2 point = 20 * (map_from_sensor * hit.point);
      cells.push_back(std::llround(std::floor(point.x)) * 1'000'003 + std::llround(std::floor(point.y)));
    }
  }
  std::sort(cells.begin(), cells.end());
  double entropy = 0;
  for (auto begin = cells.begin(); begin != cells.end();) {
    const auto end = std::upper_bound(begin, cells.end(), *begin);
    const double share = static_cast<double>(end - begin) / static_cast<double>(cells.size());
    entropy -= share * std::log(share);
    begin = end;
  }
  return entropy;
}

TEST(RealLogPoses, PutTheLaserWhereTheWallsAreSharpest) {
  for (const std::string_view file : {"fr079/flirtlib-fr079.log.gz", "fr101/freiburg-101-corrected.log.gz",
                                      "mit-csail/flirtlib-mit-cscail.log.gz", "aces/aces-corrected.log.gz"}) {
    const auto path = data_file(file);
    if (!path) { GTEST_SKIP() << "no real logs here: " << file; }
    const ScanLog log = read_log(*path).value().log;
    const double as_read = blur(log, 0);
    EXPECT_LT(as_read, blur(log, -0.04)) << file;
    EXPECT_LT(as_read, blur(log, 0.04)) << file;  // as if the stated pose were the robot's
  }
}

TEST(ReadLog, ReportsProgressUpToOne) {
  const auto path = data_file("fr079/flirtlib-fr079.log.gz");
  if (!path) { GTEST_SKIP() << "no real logs here"; }
  std::vector<double> shares;
  ASSERT_TRUE(read_log(*path, {}, [&](double share) { shares.push_back(share); }));
  ASSERT_GT(shares.size(), 5U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
}

}  // namespace
}  // namespace flirt
