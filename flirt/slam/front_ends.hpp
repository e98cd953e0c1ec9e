// flirt/slam/front_ends.hpp: the front-ends by name, and what goes with each: the way loops are found, and how a map
// ends.
#pragma once

#include "flirt/slam/flirt_constraints.hpp"
#include "flirt/slam/flirt_front_end.hpp"
#include "flirt/slam/loop_closer.hpp"
#include "flirt/slam/pair_front_end.hpp"
#include "flirt/slam/scan_front_end.hpp"
#include "flirt/slam/slam_params.hpp"

#include <variant>

namespace flirt {

using FrontEnd = std::variant<ScanFrontEnd, FlirtFrontEnd, PairFrontEnd>;
[[nodiscard]] FrontEnd make_front_end(const SlamParams& params);

/// Each has `std::vector<Closure> add(scans, graph)`.
using LoopFinder = std::variant<LoopCloser, FlirtConstraints>;
[[nodiscard]] LoopFinder make_loop_finder(const SlamParams& params);

/// Whether it needs the keypoints of every scan. `automatic` extracts those of the few that it is in doubt about.
[[nodiscard]] inline bool needs_keypoints(FrontEndKind kind) {
  return kind == FrontEndKind::flirt;
}
/// Whether all scans are aligned jointly at the end. The methods of others end with the optimized graph, as published.
[[nodiscard]] inline bool is_polished(FrontEndKind kind) {
  return kind == FrontEndKind::scan || kind == FrontEndKind::automatic;
}

}  // namespace flirt
