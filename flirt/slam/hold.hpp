// flirt/slam/hold.hpp: how well a scan's surfaces hold it in place.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/registration/surface_points.hpp"

namespace flirt {

struct Hold {
  double weakest{0};       ///< least information about a direction of translation, heading being free, a point; 0..1
  Point2 direction{1, 0};  ///< that direction, frame of the robot
};

/// By the points' own normals alone: lone points far down a corridor agree with the map wherever they are. O(points).
[[nodiscard]] Hold hold_of(const SurfacePoints& points);

}  // namespace flirt
