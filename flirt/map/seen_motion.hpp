// flirt/map/seen_motion.hpp: how a robot without odometry moved, by the place near its last one where its scan fits.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/registration/map_fields.hpp"
#include "flirt/registration/scan_points.hpp"
#include "flirt/registration/search.hpp"

#include <optional>

namespace flirt {

/// How far a robot may have come from one scan to the next.
struct MotionReach {
  double distance{0.75};  ///< m
  double turn{0.6};       ///< rad
};

/// The robot's motion from `map_from_robot` to the pose within `reach` that explains the scan best; none when the scan
/// fits nowhere there. A dense search around the place, refinement, score. O(headings · places near · points).
[[nodiscard]] std::optional<Pose2> seen_motion(const MapFields& fields, const ScanPoints& points,
                                               const Pose2& map_from_robot, const Pose2& robot_from_sensor,
                                               const MotionReach& reach, const SearchParams& params = {});

}  // namespace flirt
