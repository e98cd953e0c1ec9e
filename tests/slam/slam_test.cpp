#include "flirt/slam/slam.hpp"

#include "flirt/core/rng.hpp"
#include "flirt/eval/trajectory_metrics.hpp"
#include "flirt/sim/corridors.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

namespace flirt {
namespace {

const Simulation& building() {
  static const Simulation simulation = [] {
    SimulateParams params{.seed = 4};
    params.drive.rounds = 2;
    return *simulate(make_office({.area = 500, .seed = 2}), params);
  }();
  return simulation;
}

Slam mapped(const ScanLog& log, const SlamParams& params = {}) {
  Slam slam(params);
  for (const Scan& scan : log.scans) { slam.add(scan); }
  slam.finish();
  return slam;
}

double error_of(const Slam& slam, const ScanLog& log) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    pairs.push_back({.estimate = slam.graph().map_from_node[i], .truth = log.map_from_robot[i]});
  }
  return absolute_error(pairs).translation.rmse;
}

TEST(Slam, MapsABuildingFromDriftingOdometryAndWithoutAny) {
  const ScanLog& log = building().log;
  ASSERT_TRUE(log.scans.front().odom_from_robot);
  const Slam with = mapped(log);
  EXPECT_LT(error_of(with, log), 0.05);
  EXPECT_GT(with.summary().closures, 10U);
  EXPECT_EQ(with.summary().predictions, 0U);
  EXPECT_LT(error_of(mapped(log, {.odometry = OdometryUse::ignore}), log), 0.05);
}

TEST(Slam, TakesOdometryThatNeverMovesForNone) {
  ScanLog log = building().log;
  log.scans.resize(150);
  for (Scan& scan : log.scans) { scan.odom_from_robot = Pose2{}; }
  EXPECT_EQ(mapped(log).graph().map_from_node, mapped(log, {.odometry = OdometryUse::ignore}).graph().map_from_node);
}

TEST(Slam, DoesNotFollowOdometryThatJumps) {
  ScanLog log = building().log;
  log.scans.resize(200);
  log.map_from_robot.resize(200);
  for (const std::size_t i : {60U, 100U, 140U}) { log.scans[i].odom_from_robot->x += i == 100 ? 1e6 : 28; }
  for (std::size_t i = 160; i < 200; ++i) { log.scans[i].odom_from_robot->y -= 50; }
  const Slam slam = mapped(log);
  EXPECT_LT(error_of(slam, log), 0.05);
  EXPECT_EQ(slam.summary().predictions, 0U);
}

TEST(Slam, ClosesNoLoopWrongly) {
  const ScanLog& log = building().log;
  const Slam slam = mapped(log, {.odometry = OdometryUse::ignore});
  int loops = 0;
  for (const PoseEdge& edge : slam.graph().edges) {
    if (edge.kind != EdgeKind::loop) { continue; }
    const Pose2 truth = inverse(log.map_from_robot[edge.a]) * log.map_from_robot[edge.b];
    EXPECT_LT(distance(truth, edge.a_from_b), 0.3);
    EXPECT_LT(heading_difference(truth, edge.a_from_b), radians_from_degrees(5));
    ++loops;
  }
  EXPECT_GT(loops, 30);
}

/// Nothing but shut doors tells how far the robot went, every corridor looks like the next, and odometry bends by 14°
/// in 60 m.
TEST(Slam, LongCorridorsThatLookAlikeAreNotMistakenForEachOther) {
  SimulateParams params{.seed = 1};
  params.lidar.beams = 180;
  params.lidar.range_max = 80;
  params.drive.scan_distance = 0.4;
  params.drive.rounds = 1;
  params.odometry.heading_bias = 0.004;
  params.odometry.heading_noise = 0.02;
  const ScanLog log = simulate(make_corridors({.length = 120}), params)->log;
  std::vector<PosePair> told;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    told.push_back({.estimate = *log.scans[i].odom_from_robot, .truth = log.map_from_robot[i]});
  }
  ASSERT_GT(absolute_error(told).translation.rmse, 10);
  const Slam slam = mapped(log);
  EXPECT_LT(error_of(slam, log), 1);
  for (const PoseEdge& edge : slam.graph().edges) {
    if (edge.kind != EdgeKind::loop) { continue; }
    const Pose2 truth = inverse(log.map_from_robot[edge.a]) * log.map_from_robot[edge.b];
    EXPECT_LT(distance(truth, edge.a_from_b), 0.5) << edge.a << ' ' << edge.b;
    EXPECT_LT(heading_difference(truth, edge.a_from_b), radians_from_degrees(5)) << edge.a << ' ' << edge.b;
  }
}

/// Lifted and put down elsewhere, with odometry as if nothing had happened. It comes by its own new way before it comes
/// to what it knew, and that must not pass for having been found.
TEST(Slam, FindsARobotAgainThatWasCarried) {
  SimulateParams params{.seed = 9};
  params.drive.rounds = 2;
  ScanLog log = simulate(make_office({.area = 900, .seed = 8}), params)->log;
  const std::size_t lifted = log.scans.size() * 6 / 10;
  const std::size_t put_down = log.scans.size() * 8 / 10;
  const Pose2 moved = *log.scans[lifted - 1].odom_from_robot * inverse(*log.scans[put_down].odom_from_robot);
  for (std::size_t i = put_down; i < log.scans.size(); ++i) {
    log.scans[i].odom_from_robot = moved * *log.scans[i].odom_from_robot;
  }
  const auto carry = [&](auto& values) {
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(lifted),
                 values.begin() + static_cast<std::ptrdiff_t>(put_down));
  };
  carry(log.scans);
  carry(log.map_from_robot);
  ASSERT_GT(distance(log.map_from_robot[lifted - 1], log.map_from_robot[lifted]), 5);
  const Slam slam = mapped(log);
  EXPECT_LT(error_of(slam, log), 0.5);
  EXPECT_EQ(slam.summary().pieces, 1U);
}

TEST(Slam, GivesTheSamePosesTwice) {
  const ScanLog& log = building().log;
  EXPECT_EQ(mapped(log).graph().map_from_node, mapped(log).graph().map_from_node);
}

TEST(Slam, StartsAtThePoseAskedFor) {
  const Slam slam = mapped(building().log, {.start_x = -40, .start_y = 7, .start_theta = 2});
  EXPECT_EQ(slam.graph().map_from_node.front(), (Pose2{-40, 7, 2}));
  EXPECT_LT(error_of(slam, building().log), 0.05);
}

TEST(Slam, AcceptsScansThatSayNothing) {
  ScanLog log = building().log;
  log.scans[50].ranges.clear();
  std::ranges::fill(log.scans[90].ranges, std::numeric_limits<double>::quiet_NaN());
  std::ranges::fill(log.scans[130].ranges, 0.0);
  log.scans[60].odom_from_robot = Pose2{std::numeric_limits<double>::quiet_NaN(), 0, 0};
  const Slam slam = mapped(log);
  ASSERT_EQ(slam.graph().map_from_node.size(), log.scans.size());
  for (const std::size_t empty : {50U, 90U, 130U}) {
    EXPECT_EQ(slam.steps()[empty].source, MotionSource::prediction);
    EXPECT_TRUE(slam.steps()[empty].unobservable);
  }
  EXPECT_TRUE(std::ranges::all_of(slam.graph().map_from_node, is_finite));
  EXPECT_LT(error_of(slam, log), 0.06);
}

TEST(Slam, SaysWhatOnlyUnseenMotionsHoldTogether) {
  ScanLog log = building().log;
  log.scans.resize(100);
  EXPECT_EQ(mapped(log).summary().pieces, 1U);
  for (const std::size_t empty : {30U, 31U, 60U}) { log.scans[empty].ranges.clear(); }
  const SlamSummary summary = mapped(log).summary();
  EXPECT_EQ(summary.closures, 0U);  // they would hold the map together, too
  EXPECT_EQ(summary.pieces, 3U);
}

TEST(Slam, AcceptsALogOfNothing) {
  Slam slam;
  slam.finish();
  EXPECT_EQ(slam.summary().scans, 0U);
  EXPECT_EQ(slam.summary().pieces, 0U);
  for (int i = 0; i < 5; ++i) { slam.add(Scan{}); }
  slam.finish();
  EXPECT_EQ(slam.graph().map_from_node, std::vector<Pose2>(5));
}

/// Table legs 4 cm thick, seen to 4 m: some twenty points a scan, and no wall.
Scan scan_among_legs(const Pose2& map_from_robot) {
  Rng rng(7);
  std::vector<Point2> legs(66);
  for (Point2& leg : legs) { leg = {rng.uniform(-3, 9), rng.uniform(-3, 3)}; }
  Scan scan{.beams = {radians_from_degrees(-120), radians_from_degrees(0.35), 0.05, 4}};
  for (std::size_t i = 0; i < 686; ++i) {
    const double bearing = map_from_robot.theta + scan.beams.angle(i);
    const Point2 ray{std::cos(bearing), std::sin(bearing)};
    double range = std::numeric_limits<double>::infinity();
    for (const Point2& leg : legs) {
      constexpr double radius = 0.02;
      const Point2 to = leg - map_from_robot.translation();
      const double along = dot(to, ray);
      const double aside = to.x * ray.y - to.y * ray.x;
      if (along > 0.2 && along < 4 && std::abs(aside) < radius) {
        range = std::min(range, along - std::sqrt(radius * radius - aside * aside));
      }
    }
    scan.ranges.push_back(range);
  }
  scan.stamp = map_from_robot.x;
  return scan;
}

TEST(Slam, FollowsARobotAmongTableLegs) {
  Slam slam;
  std::vector<Pose2> truth;
  for (int i = 0; i < 60; ++i) {
    truth.push_back({0.1 * i, 0.3 * std::sin(0.1 * i), 0.3 * std::cos(0.1 * i) - 0.3});
    slam.add(scan_among_legs(truth.back()));
  }
  slam.finish();
  EXPECT_EQ(slam.summary().predictions, 0U);
  EXPECT_LT(distance(slam.graph().map_from_node.back(), truth.back()), 0.1);
}

/// Two parallel walls 60 m long, seen to 8 m: nothing tells how far along one is.
Scan corridor_scan(double x) {
  Scan scan{.beams = {-std::numbers::pi, radians_from_degrees(1), 0.05, 8}};
  for (std::size_t i = 0; i < 360; ++i) {
    const double s = std::sin(scan.beams.angle(i));
    scan.ranges.push_back(std::min(8.0, s > 0 ? 1.2 / s : 1.0 / -s));
  }
  scan.stamp = x;
  return scan;
}

TEST(Slam, SaysThatABareCorridorCannotBeSeenAlong) {
  Slam slam;
  for (int i = 0; i < 40; ++i) { slam.add(corridor_scan(0.3 * i)); }
  slam.finish();
  EXPECT_GE(slam.summary().unobservable, 38U);
  for (const Pose2& pose : slam.graph().map_from_node) {
    EXPECT_LT(std::abs(pose.x), 0.5);  // no motion is made up
    EXPECT_LT(std::abs(pose.y), 0.05);
    EXPECT_LT(std::abs(pose.theta), 0.01);
  }
}

/// The same with niches in both walls, one a metre.
Scan corridor_scan_with_niches(double x) {
  Scan scan = corridor_scan(x);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double angle = scan.beams.angle(i);
    const auto hits = [&](double range) {
      const double along = x + range * std::cos(angle);
      const bool in_niche = along - std::floor(along) < 0.4;
      return std::abs(range * std::sin(angle)) >= (in_niche ? 1.4 : 1.0);
    };
    double range = 0;
    while (range < 6 && !hits(range)) { range += 0.002; }
    scan.ranges[i] = range < 6 ? static_cast<float>(range) : std::numeric_limits<float>::infinity();
  }
  return scan;
}

TEST(Slam, SaysThatNichesThatLookAlikeDoNotTellWhichTheyAre) {
  Slam fast;
  fast.add(corridor_scan_with_niches(0));
  EXPECT_TRUE(fast.add(corridor_scan_with_niches(0.5)).unobservable);  // half a metre on, or back?
  Slam slow;
  slow.add(corridor_scan_with_niches(0));
  EXPECT_FALSE(slow.add(corridor_scan_with_niches(0.1)).unobservable);
}

TEST(Slam, HasNoEdgeAcrossAMotionThatWasNotSeen) {
  Slam slam;
  for (int i = 0; i < 20; ++i) { slam.add(corridor_scan(0.3 * i)); }
  ASSERT_GE(slam.summary().unobservable, 18U);
  for (const PoseEdge& edge : slam.graph().edges) {
    const std::span<const SlamStep> across = std::span(slam.steps()).subspan(edge.a + 1, edge.b - edge.a);
    EXPECT_TRUE(edge.b == edge.a + 1 || std::ranges::count(across, true, &SlamStep::unobservable) == 0)
        << edge.a << " to " << edge.b;
  }
}

TEST(Slam, TakesOdometryWhereACorridorHidesTheMotion) {
  Slam slam;
  for (int i = 0; i < 40; ++i) {
    Scan scan = corridor_scan(0.3 * i);
    scan.odom_from_robot = Pose2{0.3 * i, 0, 0};
    slam.add(scan);
  }
  slam.finish();
  EXPECT_GE(slam.summary().unobservable, 38U);
  EXPECT_NEAR(slam.graph().map_from_node.back().x, 0.3 * 39, 0.3);
}

TEST(Slam, WithAWindowUsesNeitherOdometryNorClosures) {
  ScanLog log = building().log;
  const Slam slam = mapped(log, {.window = 20});
  EXPECT_EQ(slam.summary().closures, 0U);
  EXPECT_LT(error_of(slam, log), 1.0);
  for (Scan& scan : log.scans) { scan.odom_from_robot = Pose2{}; }
  EXPECT_EQ(mapped(log, {.window = 20}).graph().map_from_node, slam.graph().map_from_node);
}

}  // namespace
}  // namespace flirt
