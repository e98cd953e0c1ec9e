#include "flirt/slam/loop_closer.hpp"

#include "tests/slam/buildings.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

struct Found {
  std::vector<Closure> closures{};
  std::vector<std::size_t> at{};  ///< scan that brought each of them
  int wrong{0};                   ///< edges more than 0.3 m or 5° off
};

/// What the closer says when the graph grows by `in_graph`, which it never corrects. The motion to the scan `unseen`,
/// if not 0, is known to metres only.
Found closures_of(const ScanLog& log, const std::vector<Pose2>& in_graph, const SlamParams& params = {},
                  std::size_t unseen = 0) {
  const std::vector<SlamScan> scans = slam_scans(log);
  PoseGraph whole = chain_of(in_graph, 0.01, 0.003);
  if (unseen > 0) { whole.edges[unseen - 1].information *= 1e-5; }
  LoopCloser closer(params);
  PoseGraph graph;
  Found found;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    graph.map_from_node.push_back(whole.map_from_node[i]);
    if (i > 0) { graph.edges.push_back(whole.edges[i - 1]); }
    for (const Closure& closure : closer.add(std::span(scans).first(i + 1), graph)) {
      found.closures.push_back(closure);
      found.at.push_back(i);
    }
  }
  for (const Closure& closure : found.closures) {
    for (const PoseEdge& edge : closure.edges) {
      const Pose2 truth = inverse(log.map_from_robot[edge.a]) * log.map_from_robot[edge.b];
      const bool wrong =
          distance(truth, edge.a_from_b) > 0.3 || heading_difference(truth, edge.a_from_b) > radians_from_degrees(5);
      found.wrong += wrong ? 1 : 0;
    }
  }
  return found;
}

/// The truth with a drift of 1 % of the way, as scan matching may leave it.
std::vector<Pose2> drifted(const std::vector<Pose2>& truth) {
  return drifting_odometry(truth,
                           {.translation_noise = 0.005,
                            .rotation_noise = 0.002,
                            .heading_noise = 0.001,
                            .translation_bias = 0.01,
                            .rotation_bias = 0.0005,
                            .heading_bias = 0.0002},
                           3);
}

TEST(LoopCloser, FindsEarlierVisitsWhereTheGraphHasDrifted) {
  const ScanLog log = drive_through(2, 4, 2);
  const Found found = closures_of(log, drifted(log.map_from_robot));
  EXPECT_GT(found.closures.size(), 10U);
  EXPECT_EQ(found.wrong, 0);
}

TEST(LoopCloser, DoesNotTakeARoomForItsTwin) {
  SimulateParams params{.seed = 4};
  params.drive.rounds = 2;
  const ScanLog log = simulate(make_office({.area = 400, .twin_rooms = 1, .seed = 5}), params)->log;
  const Found found = closures_of(log, log.map_from_robot);
  EXPECT_EQ(found.wrong, 0);
  EXPECT_GT(found.closures.size(), 5U);
}

/// A dead-straight corridor of doors like all others, five metres apart: each place looks like the ones beside it.
TEST(LoopCloser, FindsNoPlaceAmongManyThatLookTheSame) {
  FloorPlan plan;
  constexpr double length = 80;
  constexpr double period = 5;
  plan.segments.push_back({{-10, -1}, {length, -1}});
  for (double x = -10; x < length; x += period) {
    plan.segments.push_back({{x, 1}, {x + 4, 1}});
    plan.segments.push_back({{x + 4, 1}, {x + 4, 1.6}});
    plan.segments.push_back({{x + 4, 1.6}, {x + 5, 1.6}});
    plan.segments.push_back({{x + 5, 1.6}, {x + 5, 1}});
  }
  const RayCaster caster(plan);
  const Lidar lidar({.beams = 180, .range_max = 8});
  ScanLog log;
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Pose2 pose{0.3 * i, 0, 0};
    log.map_from_robot.push_back(pose);
    log.scans.push_back({.stamp = 0.1 * i,
                         .beams = lidar.beams(),
                         .ranges = lidar.measure(caster, {}, pose * lidar.robot_from_sensor(), rng),
                         .robot_from_sensor = lidar.robot_from_sensor()});
  }
  EXPECT_TRUE(closures_of(log, log.map_from_robot).closures.empty());
}

TEST(LoopCloser, SearchesTheWholeMapOnlyAfterAMotionThatWasNotSeen) {
  const ScanLog log = drive_through(2, 4, 2);
  std::vector<Pose2> torn = log.map_from_robot;
  const std::size_t half = torn.size() / 2;
  for (std::size_t i = half; i < torn.size(); ++i) { torn[i] = Pose2{40, 0, 0} * torn[i]; }
  EXPECT_TRUE(closures_of(log, torn, {.global_after = 10}).closures.empty());
  const Found found = closures_of(log, torn, {.global_after = 10}, half);
  EXPECT_GT(found.closures.size(), 0U);
  EXPECT_EQ(found.wrong, 0);
}

TEST(LoopCloser, AsksForMoreWhereTheDisplacementIsUnlikely) {
  const ScanLog log = drive_through(2, 4, 2);
  // The graph is right until the second round, and then 0.7 m off: no drift is like that.
  std::vector<Pose2> torn = log.map_from_robot;
  const std::size_t half = torn.size() / 2;
  for (std::size_t i = half; i < torn.size(); ++i) { torn[i] = Pose2{0.6, 0.35, 0} * torn[i]; }
  const auto first_off = [&](const SlamParams& params) {
    const Found found = closures_of(log, torn, params);
    EXPECT_EQ(found.wrong, 0);
    double travel = 0;
    for (std::size_t k = 0; k < found.closures.size(); ++k) {
      if (found.closures[k].translation < 0.5) { continue; }
      for (std::size_t i = half + 1; i <= found.at[k]; ++i) { travel += distance(torn[i - 1], torn[i]); }
      break;
    }
    return travel;
  };
  const double patient = first_off({.front_end = FrontEndKind::scan, .loop_drift_growth = 0.001});
  const double hasty = first_off({.front_end = FrontEndKind::scan, .loop_drift = 3});
  EXPECT_GT(hasty, 0);
  EXPECT_GT(patient, hasty + 5);
}

}  // namespace
}  // namespace flirt
