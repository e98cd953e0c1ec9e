#include "flirt/graph/tail.hpp"

#include "tests/graph/graphs.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace flirt {
namespace {

/// Two rounds with noise, at the minimum.
PoseGraph optimum() {
  PoseGraph graph = rounds(2, {.position = 0.03, .heading = 0.01}, 3).graph;
  optimize(graph);
  return graph;
}

void shake(PoseGraph& graph, std::uint32_t first) {
  Rng rng(8);
  for (std::size_t i = first; i < graph.map_from_node.size(); ++i) {
    Pose2& pose = graph.map_from_node[i];
    pose = pose * Pose2{rng.normal(0, 0.2), rng.normal(0, 0.2), rng.normal(0, 0.05)};
  }
}

TEST(OptimizeTail, FindsTheMinimumOfTheWholeWhenTheRestIsThere) {
  constexpr std::uint32_t first_free = 150;
  const PoseGraph whole = optimum();
  PoseGraph graph = whole;
  for (std::size_t k = 0; k < graph.edges.size(); k += 7) {  // a loop may be stated from either end
    PoseEdge& edge = graph.edges[k];
    if (edge.kind != EdgeKind::loop) { continue; }
    std::swap(edge.a, edge.b);
    edge.a_from_b = inverse(edge.a_from_b);
  }
  shake(graph, first_free);
  optimize_tail(graph, first_free);
  for (std::size_t i = 0; i < graph.map_from_node.size(); ++i) {
    // Loops stated from the other end have their (here nearly isotropic) information there.
    const double close = i < first_free ? 0 : 0.01;
    EXPECT_LE(distance(graph.map_from_node[i], whole.map_from_node[i]), close) << i;
    EXPECT_LE(heading_difference(graph.map_from_node[i], whole.map_from_node[i]), close) << i;
  }
}

TEST(OptimizeTail, WithoutTurnedEdgesFindsItExactly) {
  constexpr std::uint32_t first_free = 150;
  const PoseGraph whole = optimum();
  for (const Backend backend : {Backend::ceres, Backend::toro}) {
    PoseGraph graph = whole;
    shake(graph, first_free);
    optimize_tail(graph, first_free, {.backend = backend, .iterations = 300});
    const double close = backend == Backend::ceres ? 1e-5 : 0.02;
    for (std::size_t i = first_free; i < graph.map_from_node.size(); ++i) {
      EXPECT_LE(distance(graph.map_from_node[i], whole.map_from_node[i]), close) << i;
    }
  }
}

TEST(OptimizeTail, OfEverythingIsTheWhole) {
  PoseGraph by_tail = rounds(2, {.position = 0.03, .heading = 0.01}, 3).graph;
  PoseGraph whole = by_tail;
  optimize_tail(by_tail, 1);
  optimize(whole);
  EXPECT_EQ(by_tail.map_from_node, whole.map_from_node);
}

}  // namespace
}  // namespace flirt
