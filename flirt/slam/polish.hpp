// flirt/slam/polish.hpp: all scans drawn onto each other at once.
#pragma once

#include "flirt/graph/pose_graph.hpp"
#include "flirt/registration/surface_points.hpp"
#include "flirt/slam/slam_params.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace flirt {

/// How well pairs fit: root mean square of the distances of points from lines of the other scan, m.
struct PolishSummary {
  std::size_t pairs{0};
  double residual{0};
  std::vector<double> fit{};  ///< per scan: robust share of its points that agree with its best partner, 0..1
};

/// Rounds of: each pair's point-to-line terms at the present poses, as one edge; least squares over all of them and the
/// edges that were there, by `polish_keep` (Borrmann and others 2008, with lines).
PolishSummary polish(PoseGraph& graph, std::span<const SurfacePoints> scans, const SlamParams& params);

}  // namespace flirt
