#include "flirt/slam/flirt_constraints.hpp"

#include "tests/slam/matched_scans.hpp"

#include <gtest/gtest.h>

#include <set>
#include <span>
#include <vector>

namespace flirt {
namespace {

/// Scans from one place; scan i has `agreeing(i)` of its keypoints.
template <class Agreeing>
std::vector<SlamScan> scans_at_one_place(std::uint32_t count, const Agreeing& agreeing) {
  std::vector<SlamScan> scans;
  SlamScan scan{.scan = scan_of(box({}, 6, 5), {}, {-3.1, 0.05, 0.05, 30}, 125)};
  for (std::uint32_t i = 0; i < count; ++i) {
    test::put_keypoints(scan, {}, agreeing(i), i);
    scans.push_back(scan);
  }
  return scans;
}

/// Motions of `step` m each, known to `deviation`.
PoseGraph chain(std::uint32_t count, double step, double deviation) {
  PoseGraph graph{.map_from_node = {{}}};
  for (std::uint32_t i = 1; i < count; ++i) {
    graph.map_from_node.push_back({step * i, 0, 0});
    graph.edges.push_back({i - 1, i, {step, 0, 0}, Eigen::Matrix3d::Identity() / (deviation * deviation)});
  }
  return graph;
}

/// What the last scan brings.
std::vector<Closure> last_closures(const std::vector<SlamScan>& scans, const PoseGraph& graph, const SlamParams& params,
                                   MotionSource motion = MotionSource::prediction) {
  FlirtConstraints constraints(params);
  std::vector<Closure> found;
  PoseGraph until;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    until.map_from_node.push_back(graph.map_from_node[i]);
    if (i > 0) { until.edges.push_back(graph.edges[i - 1]); }
    found = constraints.add(std::span(scans).first(i + 1), until, motion);
  }
  return found;
}

std::set<std::uint32_t> earlier_nodes(const std::vector<Closure>& closures) {
  std::set<std::uint32_t> nodes;
  for (const Closure& closure : closures) { nodes.insert(closure.edges.front().a); }
  return nodes;
}

TEST(FlirtConstraints, AStepBringsTheBestFifteenOfThemItsMatchedMotion) {
  const auto scans = scans_at_one_place(20, [](std::uint32_t /*i*/) { return 8U; });
  const PoseGraph graph = chain(20, 0, 0.1);
  EXPECT_EQ(last_closures(scans, graph, {}, MotionSource::prediction).size(), 15U);
  EXPECT_EQ(last_closures(scans, graph, {}, MotionSource::narrow).size(), 14U);
}

TEST(FlirtConstraints, MoreInliersComeFirst) {
  const auto scans = scans_at_one_place(12, [](std::uint32_t i) { return i == 3 || i == 5 || i == 11 ? 10U : 8U; });
  SlamParams params;
  params.flirt.best_constraints = 2;
  EXPECT_EQ(earlier_nodes(last_closures(scans, chain(12, 0, 0.1), params)), (std::set<std::uint32_t>{3, 5}));
}

TEST(FlirtConstraints, AWindowHoldsNoOlderScans) {
  const auto scans = scans_at_one_place(12, [](std::uint32_t /*i*/) { return 8U; });
  SlamParams params;
  params.window = 4;
  EXPECT_EQ(earlier_nodes(last_closures(scans, chain(12, 0, 0.1), params)), (std::set<std::uint32_t>{7, 8, 9}));
}

TEST(FlirtConstraints, TheShortestPathRefusesWhatItContradicts) {
  const auto scans = scans_at_one_place(5, [](std::uint32_t /*i*/) { return 8U; });
  SlamParams params;
  const PoseGraph moved = chain(5, 1, 0.05);  // though the keypoints say that nothing moved
  EXPECT_TRUE(last_closures(scans, moved, params).empty());
  EXPECT_EQ(last_closures(scans, chain(5, 1, 5), params).size(), 3U);  // odometry that knows little
  params.flirt.gate = FlirtGate::off;
  EXPECT_EQ(last_closures(scans, moved, params).size(), 3U);
}

TEST(FlirtConstraints, PlacesLeftLongAgoAreLoops) {
  const auto scans = scans_at_one_place(5, [](std::uint32_t /*i*/) { return 8U; });
  SlamParams params;
  params.loop_min_scans = 3;
  params.loop_min_travel = 3;
  for (const Closure& closure : last_closures(scans, chain(5, 1, 5), params)) {
    const PoseEdge& edge = closure.edges.front();
    EXPECT_EQ(edge.kind, edge.b - edge.a >= 3 ? EdgeKind::loop : EdgeKind::motion);
    EXPECT_NEAR(closure.translation, static_cast<double>(edge.b - edge.a), 1e-3);  // m, that the graph is off by
  }
}

}  // namespace
}  // namespace flirt
