#include "flirt/eval/map_quality.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace flirt {
namespace {

/// A full turn of beams in a square room of 10.05 m, whose walls are in the middle of cells,, from `at`, with noise of
/// `deviation` m.
Scan room_scan(const Pose2& at, double deviation, Rng& rng) {
  Scan scan;
  scan.beams = {-3.1, 6.2 / 360, 0, 50};
  for (std::size_t i = 0; i < 360; ++i) {
    const double angle = at.theta + scan.beams.angle(i);
    const double to_x = (std::cos(angle) > 0 ? 5.025 - at.x : -5.025 - at.x) / std::cos(angle);
    const double to_y = (std::sin(angle) > 0 ? 5.025 - at.y : -5.025 - at.y) / std::sin(angle);
    scan.ranges.push_back(std::min(to_x, to_y) + rng.normal(0, deviation));
  }
  return scan;
}

ScanLog room_log(double deviation) {
  Rng rng(1);
  ScanLog log;
  for (int i = 0; i < 30; ++i) {
    const Pose2 at{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-3, 3)};
    log.map_from_robot.push_back(at);
    log.scans.push_back(room_scan(at, deviation, rng));
  }
  return log;
}

TEST(MapQuality, OfExactScansAtTheirPlacesIsPerfect) {
  const ScanLog log = room_log(0);
  const MapQuality quality = map_quality(log, log.map_from_robot);
  EXPECT_EQ(quality.pairs, 240U);
  EXPECT_LT(quality.point_to_line_rms, 0.01);  // the corners are no lines
  EXPECT_NEAR(static_cast<double>(quality.occupied_cells), 4 * 10.05 / 0.05, 40);
}

TEST(MapQuality, ResidualIsThatOfTheRangeNoise) {
  const ScanLog log = room_log(0.02);
  const double rms = map_quality(log, log.map_from_robot).point_to_line_rms;
  EXPECT_GT(rms, 0.018);  // of the point; the noise of the line adds to it
  EXPECT_LT(rms, 0.040);
}

TEST(MapQuality, FallsWhenPosesAreWrong) {
  const ScanLog log = room_log(0.01);
  std::vector<Pose2> wrong = log.map_from_robot;
  Rng rng(2);
  for (Pose2& pose : wrong) { pose.x += rng.normal(0, 0.03); }
  const MapQuality right = map_quality(log, log.map_from_robot);
  const MapQuality bad = map_quality(log, wrong);
  EXPECT_GT(bad.point_to_line_rms, 1.3 * right.point_to_line_rms);
  EXPECT_GT(bad.occupied_cells, right.occupied_cells);
}

TEST(MapQuality, IsTheSameOnAnyNumberOfThreadsAndInAnyFrame) {
  const ScanLog log = room_log(0.01);
  const MapQuality one = map_quality(log, log.map_from_robot, {}, 1);
  const MapQuality three = map_quality(log, log.map_from_robot, {}, 3);
  EXPECT_EQ(one.point_to_line_rms, three.point_to_line_rms);
  EXPECT_EQ(one.points, three.points);
  std::vector<Pose2> moved;
  for (const Pose2& pose : log.map_from_robot) { moved.push_back(Pose2{100, -30, 1.0} * pose); }
  EXPECT_NEAR(map_quality(log, moved).point_to_line_rms, one.point_to_line_rms, 1e-4);
}

TEST(MapQuality, OfNothingIsNothing) {
  const MapQuality quality = map_quality({}, {});
  EXPECT_EQ(quality.points, 0U);
  EXPECT_EQ(quality.point_to_line_rms, 0);
}

}  // namespace
}  // namespace flirt
