// flirt/slam/closure.hpp: what closing loops gives the graph.
#pragma once

#include "flirt/graph/pose_graph.hpp"

#include <cstdint>
#include <vector>

namespace flirt {

/// How an earlier visit was found.
enum class ClosureSource : std::uint8_t {
  near,      ///< in a window around the pose in the graph, or by keypoints
  anywhere,  ///< by a search of the whole map
};

/// An earlier visit found: edges to earlier scans, and how far the graph was off.
struct Closure {
  std::vector<PoseEdge> edges{};
  double translation{0};  ///< m, between the pose in the graph and the one found
  double rotation{0};     ///< rad
  ClosureSource source{ClosureSource::near};
};

}  // namespace flirt
