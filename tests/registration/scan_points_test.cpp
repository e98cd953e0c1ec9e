#include "flirt/registration/scan_points.hpp"

#include "rooms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace flirt {
namespace {

TEST(ScanPoints, KeepTheirSpacingAcrossTheSeamOfAFullTurn) {
  const auto walls = rooms::asymmetric_room();
  for (const double heading : {0.0, 0.7, 1.9, 3.0}) {
    const ScanPoints points = scan_points(rooms::scan_of(walls, {3.1, 3.3, heading}, 2 * std::numbers::pi));
    ASSERT_GT(points.size(), 50U);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t next = (i + 1) % points.size();
      const Point2 step{points.x[next] - points.x[i], points.y[next] - points.y[i]};
      EXPECT_GE(norm(step), 0.0999) << heading << ", point " << i;
    }
  }
}

TEST(ScanPoints, OfHalfATurnMayEndWhereTheyBegan) {
  // The first and the last beam of half a turn are no neighbours, however near their ends are.
  Scan scan{.beams = {-1.5, 1.0, 0.05, 50}};
  scan.ranges = {0.06, 1.0, 1.0, 0.06};
  EXPECT_EQ(scan_points(scan).size(), 4U);
}

/// A room with a square post of a side, its middle at (4, 2.5), and how many points of a scan from beside it lie on it.
std::size_t points_on_post(double side, const ScanPointParams& params = {}, Point2 sensor = {2.5, 2.4}) {
  auto walls = rooms::outline({{0, 0}, {8, 0}, {8, 5}, {0, 5}});
  const double half = side / 2;
  for (const rooms::Wall& wall : rooms::outline(
           {{4 - half, 2.5 - half}, {4 + half, 2.5 - half}, {4 + half, 2.5 + half}, {4 - half, 2.5 + half}})) {
    walls.push_back(wall);
  }
  const ScanPoints points = scan_points(rooms::scan_of(walls, {sensor.x, sensor.y, 0}, 3), params);
  std::size_t on_post = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point2 in_room{sensor.x + points.x[i], sensor.y + points.y[i]};
    on_post += norm(in_room - Point2{4, 2.5}) < side ? 1 : 0;
  }
  return on_post;
}

TEST(ScanPoints, LegsAreLeftOut) {
  EXPECT_EQ(points_on_post(0.12), 0U);
  EXPECT_GT(points_on_post(0.12, {.leg_width = 0}), 0U);
}

/// A wall 3 m ahead, seen by beams a degree apart, with some of the readings replaced, and how many points remain.
std::size_t points_before_a_wall(std::vector<std::pair<std::size_t, float>> replaced) {
  Scan scan{.beams = {radians_from_degrees(-20), radians_from_degrees(1), 0.05, 50}};
  for (int i = 0; i <= 40; ++i) {
    scan.ranges.push_back(static_cast<float>(3 / std::cos(radians_from_degrees(i - 20))));
  }
  for (const auto& [beam, range] : replaced) { scan.ranges[beam] = range; }
  return scan_points(scan, {.spacing = 0}).size();
}

TEST(ScanPoints, ALegHalfBehindAnotherIsLeftOutToo) {
  EXPECT_EQ(points_before_a_wall({{18, 1.0F}, {19, 1.0F}, {20, 1.0F}, {21, 1.5F}, {22, 1.5F}}), 41U - 5U);
}

TEST(ScanPoints, AReadingBetweenALegAndTheWallBehindHidesNoLeg) {
  EXPECT_EQ(points_before_a_wall({{18, 1.0F}, {19, 1.0F}, {20, 2.8F}}), 41U - 2U);
}

TEST(ScanPoints, AWallBetweenTwoLegsStays) {
  EXPECT_EQ(points_before_a_wall({{16, 1.0F}, {17, 1.0F}, {20, 1.0F}, {21, 1.0F}}), 41U - 4U);
}

TEST(ScanPoints, WhatIsWiderThanALegStays) {
  EXPECT_GT(points_on_post(0.4), 2U);
}

TEST(ScanPoints, WhatStandsCloseToAWallStays) {
  EXPECT_GT(points_on_post(0.12, {.leg_gap = 5}), 0U);
}

}  // namespace
}  // namespace flirt
