#include "flirt/eval/trajectory_metrics.hpp"
#include "flirt/graph/optimize.hpp"
#include "flirt/io/toro_graph.hpp"

#include "tests/graph/graphs.hpp"
#include "tests/support/data.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace flirt {
namespace {

std::optional<GraphFile> intel() {
  const auto log = data_file("intel/flirtlib-intel-lab.log.gz");
  return log ? std::optional(read_toro_graph(*log).value()) : std::nullopt;
}

/// m, after alignment.
double error_of(const PoseGraph& graph, const std::vector<Pose2>& published) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < published.size(); ++i) { pairs.push_back({0, graph.map_from_node[i], published[i]}); }
  return absolute_error(pairs).translation.rmse;
}

TEST(OptimizeReal, ReachesThePublishedPosesOfIntelFromChainedMotion) {
  const auto file = intel();
  if (!file) { GTEST_SKIP() << "no real logs"; }
  PoseGraph by_ceres = file->graph;
  chain_motion(by_ceres);
  PoseGraph by_toro = by_ceres;
  EXPECT_TRUE(optimize(by_ceres).converged);
  EXPECT_LE(error_of(by_ceres, file->graph.map_from_node), 0.047);
  (void)optimize(by_toro, {.backend = Backend::toro});
  EXPECT_LE(error_of(by_toro, file->graph.map_from_node), 0.073);
}

TEST(OptimizeReal, MapOfIntelSurvivesATenthOfFalseLoops) {
  const auto file = intel();
  if (!file) { GTEST_SKIP() << "no real logs"; }
  PoseGraph graph = file->graph;
  chain_motion(graph);
  add_false_loops(graph, 123, 1);
  PoseGraph undefended = graph;
  const OptimizeSummary summary = optimize(graph, {.graduated = Graduated::truncated});
  EXPECT_LE(error_of(graph, file->graph.map_from_node), 0.05);
  EXPECT_EQ(summary.rejected.size(), 123U);
  (void)optimize(undefended);
  EXPECT_GT(error_of(undefended, file->graph.map_from_node), 1.0);
}

}  // namespace
}  // namespace flirt
