#include "flirt/io/carmen_assembly.hpp"

#include "flirt/io/log_oddities.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace flirt::carmen {
namespace {

constexpr double same_pose = 1e-6;       // m, rad; the logs write at least so many digits of equal poses
constexpr double same_mounting = 1e-5;   // m, rad; rounding of two poses with six decimals
constexpr double mounting_slack = 2e-3;  // m, rad; rounding of two poses with six significant digits

bool is_near(const Pose2& a, const Pose2& b, double tolerance) {
  return std::abs(a.x - b.x) <= tolerance && std::abs(a.y - b.y) <= tolerance && heading_difference(a, b) <= tolerance;
}

// --- Where the laser sits --------------------------------------------------------------------------------------------

Pose2 mounting_by_parameter(const Gathered& gathered) {
  if (gathered.kind == "RLASER") { return {gathered.rear_offset.value_or(0.0), 0, std::numbers::pi}; }
  return {gathered.front_offset.value_or(0.0), 0, 0};
}

/// From the two poses of each ROBOTLASER line. The poses are rounded in the log; the mounting does not jitter with
/// them.
void mount_by_lines(const Gathered& gathered, std::vector<Scan>& scans) {
  Pose2 last;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const ScanLine& line = gathered.scans[i];
    const bool is_centred = line.first_pose == line.second_pose;  // exactly, without rounding
    const Pose2 robot_from_sensor = is_centred ? Pose2{} : inverse(*line.second_pose) * *line.first_pose;
    if (i == 0 || !is_near(robot_from_sensor, last, same_mounting)) { last = robot_from_sensor; }
    scans[i].robot_from_sensor = last;
  }
}

void mount(const Pose2& robot_from_sensor, std::vector<Scan>& scans) {
  for (Scan& scan : scans) { scan.robot_from_sensor = robot_from_sensor; }
}

// --- Poses -----------------------------------------------------------------------------------------------------------

bool poses_are_equal(const std::vector<ScanLine>& lines) {
  return std::all_of(lines.begin(), lines.end(),
                     [](const ScanLine& line) { return is_near(*line.first_pose, *line.second_pose, same_pose); });
}

/// The motion from the second to the first pose when it is the same throughout a drive of a metre and more, and short
/// enough for a laser on its robot.
std::optional<Pose2> constant_motion(const std::vector<ScanLine>& lines) {
  const Pose2 first_motion = inverse(*lines.front().second_pose) * *lines.front().first_pose;
  double path = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Pose2 motion = inverse(*lines[i].second_pose) * *lines[i].first_pose;
    if (!is_near(motion, first_motion, mounting_slack)) { return std::nullopt; }
    if (i > 0) { path += distance(*lines[i].second_pose, *lines[i - 1].second_pose); }
  }
  const bool is_plausible = path >= 1.0 && norm(first_motion.translation()) <= 2.0;
  return is_plausible ? std::optional(first_motion) : std::nullopt;
}

void state_odometry(const Gathered& gathered, ScanLog& log) {
  for (std::size_t i = 0; i < log.scans.size(); ++i) { log.scans[i].odom_from_robot = gathered.scans[i].second_pose; }
}

/// The first pose of a FLASER line is the laser's.
void state_poses_by_laser(const Gathered& gathered, ScanLog& log) {
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    log.map_from_robot.push_back(*gathered.scans[i].first_pose * inverse(log.scans[i].robot_from_sensor));
  }
}

/// The second pose of ROBOTLASER and FLASER lines is the robot's.
void state_poses_by_robot(const Gathered& gathered, ScanLog& log) {
  for (const ScanLine& line : gathered.scans) { log.map_from_robot.push_back(*line.second_pose); }
}

/// Poses of FLASER lines and where their laser sits.
PoseSource place_flaser(const Gathered& gathered, ScanLog& log, LogReport& report) {
  mount(mounting_by_parameter(gathered), log.scans);
  if (poses_are_equal(gathered.scans)) {
    state_poses_by_laser(gathered, log);
    report.odometry_repeats_pose = gathered.is_corrected;
    if (gathered.is_corrected) { return PoseSource::corrected; }
    for (std::size_t i = 0; i < log.scans.size(); ++i) { log.scans[i].odom_from_robot = log.map_from_robot[i]; }
    return PoseSource::odometry;
  }
  if (const auto robot_from_sensor = constant_motion(gathered.scans)) {
    mount(*robot_from_sensor, log.scans);
    state_poses_by_robot(gathered, log);
    report.odometry_repeats_pose = gathered.is_corrected;
    if (gathered.is_corrected) { return PoseSource::corrected; }
    state_odometry(gathered, log);
    return PoseSource::odometry;
  }
  state_odometry(gathered, log);
  state_poses_by_laser(gathered, log);
  return PoseSource::corrected_and_odometry;
}

PoseSource place_robotlaser(const Gathered& gathered, ScanLog& log) {
  mount_by_lines(gathered, log.scans);
  state_poses_by_robot(gathered, log);
  if (gathered.is_corrected) { return PoseSource::corrected; }
  state_odometry(gathered, log);
  return PoseSource::odometry;
}

/// The odometry at the stamp of a scan, else the last before it in the log.
std::optional<Pose2> odometry_at(const Gathered& gathered, std::size_t scan) {
  const std::size_t next = gathered.odometry_before[scan];
  const bool is_next = next < gathered.odometry.size() && gathered.odometry[next].stamp == gathered.scans[scan].stamp;
  if (is_next) { return gathered.odometry[next].pose; }
  return next == 0 ? std::nullopt : std::optional(gathered.odometry[next - 1].pose);
}

PoseSource place_rawlaser(const Gathered& gathered, ScanLog& log) {
  mount(mounting_by_parameter(gathered), log.scans);
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    log.scans[i].odom_from_robot = odometry_at(gathered, i);
    if (log.scans[i].odom_from_robot) { poses.push_back(*log.scans[i].odom_from_robot); }
  }
  const bool is_complete = poses.size() == log.scans.size();
  if (is_complete) { log.map_from_robot = poses; }
  return poses.empty() ? PoseSource::none : PoseSource::odometry;
}

/// True poses, where every scan has one, take the place of those in the scan lines.
void place_true_poses(const Gathered& gathered, ScanLog& log, LogReport& report) {
  const auto has_value = [](const std::optional<Pose2>& pose) { return pose.has_value(); };
  if (!std::all_of(gathered.true_pose.begin(), gathered.true_pose.end(), has_value)) { return; }
  log.map_from_robot.clear();
  for (const auto& pose : gathered.true_pose) { log.map_from_robot.push_back(*pose); }
  const bool has_odometry = report.poses == PoseSource::odometry || report.poses == PoseSource::corrected_and_odometry;
  report.poses = has_odometry ? PoseSource::corrected_and_odometry : PoseSource::corrected;
}

void place(const Gathered& gathered, ScanLog& log, LogReport& report) {
  switch (*layout_of(gathered.kind)) {
    case Layout::flaser:
      report.poses = place_flaser(gathered, log, report);
      break;
    case Layout::robotlaser:
      report.poses = place_robotlaser(gathered, log);
      break;
    case Layout::rawlaser:
      report.poses = place_rawlaser(gathered, log);
      break;
  }
  place_true_poses(gathered, log, report);
}

// --- Ranges ----------------------------------------------------------------------------------------------------------

/// By a parameter, where the scan line does not say.
void declare_range_max(const Gathered& gathered, std::vector<Scan>& scans) {
  const std::optional<double>& parameter =
      gathered.kind == "RLASER" ? gathered.rear_range_max : gathered.front_range_max;
  if (!parameter || !(*parameter > 0)) { return; }
  for (Scan& scan : scans) {
    if (!(scan.beams.range_max > 0)) { scan.beams.range_max = *parameter; }
  }
}

// --- Stamps ----------------------------------------------------------------------------------------------------------

int most_digits(const std::vector<ScanLine>& lines) {
  int digits = 0;
  for (const ScanLine& line : lines) { digits = std::max(digits, line.stamp_digits); }
  return digits;
}

/// Whether programs that write 6 digits have cut the tenths of seconds, and more, off long stamps.
bool are_rounded(const std::vector<ScanLine>& lines) {
  constexpr int digits_by_default = 6;
  constexpr double without_tenths = 1e5;  // s, from there on
  return most_digits(lines) <= digits_by_default &&
         std::ranges::any_of(lines, [](const ScanLine& line) { return std::abs(line.stamp) >= without_tenths; });
}

}  // namespace

ScanLog assemble(Gathered gathered, std::optional<double> range_max, LogReport& report) {
  ScanLog log;
  for (ScanLine& line : gathered.scans) {
    log.scans.push_back({.stamp = line.stamp, .beams = line.beams, .ranges = std::move(line.ranges)});
  }
  place(gathered, log, report);
  declare_range_max(gathered, log.scans);
  report.range_max_source = settle_range_max(range_max, log.scans);
  describe_stamps(log.scans, report);
  report.stamp_digits = most_digits(gathered.scans);
  report.stamps_rounded = are_rounded(gathered.scans);
  return log;
}

}  // namespace flirt::carmen
