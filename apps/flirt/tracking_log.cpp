#include "apps/flirt/tracking_log.hpp"

#include "flirt/sim/odometry.hpp"

#include "apps/flirt/posed_log.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace flirt::app {

ScanLog log_to_track(const std::string& path, const Session& session, const std::string& poses) {
  LoadedLog loaded = read_posed_log(path, poses, session);
  ScanLog log = std::move(loaded.log);
  if (loaded.report.poses == PoseSource::odometry) {
    throw BadInput(path + ": expected a log with corrected poses (they are the truth), found none");
  }
  const bool has_odometry =
      std::ranges::all_of(log.scans, [](const Scan& scan) { return scan.odom_from_robot.has_value(); });
  if (!has_odometry) {
    const std::vector<Pose2> odometry = drifting_odometry(log.map_from_robot, {}, session.seed);
    for (std::size_t i = 0; i < log.scans.size(); ++i) { log.scans[i].odom_from_robot = odometry[i]; }
  }
  return log;
}

}  // namespace flirt::app
