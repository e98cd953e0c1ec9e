#include "flirt/slam/repair.hpp"

#include "tests/slam/buildings.hpp"

#include <gmock/gmock.h>

#include <algorithm>

namespace flirt {
namespace {

PoseGraph true_graph() {
  return chain_of(short_drive().map_from_robot, 0.03, 0.01);
}

TEST(Repair, PutsALoneWrongScanBack) {
  PoseGraph graph = true_graph();
  constexpr std::uint32_t wrong = 60;
  graph.map_from_node[wrong] = graph.map_from_node[wrong] * Pose2{0.35, -0.2, radians_from_degrees(9)};
  EXPECT_EQ(repair(graph, short_drive_scans(), std::vector{wrong}, {}), std::vector{wrong});
  EXPECT_LT(distance(graph.map_from_node[wrong], short_drive().map_from_robot[wrong]), 0.03);
  EXPECT_LT(heading_difference(graph.map_from_node[wrong], short_drive().map_from_robot[wrong]),
            radians_from_degrees(0.7));
  for (const PoseEdge& edge : graph.edges) {
    if (edge.a != wrong && edge.b != wrong) { continue; }
    EXPECT_LT(distance(edge.a_from_b, inverse(graph.map_from_node[edge.a]) * graph.map_from_node[edge.b]), 1e-9)
        << "no edge still says what was wrong";
  }
}

TEST(Repair, LeavesScansThatAreRight) {
  PoseGraph graph = true_graph();
  std::vector<std::uint32_t> all(short_drive_scans().size());
  for (std::uint32_t i = 0; i < all.size(); ++i) { all[i] = i; }
  EXPECT_TRUE(repair(graph, short_drive_scans(), all, {}).empty());
  EXPECT_EQ(graph.map_from_node, short_drive().map_from_robot);
}

TEST(Repair, NeverMovesTheFirstScanNorOneWithoutNeighbours) {
  PoseGraph graph = true_graph();
  constexpr std::uint32_t far = 60;
  graph.map_from_node[far] = {1000, 1000, 0};
  graph.map_from_node[0] = graph.map_from_node[0] * Pose2{0.3, 0, 0};
  const std::vector<Pose2> before = graph.map_from_node;
  EXPECT_TRUE(repair(graph, short_drive_scans(), std::vector<std::uint32_t>{0, far}, {}).empty());
  EXPECT_EQ(graph.map_from_node, before);
}

TEST(Repair, LeavesScansThatSeeNothing) {
  PoseGraph graph = true_graph();
  std::vector<SlamScan> some = short_drive_scans();
  some[60] = {};
  EXPECT_TRUE(repair(graph, some, std::vector<std::uint32_t>{60}, {}).empty());
}

}  // namespace
}  // namespace flirt
