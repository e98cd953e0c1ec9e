// flirt/slam/gauss_newton.hpp: a few steps of sparse least squares over a pose graph, from a good start.
#pragma once

#include "flirt/graph/pose_graph.hpp"

#include <cstddef>

namespace flirt {

/// Largest change of any pose in the last step.
struct GaussNewtonSummary {
  double translation{0};  ///< m
  double rotation{0};     ///< rad
};

/// At most `steps` steps, fewer when they get small; node 0 stays. Loop edges are weighted by 1 / (1 + e / 9)², e their
/// squared error in the units of their information. O(edges + fill-in) a step.
GaussNewtonSummary gauss_newton(PoseGraph& graph, std::size_t steps);

}  // namespace flirt
