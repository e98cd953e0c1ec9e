// flirt/io/carmen_lines.hpp: single lines of CARMEN logs. Internal to flirt/io; use flirt/io/carmen.hpp.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/core/result.hpp"
#include "flirt/core/scan.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace flirt::carmen {

/// How a kind of scan line is laid out.
enum class Layout : std::uint8_t {
  flaser,      ///< n ranges… pose pose stamp host logger_stamp
  robotlaser,  ///< type start fov step max accuracy remission_mode n ranges… m remissions… laser robot 5 numbers stamp…
  rawlaser,    ///< the same without poses and the 5 numbers
};
/// The layout of a kind of scan lines, or nothing for other kinds.
[[nodiscard]] std::optional<Layout> layout_of(std::string_view kind);

/// A scan line as it stands. FLASER: `first_pose` x y theta, `second_pose` odom_x odom_y odom_theta; ROBOTLASER: those
/// of the laser and of the robot.
struct ScanLine {
  Beams beams{};  ///< range_max is 0 when the line does not declare one
  std::vector<double> ranges{};
  std::optional<Pose2> first_pose{};
  std::optional<Pose2> second_pose{};
  double stamp{0};
  int stamp_digits{0};  ///< significant digits as written
};
/// `text` is what follows the kind. Errors say what was expected and found, without a place.
[[nodiscard]] Result<ScanLine> parse_scan(std::string_view text, Layout layout);

struct StampedPose {
  double stamp{0};
  Pose2 pose{};
};
/// ODOM: x y theta translational_velocity rotational_velocity acceleration stamp host logger_stamp.
[[nodiscard]] Result<StampedPose> parse_odometry(std::string_view text);
/// TRUEPOS: true x y theta, odometry x y theta, stamp host logger_stamp; the true pose.
[[nodiscard]] Result<StampedPose> parse_true_pose(std::string_view text);

/// Beams of a scan of n readings whose line does not tell the angles; the rule is in flirt/io/carmen.hpp.
[[nodiscard]] Beams beams_without_angles(std::size_t n);

}  // namespace flirt::carmen
