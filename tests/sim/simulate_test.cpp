#include "flirt/sim/simulate.hpp"

#include "flirt/io/floor_plan.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/ray_caster.hpp"

#include "tests/support/data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace flirt {
namespace {

SimulateParams short_drive() {
  SimulateParams params;
  params.drive.round_length = 15;
  return params;
}

Simulation simulated(const World& world, const SimulateParams& params) {
  auto simulation = simulate(world, params);
  EXPECT_TRUE(simulation) << simulation.error().message;
  return std::move(*simulation);
}

void expect_same_bits(const Simulation& a, const Simulation& b) {
  ASSERT_EQ(a.log.scans.size(), b.log.scans.size());
  EXPECT_EQ(a.log.map_from_robot, b.log.map_from_robot);
  for (std::size_t i = 0; i < a.log.scans.size(); ++i) {
    EXPECT_EQ(a.log.scans[i].ranges, b.log.scans[i].ranges);
    EXPECT_EQ(a.log.scans[i].stamp, b.log.scans[i].stamp);
    EXPECT_EQ(a.log.scans[i].odom_from_robot, b.log.scans[i].odom_from_robot);
  }
}

TEST(Simulate, GivesTheSameBitsOnAnyNumberOfThreads) {
  const World office = make_office({.area = 600});
  SimulateParams params = short_drive();
  params.people.count = 6;
  params.threads = 1;
  const Simulation one = simulated(office, params);
  for (const std::size_t threads : {2U, 5U}) {
    params.threads = threads;
    expect_same_bits(simulated(office, params), one);
  }
}

TEST(Simulate, OtherSeedsGiveOtherLogs) {
  const World office = make_office({.area = 600});
  SimulateParams params = short_drive();
  const Simulation first = simulated(office, params);
  params.seed = 1;
  EXPECT_NE(simulated(office, params).log.map_from_robot, first.log.map_from_robot);
}

TEST(Simulate, PerfectScannerAgreesWithTheTruePoses) {
  const World office = make_office({.area = 600, .glass_fronts = 0});
  SimulateParams params = short_drive();
  params.lidar = {.mount_x = 0.2,
                  .mount_y = -0.1,
                  .mount_theta = 0.3,
                  .noise = 0,
                  .noise_per_metre = 0,
                  .resolution = 0,
                  .dropouts = 0,
                  .mixed_pixels = 0};
  const Simulation simulation = simulated(office, params);
  const RayCaster caster(simulation.plan);
  ASSERT_GT(simulation.log.scans.size(), 50U);
  for (std::size_t i = 0; i < simulation.log.scans.size(); ++i) {
    const Scan& scan = simulation.log.scans[i];
    const std::vector<double> expected = caster.cast(simulation.log.map_from_sensor(i), scan.beams, 360);
    for (std::size_t beam = 0; beam < 360; ++beam) { ASSERT_NEAR(scan.ranges[beam], expected[beam], 1e-7); }
  }
}

TEST(Simulate, OdometryWithoutErrorsIsTheTruthAndDriftsWithThem) {
  const World office = make_office({.area = 600});
  SimulateParams params = short_drive();
  const Simulation drifting = simulated(office, params);
  EXPECT_GT(distance(*drifting.log.scans.back().odom_from_robot, drifting.log.map_from_robot.back()), 0.01);
  params.odometry = {.translation_noise = 0,
                     .rotation_noise = 0,
                     .heading_noise = 0,
                     .translation_bias = 0,
                     .rotation_bias = 0,
                     .heading_bias = 0};
  const Simulation exact = simulated(office, params);
  for (std::size_t i = 0; i < exact.log.scans.size(); ++i) {
    EXPECT_NEAR(distance(*exact.log.scans[i].odom_from_robot, exact.log.map_from_robot[i]), 0, 1e-9);
  }
  params.odometry.mode = OdometryMode::none;
  EXPECT_FALSE(simulated(office, params).log.scans[3].odom_from_robot);
}

TEST(Simulate, PeopleHideWhatIsBehindThemAndNothingElseChanges) {
  const World office = make_office({.area = 500});
  SimulateParams params = short_drive();
  params.lidar = {
      .noise = 0, .noise_per_metre = 0, .resolution = 0, .dropouts = 0, .mixed_pixels = 0, .glass_returns = 0};
  const Simulation empty = simulated(office, params);
  params.people.count = 30;
  const Simulation crowded = simulated(office, params);
  EXPECT_EQ(empty.log.map_from_robot, crowded.log.map_from_robot);
  std::size_t nearer = 0;
  for (std::size_t i = 0; i < empty.log.scans.size(); ++i) {
    for (std::size_t beam = 0; beam < 360; ++beam) {
      EXPECT_LE(crowded.log.scans[i].ranges[beam], empty.log.scans[i].ranges[beam]);
      nearer += crowded.log.scans[i].ranges[beam] < empty.log.scans[i].ranges[beam] ? 1U : 0U;
    }
  }
  EXPECT_GT(nearer, 360U);
}

TEST(Simulate, RoundsFollowEachOther) {
  SimulateParams params = short_drive();
  params.drive.rounds = 3;
  const Simulation simulation = simulated(make_office({.area = 600}), params);
  ASSERT_EQ(simulation.round_begin.size(), 3U);
  EXPECT_EQ(simulation.round_begin[0], 0U);
  EXPECT_LT(simulation.round_begin[1], simulation.round_begin[2]);
  EXPECT_LT(simulation.round_begin[2], simulation.log.scans.size());
  for (std::size_t i = 1; i < simulation.log.scans.size(); ++i) {
    EXPECT_GT(simulation.log.scans[i].stamp, simulation.log.scans[i - 1].stamp);
  }
}

TEST(Simulate, SaysSoWhenTheRobotFitsNowhere) {
  SimulateParams params;
  params.drive.robot_radius = 5;
  const auto simulation = simulate(make_office({.area = 500}), params);
  ASSERT_FALSE(simulation);
  EXPECT_THAT(simulation.error().message, testing::HasSubstr("radius 5"));
  EXPECT_FALSE(simulate(World{}));
}

TEST(Simulate, RefusesPlansTooWideForGridsOverThem) {
  for (const double far : {1e5, 1e9, 1e308}) {
    const World world{
        {.segments = {{{0, 0}, {9, 0}}, {{9, 0}, {9, 9}}, {{9, 9}, {0, far}}, {{0, far}, {0, 0}}}}, {}, {}};
    EXPECT_THAT(simulate(world).error().message, testing::HasSubstr("expected a plan of up to 10 km x 10 km"));
  }
}

TEST(Simulate, DrivesThroughEveryPublishedMap) {
  const auto maps = data_file("maps");
  if (!maps) { GTEST_SKIP() << "maps is not there"; }
  struct Source {
    const char* file;
    std::optional<double> resolution;
  };
  for (const Source& source : {Source{"amrl/GDC1.vectormap.txt", {}},
                               {"amrl/GHC3.vectormap.txt", {}},
                               {"amrl/orebro.vectormap.txt", {}},
                               {"stdr/frieburg.yaml", {}},
                               {"stdr/robocup.yaml", {}},
                               {"stdr/mines.yaml", {}},
                               {"stdr/simple_rooms.yaml", {}},
                               {"stage/cave.png", 0.04},
                               {"stage/autolab.png", 0.05},
                               {"stage/hospital_section.png", 0.05},
                               {"willow/willow-full-0.05.pgm", 0.05}}) {
    const auto plan = read_floor_plan(*maps / source.file, source.resolution);
    ASSERT_TRUE(plan) << plan.error().message;
    SimulateParams params = short_drive();
    params.drive.rounds = 1;
    const auto simulation = simulate({*plan, {}}, params);
    ASSERT_TRUE(simulation) << source.file << ": " << simulation.error().message;
    EXPECT_GT(simulation->log.scans.size(), 40U) << source.file;
    std::size_t hits = 0;
    for (std::size_t i = 0; i < simulation->log.scans.size(); ++i) {
      EXPECT_GE(distance_to_surface(*plan, simulation->log.map_from_robot[i].translation()), 0.25) << source.file;
      hits += hit_points(simulation->log.scans[i]).size();
    }
    EXPECT_GT(hits, 100 * simulation->log.scans.size()) << source.file;
  }
}

}  // namespace
}  // namespace flirt
