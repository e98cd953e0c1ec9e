#include "flirt/registration/join_scans.hpp"

#include "flirt/registration/evidence_score.hpp"
#include "flirt/registration/map_fields.hpp"

#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace flirt {
namespace {

Scan seen_from(const Pose2& map_from_robot, const Pose2& odom_from_map) {
  const Pose2 robot_from_sensor{0.2, -0.1, 0.4};
  Scan scan = scan_of(furnished_room(), map_from_robot * robot_from_sensor, turn_beams(), turn_beam_count);
  scan.robot_from_sensor = robot_from_sensor;
  scan.odom_from_robot = odom_from_map * map_from_robot;
  return scan;
}

/// The 90th percentile of the distances of joined points from the room's walls, m.
double distance_from_walls(const ScanPoints& joined, const Pose2& map_from_sensor) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < joined.size(); ++i) {
    const Point2 in_map = map_from_sensor * Point2{joined.x[i], joined.y[i]};
    double nearest = 1e9;
    for (const Wall& wall : furnished_room()) {
      const Point2 along = wall.end - wall.begin;
      const double share = std::clamp(dot(in_map - wall.begin, along) / squared_norm(along), 0.0, 1.0);
      nearest = std::min(nearest, norm(in_map - (wall.begin + share * along)));
    }
    distances.push_back(nearest);
  }
  std::ranges::sort(distances);
  return distances[distances.size() * 9 / 10];
}

TEST(JoinScans, PointsOfEarlierScansLieOnTheWallsSeenFromTheLast) {
  const Pose2 odom_from_map{7, -3, 2};
  const std::vector<Scan> scans{seen_from({-1, 0, 0.3}, odom_from_map), seen_from({0.5, 0.4, -1.2}, odom_from_map)};
  const ScanPoints joined = join_scans(scans);
  const std::size_t own = scan_points(scans.back()).size();
  ASSERT_GT(joined.size(), own + 20);
  const Pose2 map_from_sensor = inverse(odom_from_map) * *scans.back().odom_from_robot * scans.back().robot_from_sensor;
  EXPECT_LT(distance_from_walls(joined, map_from_sensor), 0.01);
}

TEST(JoinScans, OdometryThatIsOffDoesNotDoubleTheWalls) {
  std::vector<Scan> scans{seen_from({-1, 0, 0.3}, {}), seen_from({-0.3, 0.2, -0.4}, {}),
                          seen_from({0.5, 0.4, -1.2}, {})};
  const Pose2 map_from_sensor = *scans.back().odom_from_robot * scans.back().robot_from_sensor;
  for (std::size_t i = 0; i < 2; ++i) {  // slips before the last scan, and once more before the second
    const Pose2 slip{0.1, -0.08, i == 0 ? 0.2 : 0.1};
    scans[i].odom_from_robot = slip * *scans[i].odom_from_robot;
  }
  EXPECT_LT(distance_from_walls(join_scans(scans), map_from_sensor), 0.03);
}

TEST(JoinScans, OnlyTheLastScanHasBeams) {
  const std::vector<Scan> scans{seen_from({-1, 0, 0.3}, {}), seen_from({0.5, 0.4, -1.2}, {})};
  const ScanPoints joined = join_scans(scans);
  const ScanPoints own = scan_points(scans.back());
  for (std::size_t i = 0; i < joined.size(); ++i) { EXPECT_EQ(joined.range[i] > 0, i < own.size()); }
}

TEST(JoinScans, ScansBeforeAGapInTheOdometryAreLeftOut) {
  std::vector<Scan> scans{seen_from({-1, 0, 0.3}, {}), seen_from({0.5, 0.4, -1.2}, {}), seen_from({0, 1, 1}, {})};
  scans[1].odom_from_robot.reset();
  EXPECT_EQ(join_scans(scans).x, scan_points(scans.back()).x);
  EXPECT_EQ(join_scans({}).size(), 0U);
}

TEST(JoinScans, PointsWithoutBeamsLeaveTheShareOfBeamsThroughWallsAsItIs) {
  EvidenceGrid grid;
  grid.add(seen_from({0, 0, 0}, {}), Pose2{0, 0, 0});
  const MapFields fields = map_fields(grid);
  const EvidenceScorer scorer(fields, {});
  const std::vector<Scan> scans{seen_from({-1, 0, 0.3}, {}), seen_from({0.5, 0.4, -1.2}, {})};
  const Pose2 wrong{3, 3, 1};
  const double own = scorer.through(scan_points(scans.back()), wrong);
  EXPECT_GT(own, 0);
  EXPECT_EQ(scorer.through(join_scans(scans), wrong), own);
}

}  // namespace
}  // namespace flirt
