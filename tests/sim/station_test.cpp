#include "flirt/sim/station.hpp"

#include "flirt/sim/simulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace flirt {
namespace {

double way_of(const std::vector<Pose2>& poses) {
  double way = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) { way += distance(poses[i - 1], poses[i]); }
  return way;
}

ScanLog drive(const World& world, std::uint32_t people) {
  SimulateParams params{};
  params.lidar.beams = 90;
  params.drive.rounds = 1;
  params.people.count = people;
  return simulate(world, params)->log;
}

TEST(Station, TunnelIsDrivenFromOneEndToTheOther) {
  const ScanLog log = drive(make_tunnel({}), 0);
  EXPECT_GT(log.map_from_robot.front().x, 45);
  EXPECT_LT(log.map_from_robot.back().x, -5);
  EXPECT_NEAR(way_of(log.map_from_robot), 60, 10);
}

TEST(Station, PeopleFillTheTunnelsWidth) {
  const ScanLog empty = drive(make_tunnel({}), 0);
  const ScanLog crowded = drive(make_tunnel({}), 40);
  std::size_t shorter = 0;
  std::size_t beams = 0;
  for (std::size_t i = 0; i < std::min(empty.scans.size(), crowded.scans.size()); ++i) {
    for (std::size_t k = 0; k < empty.scans[i].ranges.size(); ++k) {
      shorter += crowded.scans[i].ranges[k] < empty.scans[i].ranges[k] - 0.5 ? 1 : 0;
      ++beams;
    }
  }
  EXPECT_GT(shorter, beams / 10);
}

TEST(Station, RoundOfTheStationIsHalfAKilometreAndEndsWhereItBegan) {
  const ScanLog log = drive(make_station({}), 0);
  EXPECT_NEAR(way_of(log.map_from_robot), 500, 60);
  EXPECT_LT(distance(log.map_from_robot.front(), log.map_from_robot.back()), 0.5);
}

TEST(Station, AnotherSeedIsAnotherStation) {
  const World one = make_station({.length = 60, .seed = 1});
  const World same = make_station({.length = 60, .seed = 1});
  const World other = make_station({.length = 60, .seed = 2});
  ASSERT_EQ(one.plan.segments.size(), same.plan.segments.size());
  EXPECT_TRUE(std::ranges::equal(one.plan.segments, same.plan.segments, {}, &PlanSegment::end, &PlanSegment::end));
  EXPECT_FALSE(std::ranges::equal(one.plan.segments, other.plan.segments, {}, &PlanSegment::end, &PlanSegment::end));
}

}  // namespace
}  // namespace flirt
