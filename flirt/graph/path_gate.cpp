// The papers' gate: shortest paths by covariance, and the Mahalanobis distance from them.
#include "flirt/core/assert.hpp"
#include "flirt/graph/consistency.hpp"

#include <functional>
#include <limits>
#include <queue>
#include <tuple>

namespace flirt {
namespace {

constexpr std::uint32_t no_edge = std::numeric_limits<std::uint32_t>::max();

struct Step {
  std::uint32_t to;
  std::uint32_t edge;
  double cost;  ///< trace of the edge's covariance
};

std::vector<std::vector<Step>> steps(const PoseGraph& graph) {
  std::vector<std::vector<Step>> from(graph.map_from_node.size());
  for (std::uint32_t k = 0; k < graph.edges.size(); ++k) {
    const PoseEdge& edge = graph.edges[k];
    const auto measured = relative_pose(edge);
    if (!measured || edge.a == edge.b) { continue; }
    const double cost = measured->covariance.trace();
    from[edge.a].push_back({edge.b, k, cost});
    from[edge.b].push_back({edge.a, k, cost});
  }
  return from;
}

}  // namespace

ShortestPaths::ShortestPaths(const PoseGraph& graph, std::uint32_t target)
    : graph_(graph), target_(target), next_edge_(graph.map_from_node.size(), no_edge) {
  FLIRT_ASSERT(target < graph.map_from_node.size());
  const auto from = steps(graph);
  std::vector<double> cost(from.size(), std::numeric_limits<double>::infinity());
  using Candidate = std::tuple<double, std::uint32_t>;  // cost, node
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> open;
  cost[target] = 0;
  open.emplace(0.0, target);
  while (!open.empty()) {
    const auto [cost_here, here] = open.top();
    open.pop();
    if (cost_here > cost[here]) { continue; }
    for (const Step& step : from[here]) {
      if (cost_here + step.cost >= cost[step.to]) { continue; }
      cost[step.to] = cost_here + step.cost;
      next_edge_[step.to] = step.edge;
      open.emplace(cost[step.to], step.to);
    }
  }
}

std::optional<RelativePose> ShortestPaths::from(std::uint32_t node) const {
  FLIRT_ASSERT(node < next_edge_.size());
  RelativePose node_from_here;
  for (std::uint32_t here = node; here != target_;) {
    if (next_edge_[here] == no_edge) { return std::nullopt; }
    const PoseEdge& edge = graph_.edges[next_edge_[here]];
    const RelativePose measured = *relative_pose(edge);
    node_from_here = node_from_here * (edge.a == here ? measured : inverse(measured));
    here = edge.a == here ? edge.b : edge.a;
  }
  return node_from_here;
}

bool passes_gate(const ShortestPaths& to_b, const PoseEdge& edge, const GateParams& params) {
  FLIRT_ASSERT(edge.b == to_b.target());
  const auto measured = relative_pose(edge);
  if (!measured) { return true; }
  const auto path = to_b.from(edge.a);
  return !path || squared_mahalanobis(*measured, *path) <= params.limit;
}

}  // namespace flirt
