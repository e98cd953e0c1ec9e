#include "flirt/graph/tail.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/graph/edge_error.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cstddef>

namespace flirt {
namespace {

/// The edge with its ends exchanged. Its error there is −adjoint(a_from_b) · the error here, to first order.
PoseEdge reversed(const PoseEdge& edge) {
  const Eigen::Matrix3d b_from_a = adjoint(inverse(edge.a_from_b));
  return {edge.b, edge.a, inverse(edge.a_from_b), b_from_a.transpose() * edge.information * b_from_a, edge.kind};
}

/// Node 0 is the frame of the map, and stands for all that is held: an edge from a held node is one from there.
PoseGraph tail_of(const PoseGraph& graph, std::uint32_t first_free) {
  PoseGraph tail;
  tail.map_from_node.push_back({});
  tail.map_from_node.insert(tail.map_from_node.end(), graph.map_from_node.begin() + first_free,
                            graph.map_from_node.end());
  for (const PoseEdge& given : graph.edges) {
    if (std::max(given.a, given.b) < first_free) { continue; }
    PoseEdge edge = given.b < first_free ? reversed(given) : given;
    if (edge.a < first_free) {
      edge.a_from_b = graph.map_from_node[edge.a] * edge.a_from_b;
      edge.a = 0;
    } else {
      edge.a -= first_free - 1;
    }
    edge.b -= first_free - 1;
    tail.edges.push_back(edge);
  }
  return tail;
}

}  // namespace

OptimizeSummary optimize_tail(PoseGraph& graph, std::uint32_t first_free, const OptimizeParams& params) {
  FLIRT_ASSERT(first_free < graph.map_from_node.size());
  OptimizeParams whole = params;
  whole.fixed_node = 0;
  if (first_free <= 1) { return optimize(graph, whole); }
  PoseGraph tail = tail_of(graph, first_free);
  OptimizeSummary summary = optimize(tail, whole);
  summary.rejected.clear();
  std::copy(tail.map_from_node.begin() + 1, tail.map_from_node.end(), graph.map_from_node.begin() + first_free);
  return summary;
}

}  // namespace flirt
