#include "flirt/slam/polish.hpp"

#include "tests/slam/buildings.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <vector>

namespace flirt {
namespace {

const std::vector<SurfacePoints>& short_drive_points() {
  static const std::vector<SurfacePoints> points = points_of(short_drive_scans());
  return points;
}

PoseGraph shaken_graph() {
  return chain_of(shaken(short_drive().map_from_robot, 0.03, radians_from_degrees(0.7), 5), 0.03,
                  radians_from_degrees(0.7));
}

TEST(Polish, DrawsShakenScansOntoEachOther) {
  PoseGraph graph = shaken_graph();
  ASSERT_GT(error_of(graph.map_from_node, short_drive().map_from_robot), 0.035);
  const PolishSummary first = polish(graph, short_drive_points(), {.polish_rounds = 1});
  EXPECT_GT(first.pairs, 2 * short_drive_points().size());
  const PolishSummary later = polish(graph, short_drive_points(), {});
  EXPECT_LT(later.residual, 0.5 * first.residual);
  EXPECT_LT(error_of(graph.map_from_node, short_drive().map_from_robot), 0.008);
  EXPECT_EQ(graph.map_from_node.front(), short_drive().map_from_robot.front());
}

TEST(Polish, TellsWhichScanFitsNobody) {
  PoseGraph graph = shaken_graph();
  graph.map_from_node[40] = graph.map_from_node[40] * Pose2{1.5, 1.5, 1};
  const PolishSummary summary = polish(graph, short_drive_points(), {.polish_rounds = 1});
  ASSERT_EQ(summary.fit.size(), short_drive_points().size());
  EXPECT_EQ(std::ranges::min_element(summary.fit) - summary.fit.begin(), 40);
  EXPECT_LT(summary.fit[40], 0.3);
  const auto fitting = std::ranges::count_if(summary.fit, [](double fit) { return fit > 0.6; });
  EXPECT_GT(static_cast<double>(fitting), 0.9 * static_cast<double>(short_drive_points().size()));
}

TEST(Polish, LeavesPosesWhereNothingCanBeSeen) {
  PoseGraph graph = chain_of(short_drive().map_from_robot, 0.03, 0.01);
  const std::vector<SurfacePoints> blind(short_drive_points().size());
  const PolishSummary summary = polish(graph, blind, {});
  EXPECT_EQ(summary.pairs, 0U);
  EXPECT_LT(error_of(graph.map_from_node, short_drive().map_from_robot), 1e-6);
}

TEST(Polish, WithoutRoundsDoesNothing) {
  PoseGraph graph = shaken_graph();
  const std::vector<Pose2> before = graph.map_from_node;
  EXPECT_EQ(polish(graph, short_drive_points(), {.polish_rounds = 0}).pairs, 0U);
  EXPECT_EQ(graph.map_from_node, before);
}

}  // namespace
}  // namespace flirt
