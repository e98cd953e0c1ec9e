// flirt/graph/edge_error.hpp: how far two poses are from what was measured between them, and its derivatives.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/graph/pose_graph.hpp"

#include <Eigen/Core>

#include <span>

namespace flirt {

/// inverse(a_from_b) * inverse(map_from_a) * map_from_b as (x, y, theta): m, m, rad in (−π, π].
[[nodiscard]] Eigen::Vector3d edge_error(const PoseEdge& edge, const Pose2& map_from_a, const Pose2& map_from_b);

/// edge_error with its derivatives by (x, y, theta) of the two poses.
struct LinearizedEdge {
  Eigen::Vector3d error{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d by_a{Eigen::Matrix3d::Zero()};
  Eigen::Matrix3d by_b{Eigen::Matrix3d::Zero()};
};
[[nodiscard]] LinearizedEdge linearize(const PoseEdge& edge, const Pose2& map_from_a, const Pose2& map_from_b);

/// errorᵀ · information · error, the squared Mahalanobis distance of the poses from the measurement.
[[nodiscard]] double chi2(const PoseEdge& edge, std::span<const Pose2> map_from_node);

/// Σ chi2 over all edges. O(edges).
[[nodiscard]] double chi2(const PoseGraph& graph);

/// How an error of a pose, expressed in frame b, looks in frame a: the adjoint of a_from_b. A covariance in b is
/// adjoint · covariance · adjointᵀ in a, to first order.
[[nodiscard]] Eigen::Matrix3d adjoint(const Pose2& a_from_b);

}  // namespace flirt
