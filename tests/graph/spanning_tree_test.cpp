#include "flirt/graph/spanning_tree.hpp"

#include "tests/graph/graphs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace flirt {
namespace {

using testing::ElementsAre;

PoseGraph connected(std::size_t nodes, std::initializer_list<std::pair<std::uint32_t, std::uint32_t>> pairs) {
  PoseGraph graph{.map_from_node = std::vector<Pose2>(nodes)};
  for (const auto& [a, b] : pairs) { graph.edges.push_back({.a = a, .b = b}); }
  return graph;
}

TEST(SpanningTree, HangsNodesFromTheirLowestNeighbour) {
  const SpanningTree tree = spanning_tree(connected(6, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 1}}));
  EXPECT_THAT(tree.parent, ElementsAre(no_node, 0, 1, 2, 3, 1));
  EXPECT_THAT(tree.level, ElementsAre(0, 1, 2, 3, 4, 2));
}

TEST(SpanningTree, GivesEveryPartOfTheGraphItsOwnRoot) {
  const SpanningTree tree = spanning_tree(connected(5, {{2, 0}, {4, 3}, {3, 3}}), 2);
  EXPECT_THAT(tree.parent, ElementsAre(2, no_node, no_node, no_node, 3));
  EXPECT_THAT(tree.order, ElementsAre(2, 0, 1, 3, 4));
}

TEST(ChainMotion, PutsNodesWhereTheirMotionEdgesSayAndIgnoresLoops) {
  KnownGraph known = rounds(2, {}, 0);
  for (PoseEdge& edge : known.graph.edges) {
    if (edge.kind == EdgeKind::loop) { edge.a_from_b = {100, 100, 1}; }
  }
  for (std::size_t i = 1; i < known.graph.map_from_node.size(); ++i) { known.graph.map_from_node[i] = {}; }
  chain_motion(known.graph);
  EXPECT_LT(worst_position(known.graph, known.truth), 1e-9);
}

TEST(ChainMotion, FollowsEdgesAgainstTheirDirection) {
  PoseGraph graph{.map_from_node = {{1, 2, 0.5}, {}}};
  const Pose2 b_from_a{0.3, 0.1, -0.2};
  graph.edges.push_back({.a = 1, .b = 0, .a_from_b = b_from_a});
  chain_motion(graph);
  const Pose2 expected = graph.map_from_node[0] * inverse(b_from_a);
  EXPECT_LT(distance(graph.map_from_node[1], expected), 1e-12);
}

}  // namespace
}  // namespace flirt
