// flirt/slam/repair.hpp: single scans that ended up in a wrong place, put where the rest of the map wants them.
#pragma once

#include "flirt/graph/pose_graph.hpp"
#include "flirt/slam/slam_params.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace flirt {

/// Each suspect is searched for in the map of the scans around it, itself left out. Where that gains clearly, the scan
/// moves there, and edges to its neighbours replace all edges it had. The number of scans moved. O(suspects · scans).
std::size_t repair(PoseGraph& graph, std::span<const SlamScan> scans, std::span<const std::uint32_t> suspects,
                   const SlamParams& params);

}  // namespace flirt
