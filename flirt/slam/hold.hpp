// flirt/slam/hold.hpp: how well a scan's surfaces hold it in place.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/registration/local_map.hpp"
#include "flirt/registration/surface_points.hpp"
#include "flirt/slam/slam_params.hpp"

#include <Eigen/Core>

#include <span>

namespace flirt {

struct Hold {
  double weakest{0};       ///< least information about a direction of translation, heading being free, a point; 0..1
  Point2 direction{1, 0};  ///< that direction, frame of the robot
  double lead{0};          ///< score by which the pose leads over those 0.3 m aside along it, grazed walls left out
  bool doubted{false};     ///< more of what tells about that direction contradicts the map than agrees with it
};

/// By the points' own normals alone: lone points far down a corridor agree with the map wherever they are. O(points).
[[nodiscard]] Hold hold_of(const SurfacePoints& points);

/// Without the surfaces that stand where beams passed before: people walk about.
[[nodiscard]] Hold hold_of(std::span<const SurfacePoints> scans, const LocalMap& map, const Pose2& map_from_robot);

/// Whether a scan is held at its pose in a map: by its surfaces, or because no pose aside along the weakest direction
/// agrees nearly as well: few surfaces then do so for sure (the end of a long corridor).
[[nodiscard]] bool holds(const Hold& hold, const SlamParams& params);

/// 1/m, of a pose along the direction of `hold`, by its lead: the surfaces themselves claim more than they know, since
/// a corridor's few corners are seen by few beams, now here and now there.
[[nodiscard]] double inverse_deviation(const Hold& hold, const SlamParams& params);

/// Takes back what is claimed to be known of a pose along a direction beyond `information`. False when it is not more.
bool know_at_most(double information, Point2 direction, Eigen::Matrix3d& known);

}  // namespace flirt
