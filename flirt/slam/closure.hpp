// flirt/slam/closure.hpp: what closing loops gives the graph.
#pragma once

#include "flirt/graph/pose_graph.hpp"

#include <vector>

namespace flirt {

/// An earlier visit found: edges to earlier scans, and how far the graph was off.
struct Closure {
  std::vector<PoseEdge> edges{};
  double translation{0};  ///< m, between the pose in the graph and the one found
  double rotation{0};     ///< rad
};

}  // namespace flirt
