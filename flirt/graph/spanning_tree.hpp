// flirt/graph/spanning_tree.hpp: trees over the nodes of a pose graph.
#pragma once

#include "flirt/graph/pose_graph.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace flirt {

constexpr std::uint32_t no_node = std::numeric_limits<std::uint32_t>::max();

/// One tree per connected part of the graph.
struct SpanningTree {
  std::vector<std::uint32_t> parent{};       ///< per node; no_node for a root
  std::vector<std::uint32_t> parent_edge{};  ///< per node: index of the edge to its parent; no_node for a root
  std::vector<std::uint32_t> level{};        ///< per node: edges up to its root
  std::vector<std::uint32_t> order{};        ///< all nodes, parents before their children
};

enum class TreeEdges : std::uint8_t {
  all,     ///< every edge may be in the tree
  motion,  ///< only edges of kind motion
};

/// Hangs each node under its neighbour of lowest index that the tree reached before it (Grisetti, Stachniss and Burgard
/// 2009, §IV-B: paths in such a tree are short where the robot came back). The part of `root` hangs from it, every
/// other part from its node of lowest index. Edges of a node with itself are left out. O(edges log edges).
[[nodiscard]] SpanningTree spanning_tree(const PoseGraph& graph, std::uint32_t root = 0,
                                         TreeEdges edges = TreeEdges::all);

/// The poses that the motion edges alone give: each node where its tree of motion edges puts it, roots where they are.
/// O(edges log edges).
void chain_motion(PoseGraph& graph, std::uint32_t root = 0);

}  // namespace flirt
