#include "apps/flirt/localize_track.hpp"

#include "flirt/core/stopwatch.hpp"

#include "apps/flirt/localize_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace flirt::app {
namespace {

bool agrees(const TrackedScan& tracked) {
  return tracked.pose_in_log && distance(tracked.step.map_from_robot, *tracked.pose_in_log) <= 0.5 &&
         heading_difference(tracked.step.map_from_robot, *tracked.pose_in_log) <= radians_from_degrees(10);
}

nlohmann::ordered_json json_or_null(const std::optional<std::size_t>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

/// A cluster as the place of the sensor, as all hypotheses of `flirt localize` are.
nlohmann::ordered_json cluster_json(const TrackCluster& cluster, const Pose2& robot_from_sensor) {
  const Pose2 map_from_sensor = cluster.map_from_robot * robot_from_sensor;
  const Point2 lever = map_from_sensor.translation() - cluster.map_from_robot.translation();
  Eigen::Matrix3d sensor_by_robot = Eigen::Matrix3d::Identity();
  sensor_by_robot(0, 2) = -lever.y;
  sensor_by_robot(1, 2) = lever.x;
  nlohmann::ordered_json json =
      pose_json(map_from_sensor, sensor_by_robot * cluster.covariance * sensor_by_robot.transpose());
  json["weight"] = cluster.share;
  return json;
}

nlohmann::ordered_json step_json(std::size_t scan, const TrackedScan& tracked, const Scan& taken, std::size_t most) {
  const TrackStep& step = tracked.step;
  nlohmann::ordered_json json{{"scan", scan},
                              {"stamp", taken.stamp},
                              {"verdict", to_string(step.verdict)},
                              {"reason", to_string(step.reason)},
                              {"confidence", step.confidence},
                              {"belief", step.belief},
                              {"points", step.points},
                              {"effective_particles", step.effective},
                              {"searched", step.searched},
                              {"injected", step.injected},
                              {"time_us", tracked.time_us},
                              {"places", step.clusters.size()},
                              {"robot", nullptr},
                              {"hypotheses", nlohmann::ordered_json::array()}};
  if (!step.clusters.empty()) {
    json["robot"] = pose_json(step.map_from_robot, step.covariance);
    if (tracked.pose_in_log) { json["agrees"] = agrees(tracked); }
  }
  for (std::size_t i = 0; i < std::min(most, step.clusters.size()); ++i) {
    json["hypotheses"].push_back(cluster_json(step.clusters[i], taken.robot_from_sensor));
    if (i == 0) {  // others are not scored by all points
      json["hypotheses"][0]["score"] = step.evidence.total;
      json["hypotheses"][0]["evidence"] = evidence_json(step.evidence);
    }
  }
  return json;
}

nlohmann::ordered_json summary_json(const TrackSummary& summary) {
  return {{"scans", summary.scans},
          {"until_localized", json_or_null(summary.until_localized)},
          {"until_rightly_localized", json_or_null(summary.until_rightly_localized)},
          {"unique", summary.unique},
          {"ambiguous", summary.ambiguous},
          {"lost", summary.lost},
          {"right", json_or_null(summary.right)},
          {"wrong", json_or_null(summary.wrong)},
          {"wrong_convergences", json_or_null(summary.wrong_convergences)},
          {"searches", summary.searches},
          {"injections", summary.injections}};
}

std::string count_text(const std::optional<std::size_t>& scans) {
  return scans ? fmt::format("{}", *scans) : std::string("never");
}

}  // namespace

bool TrackedScan::is_right() const {
  return step.verdict == Verdict::unique && agrees(*this);
}

bool TrackedScan::is_wrong() const {
  return step.verdict == Verdict::unique && pose_in_log && !agrees(*this);
}

TrackSummary summarise(std::span<const TrackedScan> scans) {
  TrackSummary summary{.scans = scans.size()};
  const bool has_poses = !scans.empty() && scans.front().pose_in_log.has_value();
  std::size_t right = 0;
  std::size_t wrong = 0;
  std::size_t convergences = 0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const TrackStep& step = scans[i].step;
    summary.unique += step.verdict == Verdict::unique ? 1U : 0U;
    summary.ambiguous += step.verdict == Verdict::ambiguous ? 1U : 0U;
    summary.lost += step.verdict == Verdict::lost ? 1U : 0U;
    summary.searches += step.searched ? 1U : 0U;
    summary.injections += step.injected ? 1U : 0U;
    if (step.verdict == Verdict::unique && !summary.until_localized) { summary.until_localized = i + 1; }
    if (scans[i].is_right() && !summary.until_rightly_localized) { summary.until_rightly_localized = i + 1; }
    right += scans[i].is_right() ? 1U : 0U;
    wrong += scans[i].is_wrong() ? 1U : 0U;
    convergences += scans[i].is_wrong() && (i == 0 || !scans[i - 1].is_wrong()) ? 1U : 0U;
  }
  if (has_poses) {
    summary.right = right;
    summary.wrong = wrong;
    summary.wrong_convergences = convergences;
  }
  return summary;
}

DrivenLog with_odometry(LoadedLog loaded) {
  const PoseSource poses = loaded.report.poses;
  DrivenLog driven{
      .log = std::move(loaded.log),
      .odometry = "none",
      .has_corrected_poses = poses == PoseSource::corrected || poses == PoseSource::corrected_and_odometry};
  std::vector<Scan>& scans = driven.log.scans;
  if (loaded.report.odometry_repeats_pose) {
    driven.odometry = "repeats_poses";
    for (std::size_t i = 0; i < scans.size(); ++i) { scans[i].odom_from_robot = driven.log.map_from_robot[i]; }
  } else if (std::ranges::any_of(scans, [](const Scan& scan) { return scan.odom_from_robot.has_value(); })) {
    driven.odometry = "own";
  }
  return driven;
}

std::vector<TrackedScan> track(const PlaceMap& map, const DrivenLog& driven, const TrackerParams& params,
                               const Session& session) {
  const ScanLog& log = driven.log;
  Tracker tracker(map, params, session.threads);
  const Progress progress = progress_bar(session, "tracking");
  std::vector<TrackedScan> tracked;
  tracked.reserve(log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    Stopwatch stopwatch;
    TrackStep step = tracker.add(log.scans[i]);
    const double time_us = stopwatch.lap_us();
    tracked.push_back({.step = std::move(step), .time_us = time_us});
    if (driven.has_corrected_poses) { tracked.back().pose_in_log = log.map_from_robot[i]; }
    if (progress) { progress(static_cast<double>(i + 1) / static_cast<double>(log.scans.size())); }
  }
  return tracked;
}

nlohmann::ordered_json track_json(const DrivenLog& driven, std::span<const TrackedScan> scans,
                                  std::size_t most_places) {
  nlohmann::ordered_json json{{"odometry", driven.odometry}, {"summary", summary_json(summarise(scans))}};
  json["queries"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < scans.size(); ++i) {
    json["queries"].push_back(step_json(i, scans[i], driven.log.scans[i], most_places));
  }
  return json;
}

std::string track_line(std::size_t scan, const TrackedScan& tracked) {
  const TrackStep& step = tracked.step;
  std::string line = fmt::format("scan {:>5}  {:<9}", scan, to_string(step.verdict));
  if (step.clusters.empty()) { return line; }
  const Pose2& pose = step.map_from_robot;
  line += fmt::format("  x {:8.3f} m  y {:8.3f} m  {:7.2f} deg  confidence {:.3f}", pose.x, pose.y,
                      degrees_from_radians(pose.theta), step.confidence);
  if (tracked.pose_in_log) {
    line += fmt::format("  {:.3f} m {:.2f} deg from the log's pose", distance(pose, *tracked.pose_in_log),
                        degrees_from_radians(heading_difference(pose, *tracked.pose_in_log)));
  }
  return step.verdict == Verdict::unique ? line : line + "  " + std::string(to_string(step.reason));
}

std::string track_text(const DrivenLog& driven, std::span<const TrackedScan> scans) {
  const TrackSummary summary = summarise(scans);
  std::string text;
  if (driven.odometry == "repeats_poses") {
    text += "the odometry of this log repeats its poses (it was corrected): motion is better than a robot's own\n";
  } else if (driven.odometry == "none") {
    text += "this log has no odometry: the robot is taken to stand between scans\n";
  }
  text += fmt::format("{} scans: {} unique, {} ambiguous, {} lost; localized after {} scans; {} searches, {} draws\n",
                      summary.scans, summary.unique, summary.ambiguous, summary.lost,
                      count_text(summary.until_localized), summary.searches, summary.injections);
  if (summary.right) {
    text += fmt::format(
        "against the log's poses: {} right, {} wrong of the unique, {} wrong convergences; rightly "
        "localized after {} scans\n",
        *summary.right, *summary.wrong, *summary.wrong_convergences, count_text(summary.until_rightly_localized));
  }
  return text;
}

}  // namespace flirt::app
