// flirt/io/carmen_assembly.hpp: from the lines of a CARMEN log to scans with frames. Internal to flirt/io.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/io/carmen_lines.hpp"
#include "flirt/io/log.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace flirt::carmen {

/// What the lines of a log said, in file order; what it means is only known at its end.
struct Gathered {
  std::string kind{};  ///< of the scan lines that are read
  std::vector<ScanLine> scans{};
  std::vector<std::size_t> odometry_before{};     ///< per scan: ODOM lines before it
  std::vector<std::optional<Pose2>> true_pose{};  ///< per scan: of the last TRUEPOS line before it
  std::vector<StampedPose> odometry{};            ///< ODOM lines
  std::optional<Pose2> last_true_pose{};
  bool is_corrected{false};                 ///< VERTEX2 or NEFF lines: poses of scan lines come from SLAM
  std::optional<double> front_offset{};     ///< m, PARAM robot_frontlaser_offset
  std::optional<double> rear_offset{};      ///< m, PARAM robot_rearlaser_offset
  std::optional<double> front_range_max{};  ///< m, PARAM robot_front_laser_max
  std::optional<double> rear_range_max{};   ///< m, PARAM robot_rear_laser_max
};

/// The scans with their poses, laser mounting and longest range by the rules in flirt/io/carmen.hpp; fills the parts of
/// the report that tell about poses, ranges and stamps. O(readings).
[[nodiscard]] ScanLog assemble(Gathered gathered, std::optional<double> range_max, LogReport& report);

}  // namespace flirt::carmen
