// flirt/registration/surface_alignment.hpp: points drawn onto lines, as normal equations in the frame of the robot.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/registration/local_map.hpp"
#include "flirt/registration/surface_points.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <span>

namespace flirt {

/// Σ w JᵀJ and Σ w Jᵀr of residuals (distances of points from lines) over a motion of the robot in its own frame: the
/// pose after a step is pose * (x, y, theta).
struct AlignmentTerms {
  Eigen::Matrix3d information{Eigen::Matrix3d::Zero()};  ///< 1, m, m²
  Eigen::Vector3d gradient{Eigen::Vector3d::Zero()};     ///< m, m²
  double weight{0};                                      ///< sum of the robust weights
  double squared_residuals{0};                           ///< m², of the points with a line, weighted
  std::size_t pairs{0};                                  ///< points that found a line

  AlignmentTerms& operator+=(const AlignmentTerms& other);
};

/// The terms of a scan in a map. Weights are 1 / (1 + r² / width²)² (Geman and McClure). O(points).
[[nodiscard]] AlignmentTerms alignment_terms(const LocalMap& map, const SurfacePoints& points,
                                             const Pose2& map_from_robot, double width);

/// The terms of a scan against one other scan: each point with the nearest point of `reference` that looks the same
/// way, found by its bearing from the reference's sensor. The step moves the query. O(points).
[[nodiscard]] AlignmentTerms alignment_terms(const SurfacePoints& reference, const SurfacePoints& query,
                                             const Pose2& reference_from_query, double width);

/// The pose after the step (x, y, theta) in its own frame.
[[nodiscard]] inline Pose2 stepped(const Pose2& pose, const Eigen::Vector3d& step) {
  return pose * Pose2{step.x(), step.y(), step.z()};
}

/// A wish to stay at a pose: `information` about it, in the frame of the robot.
struct AlignmentPrior {
  Pose2 map_from_robot{};
  Eigen::Matrix3d information{Eigen::Matrix3d::Identity()};  ///< in the units of AlignmentTerms::information
};

struct AlignedPose {
  Pose2 map_from_robot{};
  AlignmentTerms terms{};  ///< at the pose, without the prior
};

struct AlignParams {
  int iterations{10};
  double start_width{0.2};  ///< m
  double end_width{0.06};   ///< m
};

/// Iterated from `start` with shrinking width. O(iterations · points).
[[nodiscard]] AlignedPose align_to_map(const LocalMap& map, std::span<const SurfacePoints> scans, const Pose2& start,
                                       const AlignmentPrior& prior, const AlignParams& params = {});

/// The same of a scan onto one other: `map_from_robot` of prior and answer are reference_from_query. O(iterations ·
/// points).
[[nodiscard]] AlignedPose align_to_scan(const SurfacePoints& reference, const SurfacePoints& query, const Pose2& start,
                                        const AlignmentPrior& prior, const AlignParams& params = {});

}  // namespace flirt
