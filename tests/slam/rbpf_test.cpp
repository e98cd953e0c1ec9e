#include "flirt/slam/rbpf.hpp"

#include "flirt/eval/trajectory_metrics.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace flirt {
namespace {

/// 40 m through a small building.
const ScanLog& filter_building() {
  static const ScanLog log = [] {
    SimulateParams params{.seed = 4};
    params.drive.rounds = 2;
    params.drive.round_length = 20;
    params.odometry.heading_noise = 0.03;
    return simulate(make_office({.area = 500, .seed = 2}), params)->log;
  }();
  return log;
}

std::vector<Pose2> filtered(const ScanLog& log, const RbpfParams& params, std::uint64_t seed = 0,
                            std::size_t threads = 1) {
  Rbpf filter(params, seed, threads);
  for (const Scan& scan : log.scans) { filter.add(scan); }
  return filter.trajectory();
}

double error_of(const std::vector<Pose2>& estimate, const std::vector<Pose2>& truth) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < truth.size(); ++i) { pairs.push_back({.estimate = estimate[i], .truth = truth[i]}); }
  return absolute_error(pairs).translation.rmse;
}

TEST(Rbpf, CorrectsOdometryToCentimetres) {
  const ScanLog& log = filter_building();
  std::vector<Pose2> odometry;
  for (const Scan& scan : log.scans) { odometry.push_back(*scan.odom_from_robot); }
  EXPECT_GT(error_of(odometry, log.map_from_robot), 0.2);
  EXPECT_LT(error_of(filtered(log, {.particles = 8}), log.map_from_robot), 0.08);
}

TEST(Rbpf, GivesTheSamePosesOnAnyNumberOfThreadsAndOthersForAnotherSeed) {
  ScanLog log = filter_building();
  log.scans.resize(40);
  const RbpfParams params{.particles = 6, .resample_share = 1};  // resamples all the time
  const std::vector<Pose2> one = filtered(log, params, 1, 1);
  EXPECT_EQ(one, filtered(log, params, 1, 3));
  EXPECT_NE(one, filtered(log, params, 2, 1));
}

TEST(Rbpf, PlacesAScanOfAStandingRobotByOdometryAlone) {
  ScanLog log = filter_building();
  log.scans.resize(6);
  log.scans.push_back(log.scans.back());
  log.scans.back().odom_from_robot = *log.scans.back().odom_from_robot * Pose2{0.04, 0, 0.01};
  Rbpf filter({.particles = 4});
  for (const Scan& scan : log.scans) { filter.add(scan); }
  EXPECT_EQ(filter.summary().scans, 7U);
  EXPECT_EQ(filter.summary().updates, 6U);
  const std::vector<Pose2> poses = filter.trajectory();
  const Pose2 moved = inverse(poses[5]) * poses[6];
  EXPECT_NEAR(moved.x, 0.04, 1e-9);
  EXPECT_NEAR(moved.theta, 0.01, 1e-9);
}

TEST(Rbpf, GoesOnAsBeforeWithoutOdometry) {
  ScanLog log = filter_building();
  log.scans.resize(30);
  log.map_from_robot.resize(30);
  EXPECT_LT(error_of(filtered(log, {.particles = 4, .odometry = OdometryUse::ignore}), log.map_from_robot), 0.3);
}

TEST(Rbpf, TakesScansWithoutAnyReturn) {
  ScanLog log = filter_building();
  log.scans.resize(8);
  for (const std::size_t i : {0U, 4U}) { std::ranges::fill(log.scans[i].ranges, 0.0); }
  const std::vector<Pose2> poses = filtered(log, {.particles = 3, .start_x = 5});
  ASSERT_EQ(poses.size(), 8U);
  EXPECT_EQ(poses[0], (Pose2{5, 0, 0}));
  for (const Pose2& pose : poses) { EXPECT_TRUE(is_finite(pose)); }
}

TEST(Rbpf, HasNoTrajectoryBeforeTheFirstScan) {
  EXPECT_TRUE(Rbpf().trajectory().empty());
}

}  // namespace
}  // namespace flirt
