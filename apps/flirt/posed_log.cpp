#include "apps/flirt/posed_log.hpp"

#include "flirt/eval/trajectory_metrics.hpp"
#include "flirt/io/format.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace flirt::app {
namespace {

void take_poses(LoadedLog& loaded, const std::vector<std::optional<Pose2>>& poses) {
  ScanLog kept;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i]) { continue; }
    kept.scans.push_back(std::move(loaded.log.scans[i]));
    kept.map_from_robot.push_back(*poses[i]);
  }
  loaded.log = std::move(kept);
  const bool has_odometry =
      loaded.report.poses == PoseSource::odometry || loaded.report.poses == PoseSource::corrected_and_odometry;
  loaded.report.poses = has_odometry ? PoseSource::corrected_and_odometry : PoseSource::corrected;
}

}  // namespace

LoadedLog read_posed_log(const std::string& path, const std::string& poses, const Session& session) {
  LoadedLog loaded = value_or_quit(read_log(path, {}, progress_bar(session, "reading")));
  if (!poses.empty()) {
    const std::size_t scans = loaded.log.scans.size();
    take_poses(loaded, poses_of_scans(loaded.log, value_or_quit(read_trajectory(poses))));
    if (loaded.log.scans.empty()) {
      throw BadInput(poses + ": expected poses with stamps of scans of " + path + ", found none");
    }
    if (session.talks() && loaded.log.scans.size() < scans) {
      fmt::print("{} of {} scans have a pose in {}\n", loaded.log.scans.size(), scans, poses);
    }
  }
  if (loaded.log.map_from_robot.empty()) {
    throw BadInput(path + ": expected a log with poses, found none (flirt slam finds them, --poses takes them)");
  }
  return loaded;
}

}  // namespace flirt::app
