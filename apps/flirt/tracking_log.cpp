#include "apps/flirt/tracking_log.hpp"

#include "flirt/io/log.hpp"
#include "flirt/sim/odometry.hpp"

#include <algorithm>
#include <vector>

namespace flirt::app {

ScanLog log_to_track(const std::string& path, const Session& session) {
  const LoadedLog loaded = value_or_quit(read_log(path, {}, progress_bar(session, "reading")));
  ScanLog log = loaded.log;
  if (loaded.report.poses == PoseSource::none || loaded.report.poses == PoseSource::odometry) {
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
