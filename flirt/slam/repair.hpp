// flirt/slam/repair.hpp: single scans that ended up in a wrong place, put where the rest of the map wants them.
#pragma once

#include "flirt/graph/pose_graph.hpp"
#include "flirt/slam/slam_params.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// Each suspect is searched for in the map of the scans around it, itself left out. Where that gains clearly, the scan
/// moves there, and edges to its neighbours replace all edges it had. The scans moved. O(suspects · scans).
std::vector<std::uint32_t> repair(PoseGraph& graph, std::span<const SlamScan> scans,
                                  std::span<const std::uint32_t> suspects, const SlamParams& params);

}  // namespace flirt
