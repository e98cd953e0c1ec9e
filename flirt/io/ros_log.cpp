#include "flirt/io/ros_log.hpp"

#include "flirt/io/frames.hpp"
#include "flirt/io/log_oddities.hpp"
#include "flirt/io/recording.hpp"
#include "flirt/io/ros_messages.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace flirt {
namespace {

using ros::Frames;

constexpr double most_tilt = 15.0 * std::numbers::pi / 180.0;  // rad

/// What the messages said, in file order; what it means is only known at their end.
class Gathered {
 public:
  Gathered(std::string name, const ReadOptions& options, LogReport& report)
      : name_(std::move(name)), options_(options), report_(report) {
    report_.message = options.message;
  }

  Result<void> add(const bag::Message& message) {
    ++report_.lines;
    const auto understood = understand(message);
    const std::string topic(message.topic);
    if (understood) {
      ++(*understood ? report_.lines_used : report_.lines_skipped)[topic];
      return {};
    }
    const std::string where = name_ + ": message " + std::to_string(report_.lines) + ", " + topic + ": ";
    return reject(report_, options_, where + understood.error().message);
  }

  std::vector<ros::LaserScan> scans{};
  std::vector<ros::Moment> moments{};  ///< of the scans
  std::vector<std::string> scan_topics{};
  Frames frames{};
  std::string odometry_topic{};
  std::string odometry_child{};
  ros::PosesOverTime odometry{};

 private:
  /// Whether the message is of use.
  Result<bool> understand(const bag::Message& message) {
    if (message.type == ros::laser_scan_type) { return add_scan(message); }
    if (message.type == ros::odometry_type) { return add_odometry(message); }
    if (!ros::is_transform_type(message.type)) { return false; }
    const auto transforms = ros::transforms_of(message);
    if (!transforms) { return tl::unexpected(transforms.error()); }
    for (const ros::Transform& transform : *transforms) { frames.add(transform, report_.lines); }
    return true;
  }

  Result<bool> add_scan(const bag::Message& message) {
    if (std::ranges::find(scan_topics, message.topic) == scan_topics.end()) { scan_topics.emplace_back(message.topic); }
    if (report_.message.empty()) { report_.message = message.topic; }
    if (message.topic != report_.message) { return false; }
    auto scan = ros::laser_scan_of(message);
    if (!scan) { return tl::unexpected(scan.error()); }
    moments.push_back({scan->stamp, report_.lines});
    scans.push_back(std::move(*scan));
    return true;
  }

  Result<bool> add_odometry(const bag::Message& message) {
    if (odometry_topic.empty()) { odometry_topic = message.topic; }
    if (message.topic != odometry_topic) { return false; }
    const auto pose = ros::odometry_of(message);
    if (!pose) { return tl::unexpected(pose.error()); }
    odometry_child = pose->child;
    odometry.add({pose->stamp, report_.lines}, pose->parent_from_child);
    return true;
  }

  std::string name_;
  const ReadOptions& options_;
  LogReport& report_;
};

// --- Frames ----------------------------------------------------------------------------------------------------------

/// "odom" as well as "robot/odom".
bool is_called(const std::string& frame, std::string_view name) {
  return frame == name || frame.ends_with("/" + std::string(name));
}

/// The frames that matter for the scans; empty: there is none.
struct Roles {
  std::string robot{};
  std::string odom{};
  std::string map{};
};

Roles roles_of(const Gathered& gathered, const std::string& sensor) {
  Roles roles;
  const std::vector<std::string> chain = gathered.frames.chain(sensor);
  roles.robot = chain.back();
  for (std::size_t i = chain.size(); i-- > 1;) {  // from the top
    const bool is_map = is_called(chain[i], "map");
    if (!is_map && !is_called(chain[i], "odom")) { continue; }
    (is_map ? roles.map : roles.odom) = chain[i];
    roles.robot = chain[i - 1];
  }
  if (roles.map.empty() && roles.odom.empty() && !gathered.odometry_topic.empty() &&
      gathered.frames.target_from_source(gathered.odometry_child, sensor, {})) {
    roles.robot = gathered.odometry_child;
  }
  return roles;
}

/// Puts the sensor where it sits.
Result<void> mount(const Eigen::Isometry3d& robot_from_sensor, Scan& scan) {
  const double upward = robot_from_sensor.rotation()(2, 2);
  const double tilt = std::acos(std::min(1.0, std::abs(upward)));
  if (tilt > most_tilt) {
    return fail("expected a level scanner, found one tilted by " +
                std::to_string(std::lround(tilt * 180.0 / std::numbers::pi)) + " degrees");
  }
  Eigen::Isometry3d robot_from_beams = robot_from_sensor;
  if (upward < 0) {
    robot_from_beams.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
    scan.beams.angle_min = -scan.beams.angle_min;
    scan.beams.angle_step = -scan.beams.angle_step;
  }
  scan.robot_from_sensor = ros::planar(robot_from_beams);
  return {};
}

std::optional<Pose2> odometry_at(const Gathered& gathered, const Roles& roles, const ros::Moment& moment) {
  if (!roles.odom.empty()) {
    if (!gathered.frames.covers(roles.robot, moment)) { return std::nullopt; }
    return ros::planar(*gathered.frames.target_from_source(roles.odom, roles.robot, moment));
  }
  return gathered.odometry.covers(moment) ? std::optional(ros::planar(gathered.odometry.at(moment))) : std::nullopt;
}

/// The scans with their frames and poses.
Result<ScanLog> place(Gathered& gathered, LogReport& report) {
  gathered.frames.sort();
  gathered.odometry.sort();
  const std::string sensor = gathered.scans.front().frame;
  const Roles roles = roles_of(gathered, sensor);
  report.is_mounting_unknown = gathered.frames.chain(sensor).size() == 1;
  ScanLog log;
  std::vector<Pose2> odom_from_robot;
  for (std::size_t i = 0; i < gathered.scans.size(); ++i) {
    ros::LaserScan& from = gathered.scans[i];
    const ros::Moment& moment = gathered.moments[i];
    Scan scan{.stamp = from.stamp, .beams = from.beams, .ranges = std::move(from.ranges)};
    const auto robot_from_sensor = gathered.frames.target_from_source(roles.robot, from.frame, moment);
    if (!robot_from_sensor) {
      return fail("expected scans of one scanner, found the frames " + sensor + " and " + from.frame);
    }
    if (auto level = mount(*robot_from_sensor, scan); !level) { return tl::unexpected(level.error()); }
    scan.odom_from_robot = odometry_at(gathered, roles, moment);
    if (scan.odom_from_robot) { odom_from_robot.push_back(*scan.odom_from_robot); }
    if (!roles.map.empty()) {
      log.map_from_robot.push_back(ros::planar(*gathered.frames.target_from_source(roles.map, roles.robot, moment)));
    }
    log.scans.push_back(std::move(scan));
  }
  if (!roles.map.empty()) {
    report.poses = odom_from_robot.empty() ? PoseSource::corrected : PoseSource::corrected_and_odometry;
  } else if (!odom_from_robot.empty()) {
    report.poses = PoseSource::odometry;
    if (odom_from_robot.size() == log.scans.size()) { log.map_from_robot = std::move(odom_from_robot); }
  }
  return log;
}

// --- What is missing -------------------------------------------------------------------------------------------------

std::string list_of(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) { list += (list.empty() ? "" : ", ") + name; }
  return list;
}

Error why_no_scans(const std::string& name, const Gathered& gathered, const ReadOptions& options,
                   const LogReport& report) {
  if (!report.broken_messages.empty()) { return {report.broken_messages.front()}; }
  if (!gathered.scan_topics.empty()) {
    return {name + ": expected scans on " + options.message + ", found them on " + list_of(gathered.scan_topics)};
  }
  std::vector<std::string> topics;
  for (const auto& [topic, count] : report.lines_skipped) { topics.push_back(topic); }
  return {name + ": expected a topic of type sensor_msgs/LaserScan, found " +
          (topics.empty() ? std::string("none") : "only " + list_of(topics))};
}

}  // namespace

Result<LoadedLog> read_ros_log(const std::filesystem::path& path, const ReadOptions& options,
                               const Progress& progress) {
  LoadedLog loaded;
  LogReport& report = loaded.report;
  Gathered gathered(path.string(), options, report);
  const auto format =
      bag::read_recording(path, [&](const bag::Message& message) { return gathered.add(message); }, progress);
  if (!format) {
    if (auto good = reject(report, options, format.error().message); !good) { return tl::unexpected(good.error()); }
  }
  report.format = format.value_or("ROS recording");
  report.unit = "message";
  if (gathered.scans.empty()) { return tl::unexpected(why_no_scans(path.string(), gathered, options, report)); }
  auto log = place(gathered, report);
  if (!log) { return fail(path.string() + ": " + report.message + ": " + log.error().message); }
  loaded.log = std::move(*log);
  report.range_max_source = settle_range_max(options.range_max, loaded.log.scans);
  describe_stamps(loaded.log.scans, report);
  return loaded;
}

}  // namespace flirt
