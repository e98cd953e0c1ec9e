// flirt/graph/tail.hpp: the newest poses of a growing graph, optimized with the older ones held.
#pragma once

#include "flirt/graph/optimize.hpp"
#include "flirt/graph/pose_graph.hpp"

#include <cstdint>

namespace flirt {

/// As `optimize`, but nodes before `first_free` keep their poses: work goes with what is new, not with all that was
/// ever mapped. `params.fixed_node` plays no role; `rejected` is left empty. With `first_free` ≤ 1 it is `optimize`
/// itself. O(edges) to pick those of the tail, then as `optimize` for these.
OptimizeSummary optimize_tail(PoseGraph& graph, std::uint32_t first_free, const OptimizeParams& params = {});

}  // namespace flirt
