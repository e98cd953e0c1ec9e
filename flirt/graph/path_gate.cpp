// The papers' gate: shortest path by covariance, and the Mahalanobis distance from it.
#include "flirt/core/assert.hpp"
#include "flirt/graph/consistency.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

namespace flirt {
namespace {

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

/// The edges of the cheapest path from a to b in order; nothing when there is none.
std::optional<std::vector<std::uint32_t>> cheapest_path(const PoseGraph& graph, std::uint32_t a, std::uint32_t b) {
  const auto from = steps(graph);
  const std::size_t n = graph.map_from_node.size();
  std::vector<double> cost(n, std::numeric_limits<double>::infinity());
  std::vector<std::uint32_t> last_edge(n, 0);
  using Candidate = std::tuple<double, std::uint32_t>;  // cost, node
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> open;
  cost[a] = 0;
  open.emplace(0.0, a);
  while (!open.empty() && std::get<1>(open.top()) != b) {
    const auto [cost_here, here] = open.top();
    open.pop();
    if (cost_here > cost[here]) { continue; }
    for (const Step& step : from[here]) {
      if (cost_here + step.cost >= cost[step.to]) { continue; }
      cost[step.to] = cost_here + step.cost;
      last_edge[step.to] = step.edge;
      open.emplace(cost[step.to], step.to);
    }
  }
  if (open.empty()) { return std::nullopt; }
  std::vector<std::uint32_t> path;
  for (std::uint32_t node = b; node != a;) {
    const PoseEdge& edge = graph.edges[last_edge[node]];
    path.push_back(last_edge[node]);
    node = edge.b == node ? edge.a : edge.b;
  }
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace

std::optional<RelativePose> shortest_path(const PoseGraph& graph, std::uint32_t a, std::uint32_t b) {
  FLIRT_ASSERT(a < graph.map_from_node.size() && b < graph.map_from_node.size());
  const auto path = cheapest_path(graph, a, b);
  if (!path) { return std::nullopt; }
  RelativePose a_from_here;
  std::uint32_t here = a;
  for (const std::uint32_t k : *path) {
    const PoseEdge& edge = graph.edges[k];
    const RelativePose measured = *relative_pose(edge);
    a_from_here = a_from_here * (edge.a == here ? measured : inverse(measured));
    here = edge.a == here ? edge.b : edge.a;
  }
  return a_from_here;
}

std::optional<double> distance_from_path(const PoseGraph& graph, const PoseEdge& edge) {
  const auto measured = relative_pose(edge);
  if (!measured) { return std::nullopt; }
  const auto path = shortest_path(graph, edge.a, edge.b);
  if (!path) { return std::nullopt; }
  return squared_mahalanobis(*measured, *path);
}

bool passes_gate(const PoseGraph& graph, const PoseEdge& edge, const GateParams& params) {
  const auto distance = distance_from_path(graph, edge);
  return !distance || *distance <= params.limit;
}

}  // namespace flirt
