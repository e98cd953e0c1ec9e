// flirt/slam/polish.hpp: all scans drawn onto each other at once.
#pragma once

#include "flirt/graph/pose_graph.hpp"
#include "flirt/slam/slam_params.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// Two scans that see the same walls.
struct ScanPair {
  std::uint32_t a{0};
  std::uint32_t b{0};  ///< a < b
};

/// For each scan the two before it and up to `most` others that were taken near it and looked the same way, spread over
/// different visits. O(scans · scans nearby).
[[nodiscard]] std::vector<ScanPair> overlapping_pairs(std::span<const Pose2> map_from_node, std::size_t most);

/// How well pairs fit: root mean square of the distances of points from lines of the other scan, m.
struct PolishSummary {
  std::size_t pairs{0};
  double residual{0};
  std::vector<double> fit{};  ///< per scan: robust share of its points that agree with its best partner, 0..1
};

/// Rounds of: each pair's point-to-line terms at the present poses, as one edge; least squares over all of them and the
/// motion edges of scans that found no partner (Borrmann and others 2008, with lines). Loop edges are replaced by the
/// pairs.
PolishSummary polish(PoseGraph& graph, std::span<const SlamScan> scans, const SlamParams& params);

}  // namespace flirt
