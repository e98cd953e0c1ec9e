#include "flirt/slam/flirt_constraints.hpp"

#include "flirt/graph/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace flirt {

/// What keypoints alone allow, best first.
std::vector<FlirtConstraints::Candidate> FlirtConstraints::candidates(std::span<const SlamScan> scans) {
  const auto node = static_cast<std::uint32_t>(scans.size() - 1);
  const std::uint32_t oldest = params_.window > 0 && node > params_.window ? node - params_.window : 0;
  std::vector<Candidate> found;
  matcher_.set_query(scans[node]);
  for (std::uint32_t earlier = oldest; earlier + 1 < node; ++earlier) {
    const std::optional<ConstraintMatch> match = matcher_.match(scans[earlier]);
    if (match) { found.push_back({earlier, *match}); }
  }
  std::ranges::stable_sort(found, [](const Candidate& a, const Candidate& b) { return is_better(a.match, b.match); });
  return found;
}

bool FlirtConstraints::is_loop(std::uint32_t earlier, std::uint32_t node) const {
  return node - earlier >= params_.loop_min_scans && travel_[node] - travel_[earlier] >= params_.loop_min_travel;
}

std::vector<Closure> FlirtConstraints::add(std::span<const SlamScan> scans, const PoseGraph& graph,
                                           MotionSource motion) {
  const auto node = static_cast<std::uint32_t>(scans.size() - 1);
  const std::vector<Pose2>& poses = graph.map_from_node;
  travel_.push_back(node == 0 ? 0 : travel_.back() + distance(poses[node - 1], poses[node]));
  std::vector<Closure> closures;
  std::optional<ShortestPaths> paths;
  std::size_t taken = motion == MotionSource::narrow ? 1 : 0;
  for (const Candidate& candidate : candidates(scans)) {
    if (taken == params_.flirt.best_constraints) { break; }
    const SlamScan& earlier = scans[candidate.node];
    const ConstraintMatch match = matcher_.refined(earlier, candidate.match);
    const EdgeKind kind = is_loop(candidate.node, node) ? EdgeKind::loop : EdgeKind::motion;
    const PoseEdge edge{candidate.node, node, match.earlier_from_robot, match.information, kind};
    if (params_.flirt.gate == FlirtGate::shortest_path) {
      if (!paths) { paths.emplace(graph, node); }
      if (!passes_gate(*paths, edge, {params_.flirt.gate_limit})) { continue; }
    }
    if (!matcher_.verified(earlier, match)) { continue; }  // last, as it takes longest
    ++taken;
    const Pose2 off = inverse(poses[node]) * poses[candidate.node] * match.earlier_from_robot;
    closures.push_back({{edge}, norm(off.translation()), std::abs(off.theta)});
  }
  return closures;
}

}  // namespace flirt
