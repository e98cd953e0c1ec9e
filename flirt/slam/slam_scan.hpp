// flirt/slam/slam_scan.hpp: what mapping keeps of a scan.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/features/features.hpp"
#include "flirt/graph/edge_error.hpp"
#include "flirt/match/columns.hpp"
#include "flirt/match/distance.hpp"
#include "flirt/registration/evidence_score.hpp"
#include "flirt/registration/local_map.hpp"
#include "flirt/registration/surface_points.hpp"

#include <Eigen/LU>

#include <optional>

namespace flirt {

struct SlamScan {
  SurfacePoints points{};
  std::optional<Pose2> odom_from_robot{};  ///< finite where it is there
  Scan scan{};                             ///< as it came
  Features features{};                     ///< where the front-end uses keypoints; else empty
  KeypointTable keypoints{};               ///< of the features, as matching wants them

  [[nodiscard]] FeatureColumns columns() const { return {keypoints.columns(), rows_of(features.descriptors)}; }
};

/// How a scan agrees with a map, in one number: weighted as in localization.
[[nodiscard]] inline double score_of(const Agreed& agreed) {
  return weighted(agreed, EvidenceScoreParams{}.fit);
}

/// What the terms of an alignment are worth as information of an edge: residuals deviate by `range_sigma`, and what
/// many points have in common (calibration, walls that are not straight) is never known better than 5 mm and 0.1°.
[[nodiscard]] inline Eigen::Matrix3d edge_information(const Eigen::Matrix3d& terms, double range_sigma,
                                                      const Eigen::Matrix3d& least) {
  const Eigen::Vector3d common(2.5e-5, 2.5e-5, 3e-6);
  const Eigen::Matrix3d information = terms / (range_sigma * range_sigma) + least;
  const Eigen::Matrix3d covariance = information.inverse() + Eigen::Matrix3d(common.asDiagonal());
  return covariance.inverse();
}

/// The covariance of a motion between sensors, whose errors stand in the reference's frame, as information of an edge
/// between the robots, whose errors stand in the later robot's frame.
[[nodiscard]] inline Eigen::Matrix3d robot_information(const Eigen::Matrix3d& covariance,
                                                       const Pose2& reference_from_query,
                                                       const Pose2& robot_from_sensor) {
  const Eigen::Matrix3d turn = adjoint(Pose2{0, 0, -reference_from_query.theta});
  const Eigen::Matrix3d to_robot = adjoint(robot_from_sensor) * turn;
  const Eigen::Matrix3d in_robot = to_robot * covariance * to_robot.transpose();
  return in_robot.inverse();
}

}  // namespace flirt
