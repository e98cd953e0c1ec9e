#include "flirt/core/assert.hpp"
#include "flirt/io/carmen.hpp"
#include "flirt/io/text.hpp"

#include <algorithm>
#include <initializer_list>
#include <optional>

namespace flirt {
namespace {

/// Appends words and numbers with single spaces between them.
class LineWriter {
 public:
  explicit LineWriter(std::string& text, std::string_view kind) : text_(text) { text_.append(kind); }

  void numbers(std::initializer_list<double> values) {
    for (const double value : values) { number(value); }
  }
  void number(double value) {
    text_ += ' ';
    append_number(text_, value);
  }
  void count(std::size_t value) {
    text_ += ' ';
    append_number(text_, value);
  }
  void pose(const Pose2& pose) { numbers({pose.x, pose.y, pose.theta}); }
  /// The three fields at the end of all CARMEN lines.
  void finish(double stamp, double first_stamp) {
    number(stamp);
    text_ += " flirt";
    number(stamp - first_stamp);
    text_ += '\n';
  }
  void finish() { text_ += '\n'; }

 private:
  std::string& text_;
};

/// The fields that ROBOTLASER and RAWLASER share.
void write_readings(LineWriter& line, const Scan& scan) {
  const auto n = static_cast<double>(scan.ranges.size());
  line.count(0);  // laser type: unknown
  line.numbers({scan.beams.angle_min, n * scan.beams.angle_step, scan.beams.angle_step, scan.beams.range_max});
  line.numbers({0, 0});  // accuracy, remission mode
  line.count(scan.ranges.size());
  for (const double range : scan.ranges) { line.number(range); }
  line.count(0);  // remissions
}

void write_odometry(std::string& text, const Pose2& odom_from_robot, double stamp, double first_stamp) {
  LineWriter line(text, "ODOM");
  line.pose(odom_from_robot);
  line.numbers({0, 0, 0});  // velocities, acceleration
  line.finish(stamp, first_stamp);
}

/// True when the log states poses that its odometry does not.
bool has_other_poses(const ScanLog& log) {
  for (std::size_t i = 0; i < log.map_from_robot.size(); ++i) {
    if (log.scans[i].odom_from_robot != log.map_from_robot[i]) { return true; }
  }
  return false;
}

/// The pose that the log states beside its odometry, if that is written, so that it is not lost.
void write_stated_pose(std::string& text, const ScanLog& log, std::size_t i, const std::optional<Pose2>& odometry) {
  const Pose2& map_from_robot = log.map_from_robot[i];
  if (!odometry) {
    LineWriter line(text, "VERTEX2");
    line.count(i);
    line.pose(map_from_robot);
    line.finish();
  } else {
    LineWriter line(text, "TRUEPOS");
    line.pose(map_from_robot);
    line.pose(*odometry);
    line.finish(log.scans[i].stamp, log.scans.front().stamp);
  }
}

void write_robotlaser(std::string& text, const ScanLog& log, std::size_t i, const Pose2& world_from_robot) {
  const Scan& scan = log.scans[i];
  LineWriter line(text, "ROBOTLASER1");
  write_readings(line, scan);
  line.pose(world_from_robot * scan.robot_from_sensor);
  line.pose(world_from_robot);
  line.numbers({0, 0, 0, 0, 0});  // velocities, safety distances, turn axis
  line.finish(scan.stamp, log.scans.front().stamp);
}

void write_rawlaser(std::string& text, const ScanLog& log, std::size_t i) {
  LineWriter line(text, "RAWLASER1");
  write_readings(line, log.scans[i]);
  line.finish(log.scans[i].stamp, log.scans.front().stamp);
}

/// Where the laser sits, for scan lines that do not say it.
Result<void> write_mounting(std::string& text, const ScanLog& log) {
  const Pose2 robot_from_sensor = log.scans.front().robot_from_sensor;
  const bool is_offset = robot_from_sensor.y == 0 && robot_from_sensor.theta == 0;
  const bool is_same = std::all_of(log.scans.begin(), log.scans.end(),
                                   [&](const Scan& scan) { return scan.robot_from_sensor == robot_from_sensor; });
  if (!is_offset || !is_same) {
    return fail(
        "to write scans without poses as CARMEN: expected a laser straight ahead at a fixed offset, found another");
  }
  LineWriter line(text, "PARAM robot_frontlaser_offset");
  line.number(robot_from_sensor.x);
  text += " flirt 0\n";
  return {};
}

}  // namespace

Result<std::string> to_carmen(const ScanLog& log) {
  [[maybe_unused]] const std::size_t poses = log.map_from_robot.size();
  FLIRT_ASSERT(poses == (poses == 0 ? 0 : log.scans.size()));
  std::string text(
      "# CARMEN log; ROBOTLASER1 type start fov step max accuracy remission_mode n ranges m remissions laser_pose "
      "robot_pose tv rv forward_safety side_safety turn_axis stamp host logger_stamp\n");
  const bool has_odometry =
      std::ranges::all_of(log.scans, [](const Scan& scan) { return scan.odom_from_robot.has_value(); });
  const bool has_poses = has_odometry || !log.map_from_robot.empty();
  if (!has_poses) {
    if (auto good = write_mounting(text, log); !good) { return tl::unexpected(good.error()); }
  }
  const bool keeps_poses = has_other_poses(log);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const Scan& scan = log.scans[i];
    const std::optional<Pose2> odometry = has_odometry ? scan.odom_from_robot : std::nullopt;
    if (keeps_poses) { write_stated_pose(text, log, i, odometry); }
    if (odometry) { write_odometry(text, *odometry, scan.stamp, log.scans.front().stamp); }
    if (has_poses) {
      write_robotlaser(text, log, i, odometry ? *odometry : log.map_from_robot[i]);
    } else {
      write_rawlaser(text, log, i);
    }
  }
  return text;
}

Result<void> write_carmen(const std::filesystem::path& path, const ScanLog& log) {
  return to_carmen(log).and_then([&](const std::string& text) { return write_file_atomically(path, text); });
}

}  // namespace flirt
