#include "flirt/sim/drive.hpp"

#include "flirt/sim/office.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace flirt {
namespace {

struct Driven {
  World world;
  Drive drive;
};
Driven driven_office(double area, const DriveParams& params, std::uint64_t seed = 1) {
  World world = make_office({.area = area});
  const FreeSpace space(world.plan, params.robot_radius);
  Drive drive = plan_drive(space, world.places, params, seed);
  return {std::move(world), std::move(drive)};
}

double length(const Drive& drive) {
  double sum = 0;
  for (std::size_t i = 1; i < drive.knots.size(); ++i) {
    sum += distance(drive.knots[i - 1].map_from_robot, drive.knots[i].map_from_robot);
  }
  return sum;
}

TEST(Drive, NeverComesNearerToASurfaceThanItsRadius) {
  for (const double deviation : {0.0, 0.5}) {
    const DriveParams params{.round_length = 60, .lateral_deviation = deviation};
    const auto [world, drive] = driven_office(900, params);
    ASSERT_GT(length(drive), 60);
    for (double stamp = 0; stamp < drive.knots.back().stamp; stamp += 0.1) {
      ASSERT_GE(distance_to_surface(world.plan, pose_at(drive, stamp).translation()), params.robot_radius) << stamp;
    }
  }
}

TEST(Drive, KeepsItsLimitsOfSpeedAndTurning) {
  const DriveParams params{.speed = 0.7, .turn_rate = 0.9, .round_length = 80};
  const Drive drive = driven_office(900, params).drive;
  for (std::size_t i = 1; i < drive.knots.size(); ++i) {
    const double seconds = drive.knots[i].stamp - drive.knots[i - 1].stamp;
    ASSERT_GT(seconds, 0);
    EXPECT_LE(distance(drive.knots[i].map_from_robot, drive.knots[i - 1].map_from_robot), 0.7 * seconds + 1e-9);
    EXPECT_LE(heading_difference(drive.knots[i].map_from_robot, drive.knots[i - 1].map_from_robot),
              0.9 * seconds + 1e-9);
  }
}

TEST(Drive, LooksWhereItGoes) {
  const Drive drive = driven_office(900, {.round_length = 80}).drive;
  double ahead = 0;
  double total = 0;
  for (std::size_t i = 1; i < drive.knots.size(); ++i) {
    const Pose2 step = inverse(drive.knots[i - 1].map_from_robot) * drive.knots[i].map_from_robot;
    ahead += step.x;
    total += norm(step.translation());
  }
  EXPECT_GT(ahead, 0.95 * total);
}

TEST(Drive, VisitsEveryPlaceThatItCanReachInTheFirstRound) {
  const DriveParams params{.rounds = 1, .place_share = 1};
  const auto [world, drive] = driven_office(900, params);
  const FreeSpace space(world.plan, params.robot_radius);
  int reachable = 0;
  for (const Point2 place : world.places) {
    const std::vector<Point2> spot = space.nearest(place, 1);
    if (spot.empty()) { continue; }
    ++reachable;
    double nearest = std::numeric_limits<double>::infinity();
    for (const DriveKnot& knot : drive.knots) {
      nearest = std::min(nearest, norm(knot.map_from_robot.translation() - spot[0]));
    }
    EXPECT_LT(nearest, 1.5);
  }
  EXPECT_GT(reachable, 15);
}

TEST(Drive, SecondRoundIsNearTheFirstButNotTheSameAndPartlyOpposite) {
  const Drive drive = driven_office(900, {.rounds = 2, .reversed_share = 0.5}).drive;
  ASSERT_EQ(drive.round_begin.size(), 2U);
  EXPECT_EQ(drive.round_begin[0], 0);
  std::vector<Pose2> first;
  std::vector<Pose2> second;
  for (double stamp = 0; stamp < drive.knots.back().stamp; stamp += 0.3) {
    (stamp < drive.round_begin[1] ? first : second).push_back(pose_at(drive, stamp));
  }
  int opposite = 0;
  int alike = 0;
  int apart = 0;
  double largest = 0;
  for (const Pose2& pose : second) {
    const Pose2& near = *std::min_element(first.begin(), first.end(), [&](const Pose2& a, const Pose2& b) {
      return distance(a, pose) < distance(b, pose);
    });
    largest = std::max(largest, distance(near, pose));
    apart += distance(near, pose) > 0.02 ? 1 : 0;
    double least_turn = 10;  // to a pose of the first round close by
    for (const Pose2& other : first) {
      if (distance(other, pose) < 0.7) { least_turn = std::min(least_turn, heading_difference(other, pose)); }
    }
    opposite += least_turn > 2 && least_turn < 4 ? 1 : 0;
    alike += least_turn < 0.5 ? 1 : 0;
  }
  const auto all = static_cast<int>(second.size());
  EXPECT_LT(largest, 2.5);
  EXPECT_GT(apart, all / 2);
  EXPECT_GT(alike, all / 4);
  EXPECT_GT(opposite, all / 50);
}

TEST(Drive, EndsARoundAfterItsLength) {
  const Drive drive = driven_office(900, {.rounds = 1, .round_length = 30}).drive;
  EXPECT_NEAR(length(drive), 30, 0.5);
}

TEST(Drive, EqualSeedsDriveAlikeAndOthersDoNot) {
  const DriveParams params{.round_length = 40};
  const Drive a = driven_office(600, params, 1).drive;
  const Drive b = driven_office(600, params, 1).drive;
  const Drive c = driven_office(600, params, 2).drive;
  ASSERT_EQ(a.knots.size(), b.knots.size());
  for (std::size_t i = 0; i < a.knots.size(); ++i) { EXPECT_EQ(a.knots[i].map_from_robot, b.knots[i].map_from_robot); }
  EXPECT_NE(a.knots.back().map_from_robot, c.knots.back().map_from_robot);
}

TEST(Drive, IsEmptyWhereNothingCanBeReached) {
  const FloorPlan plan{{{{0, 0}, {1, 1}}}, {}, {}};
  const FreeSpace space(plan, 3);
  EXPECT_TRUE(plan_drive(space, std::vector<Point2>{{0, 0}}, {}, 1).knots.empty());
  EXPECT_TRUE(plan_drive(space, {}, {}, 1).knots.empty());
}

TEST(Drive, PoseBetweenKnotsTurnsTheShortWay) {
  const Drive drive{{{0, {0, 0, 3}}, {2, {1, 0, -3}}}, {0}};
  const Pose2 pose = pose_at(drive, 1);
  EXPECT_NEAR(pose.x, 0.5, 1e-12);
  EXPECT_NEAR(std::abs(pose.theta), 3.141592653589793, 1e-9);
  EXPECT_EQ(pose_at(drive, -1), (Pose2{0, 0, 3}));
  EXPECT_EQ(pose_at(drive, 9), (Pose2{1, 0, -3}));
}

TEST(ScanStops, AreTicksThinnedByWayAndTurn) {
  const Drive drive{{{0, {0, 0, 0}}, {10, {10, 0, 0}}, {12, {10, 0, 1}}}, {0}};
  const std::vector<DriveKnot> all = scan_stops(drive, 10, {.scan_distance = 0});
  EXPECT_EQ(all.size(), 121U);
  const std::vector<DriveKnot> thinned = scan_stops(drive, 10, {.scan_distance = 0.95, .scan_turn = 0.24});
  std::vector<double> stamps;
  for (const DriveKnot& stop : thinned) { stamps.push_back(stop.stamp); }
  ASSERT_EQ(stamps.size(), 15U);
  EXPECT_NEAR(stamps[1], 1.0, 1e-9);
  EXPECT_NEAR(stamps[10], 10.0, 1e-9);
  EXPECT_NEAR(stamps[11], 10.5, 1e-9);
}

}  // namespace
}  // namespace flirt
