// flirt/core/scan.hpp: one sweep of a 2D laser scanner, and a log of them.
#pragma once

#include "flirt/core/pose2.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace flirt {

/// Geometry shared by all beams of a scan. Beam i points to angle_min + i · angle_step in the sensor frame; a negative
/// step is a scanner that turns clockwise. Fields of view up to a full turn.
struct Beams {
  double angle_min{0};   ///< rad, direction of beam 0
  double angle_step{0};  ///< rad, from one beam to the next; negative: clockwise
  double range_min{0};   ///< m, shorter readings are invalid
  double range_max{0};   ///< m, readings of this length or more are "no return"

  [[nodiscard]] double angle(std::size_t i) const { return angle_min + static_cast<double>(i) * angle_step; }
  friend bool operator==(const Beams&, const Beams&) = default;
};

/// What one reading says.
enum class Reading : std::uint8_t {
  hit,        ///< the beam ended on something: [range_min, range_max), finite, positive
  no_return,  ///< nothing within range: 0, +inf, or ≥ range_max; the beam's path may be taken as free
  invalid,    ///< says nothing: NaN, negative, −inf, or in (0, range_min)
};

[[nodiscard]] Reading classify(double range, const Beams& beams);

/// One sweep. `ranges` are as the sensor gave them, in beam order; use `classify` before use.
/// Ranges are double so that text logs are represented without rounding.
struct Scan {
  double stamp{0};  ///< s, as logged; may repeat, run backwards, or be meaningless: order in the log is what counts
  Beams beams{};
  std::vector<double> ranges{};            ///< m
  Pose2 robot_from_sensor{};               ///< where the scanner sits on the robot
  std::optional<Pose2> odom_from_robot{};  ///< the robot's own dead reckoning, where it has one
};

/// True when the first and the last beam are neighbours: the field of view is a full turn (within half a step).
[[nodiscard]] bool is_full_turn(const Scan& scan);

/// An end point with the beam it came from.
struct BeamPoint {
  Point2 point;        ///< m, sensor frame
  std::uint32_t beam;  ///< index into Scan::ranges
};
/// End points of all hits in order of increasing angle (beam order reversed when the step is negative), sensor frame.
[[nodiscard]] std::vector<BeamPoint> hit_points(const Scan& scan);

/// A recorded run. `map_from_robot` is the pose that the log itself states for each scan (corrected by SLAM if the log
/// was): kept apart from the scans, because what is under test sees scans, never their poses.
struct ScanLog {
  std::vector<Scan> scans{};
  std::vector<Pose2> map_from_robot{};  ///< one per scan; empty when the log has no poses

  [[nodiscard]] Pose2 map_from_sensor(std::size_t i) const { return map_from_robot[i] * scans[i].robot_from_sensor; }
};

}  // namespace flirt
