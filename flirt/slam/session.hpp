// flirt/slam/session.hpp: a run of its own found in the map of an earlier one, without any guess where it began.
#pragma once

#include "flirt/graph/pose_graph.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace flirt {

/// How an earlier map and a run were joined.
struct SessionJoin {
  std::size_t queries{0};   ///< scans of the run that were looked for in the map
  std::size_t found{0};     ///< of them, those found at one place
  std::size_t agreeing{0};  ///< of them, those that agree on where the run is; 0: the run was not found
};

/// Scans and graph of a run; scan i belongs to node i.
struct SessionView {
  std::span<const SlamScan> scans;
  const PoseGraph& graph;
};

/// Where the run lies in the earlier map, and edges that say so.
struct SessionPlace {
  SessionJoin summary{};
  Pose2 earlier_from_run{};       ///< between the frames of the two maps
  std::vector<PoseEdge> edges{};  ///< a: node of the earlier map, b: node of the run
};

/// Scans of the run, one each `query_travel`, are localized in the earlier map. The largest set of places that agree
/// with the run's own motion decides; fewer than `least_agreeing`, and it is not found. O(queries · cells of the map).
[[nodiscard]] SessionPlace find_session(const SessionView& earlier, const SessionView& run);

}  // namespace flirt
