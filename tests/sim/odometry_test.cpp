#include "flirt/sim/odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace flirt {
namespace {

OdometryParams exact() {
  return {.translation_noise = 0,
          .rotation_noise = 0,
          .heading_noise = 0,
          .translation_bias = 0,
          .rotation_bias = 0,
          .heading_bias = 0};
}

std::vector<Pose2> straight(int steps, double step) {
  std::vector<Pose2> poses;
  for (int i = 0; i <= steps; ++i) { poses.push_back({3 + i * step, 4, 0}); }
  return poses;
}

std::vector<Pose2> circle(int steps) {
  std::vector<Pose2> poses;
  for (int i = 0; i <= steps; ++i) {
    const double angle = 2 * 3.141592653589793 * i / steps;
    poses.push_back({5 * std::sin(angle), 5 - 5 * std::cos(angle), wrap_angle(angle)});
  }
  return poses;
}

TEST(Odometry, WithoutErrorsIsTheTruth) {
  const std::vector<Pose2> truth = circle(200);
  const std::vector<Pose2> odometry = drifting_odometry(truth, exact(), 1);
  ASSERT_EQ(odometry.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(distance(odometry[i], truth[i]), 0, 1e-9);
    EXPECT_NEAR(heading_difference(odometry[i], truth[i]), 0, 1e-9);
  }
}

TEST(Odometry, TranslationBiasStretchesTheWay) {
  OdometryParams params = exact();
  params.translation_bias = 0.03;
  EXPECT_NEAR(drifting_odometry(straight(100, 0.1), params, 1).back().x, 3 + 10.3, 1e-9);
}

TEST(Odometry, RotationBiasStretchesTurns) {
  OdometryParams params = exact();
  params.rotation_bias = 0.05;
  EXPECT_NEAR(drifting_odometry(circle(100), params, 1).back().theta, 0.05 * 2 * 3.141592653589793, 1e-9);
}

TEST(Odometry, HeadingBiasPullsToTheLeft) {
  OdometryParams params = exact();
  params.heading_bias = 0.01;
  const Pose2 end = drifting_odometry(straight(100, 0.1), params, 1).back();
  EXPECT_NEAR(end.theta, 0.1, 1e-9);
  EXPECT_NEAR(end.y, 4 + (1 - std::cos(0.1)) / 0.01, 1e-3);
}

/// Deviations over many runs: those stated, however finely the way is cut.
TEST(Odometry, NoiseGrowsWithTheRootOfTheWayNotWithTheNumberOfReadings) {
  OdometryParams params = exact();
  params.translation_noise = 0.05;
  params.heading_noise = 0.02;
  for (const int steps : {10, 200}) {
    double way_squares = 0;
    double heading_squares = 0;
    constexpr int runs = 1500;
    for (int run = 0; run < runs; ++run) {
      const std::vector<Pose2> odometry =
          drifting_odometry(straight(steps, 9.0 / steps), params, static_cast<std::uint64_t>(run));
      double way = 0;
      for (std::size_t i = 1; i < odometry.size(); ++i) {
        const Pose2 step = inverse(odometry[i - 1]) * odometry[i];
        way += step.x;
      }
      way_squares += (way - 9) * (way - 9);
      heading_squares += odometry.back().theta * odometry.back().theta;
    }
    EXPECT_NEAR(std::sqrt(way_squares / runs), 0.05 * 3, 0.01) << steps;
    EXPECT_NEAR(std::sqrt(heading_squares / runs), 0.02 * 3, 0.004) << steps;
  }
}

TEST(Odometry, StartsAtTheTruthAndRepeatsForEqualSeeds) {
  const std::vector<Pose2> truth = circle(50);
  EXPECT_EQ(drifting_odometry(truth, {}, 3)[0], truth[0]);
  EXPECT_EQ(drifting_odometry(truth, {}, 3), drifting_odometry(truth, {}, 3));
  EXPECT_NE(drifting_odometry(truth, {}, 3), drifting_odometry(truth, {}, 4));
  EXPECT_TRUE(drifting_odometry({}, {}, 3).empty());
}

}  // namespace
}  // namespace flirt
