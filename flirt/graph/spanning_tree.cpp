#include "flirt/graph/spanning_tree.hpp"

#include "flirt/core/assert.hpp"

#include <functional>
#include <queue>
#include <tuple>

namespace flirt {
namespace {

struct Neighbour {
  std::uint32_t node;
  std::uint32_t edge;
};

std::vector<std::vector<Neighbour>> neighbours(const PoseGraph& graph, TreeEdges edges) {
  std::vector<std::vector<Neighbour>> lists(graph.map_from_node.size());
  for (std::uint32_t k = 0; k < graph.edges.size(); ++k) {
    const PoseEdge& edge = graph.edges[k];
    if (edge.a == edge.b || (edges == TreeEdges::motion && edge.kind != EdgeKind::motion)) { continue; }
    lists[edge.a].push_back({edge.b, k});
    lists[edge.b].push_back({edge.a, k});
  }
  return lists;
}

/// Reaches the part of the graph that hangs together with `root`.
void grow(const std::vector<std::vector<Neighbour>>& lists, std::uint32_t root, SpanningTree& tree,
          std::vector<bool>& reached) {
  using Candidate = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  // parent, node, edge
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
  const auto take = [&](std::uint32_t node) {
    reached[node] = true;
    tree.order.push_back(node);
    for (const Neighbour& other : lists[node]) {
      if (!reached[other.node]) { candidates.emplace(node, other.node, other.edge); }
    }
  };
  take(root);
  while (!candidates.empty()) {
    const auto [parent, node, edge] = candidates.top();
    candidates.pop();
    if (reached[node]) { continue; }
    tree.parent[node] = parent;
    tree.parent_edge[node] = edge;
    tree.level[node] = tree.level[parent] + 1;
    take(node);
  }
}

}  // namespace

SpanningTree spanning_tree(const PoseGraph& graph, std::uint32_t root, TreeEdges edges) {
  const std::size_t n = graph.map_from_node.size();
  SpanningTree tree{std::vector(n, no_node), std::vector(n, no_node), std::vector(n, std::uint32_t{0}), {}};
  if (n == 0) { return tree; }
  FLIRT_ASSERT(root < n);
  const auto lists = neighbours(graph, edges);
  std::vector<bool> reached(n, false);
  grow(lists, root, tree, reached);
  for (std::uint32_t node = 0; node < n; ++node) {
    if (!reached[node]) { grow(lists, node, tree, reached); }
  }
  return tree;
}

void chain_motion(PoseGraph& graph, std::uint32_t root) {
  const SpanningTree tree = spanning_tree(graph, root, TreeEdges::motion);
  for (const std::uint32_t node : tree.order) {
    if (tree.parent[node] == no_node) { continue; }
    const PoseEdge& edge = graph.edges[tree.parent_edge[node]];
    const Pose2 parent_from_node = edge.b == node ? edge.a_from_b : inverse(edge.a_from_b);
    graph.map_from_node[node] = graph.map_from_node[tree.parent[node]] * parent_from_node;
  }
}

}  // namespace flirt
