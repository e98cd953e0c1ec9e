// flirt/graph/consistency.hpp: loop edges that agree with the graph, and with each other.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/graph/pose_graph.hpp"

#include <Eigen/Core>

#include <concepts>
#include <cstdint>
#include <optional>
#include <vector>

namespace flirt {

/// A relative pose with the covariance of its error, which is stated in frame b as that of an edge is.
struct RelativePose {
  Pose2 a_from_b{};
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};  ///< m², m·rad, rad²
};

/// a_from_c out of a_from_b and b_from_c with independent errors, to first order.
[[nodiscard]] RelativePose operator*(const RelativePose& a_from_b, const RelativePose& b_from_c);
/// b_from_a with the covariance stated in frame a.
[[nodiscard]] RelativePose inverse(const RelativePose& a_from_b);
/// errorᵀ covariance⁻¹ error of two independent measurements of one relative pose; χ²₃ when both are right.
[[nodiscard]] double squared_mahalanobis(const RelativePose& one, const RelativePose& other);

/// The measurement of an edge, or nothing when its information does not bind all of (x, y, theta).
[[nodiscard]] std::optional<RelativePose> relative_pose(const PoseEdge& edge);

/// The paths of edges from all nodes to one, with the smallest sums of covariance traces (Dijkstra, P1 §3.2). Made in
/// O(edges log edges); the graph must outlive it unchanged.
class ShortestPaths {
 public:
  ShortestPaths(const PoseGraph& graph, std::uint32_t target);

  [[nodiscard]] std::uint32_t target() const { return target_; }
  /// The target as seen from `node`, covariances propagated along the path. Nothing when there is no path. O(its
  /// length).
  [[nodiscard]] std::optional<RelativePose> from(std::uint32_t node) const;

 private:
  const PoseGraph& graph_;
  std::uint32_t target_;
  std::vector<std::uint32_t> next_edge_;  ///< per node: the first edge of its path
};

struct GateParams {
  double limit{7.815};  ///< squared Mahalanobis distance: χ²₃ at 0.95
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, GateParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.limit, Field{"limit", "1", "largest squared Mahalanobis distance from the shortest path", 0.0, 1e9});
}

/// The papers' gate for symmetric places: false when the shortest path between the nodes of an edge that is not yet in
/// the graph contradicts it, by squared Mahalanobis distance. Where the graph does not connect them, or the edge leaves
/// a direction open, there is nothing to contradict.
[[nodiscard]] bool passes_gate(const ShortestPaths& to_b, const PoseEdge& edge, const GateParams& params = {});

struct ConsistencyParams {
  double limit{11.345};                 ///< squared Mahalanobis distance of two loops' cycle: χ²₃ at 0.99
  std::uint32_t exact_limit{300};       ///< up to so many loops the largest set is searched exactly, else by greed
  std::uint64_t most_branches{100000};  ///< of the exact search; then the best found counts
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, ConsistencyParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.limit, Field{"limit", "1", "largest squared Mahalanobis distance of a cycle of two loops", 0.0, 1e9});
  visit(params.exact_limit, Field{"exact_limit", "", "loops up to which the largest set is searched exactly"});
  visit(params.most_branches, Field{"most_branches", "", "of the exact search for the largest consistent set"});
}

/// Indices of the loop edges in the largest set in which every two agree: the cycle through both and the motion edges
/// between their ends closes (pairwise consistent measurements, Mangelson et al. 2018). Loops that leave a direction
/// open, or whose nodes no motion connects, are in no set. Motion is followed from each node to its predecessor of
/// highest index, so that paths are the robot's way. O(loops²) cycles.
[[nodiscard]] std::vector<std::uint32_t> consistent_loops(const PoseGraph& graph, const ConsistencyParams& params = {});

}  // namespace flirt
