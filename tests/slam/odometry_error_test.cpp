#include "flirt/slam/odometry_error.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

namespace flirt {
namespace {

/// After `motions` of 0.4 m, of which odometry tells `scale` times as much, off by `deviation`.
OdometryError learned(int motions, double scale, double deviation) {
  OdometryError error;
  Rng rng(5);
  for (int i = 0; i < motions; ++i) {
    const Pose2 found{0.4, 0, 0.02};
    error.learn({scale * 0.4 + deviation * rng.normal(), deviation * rng.normal(), 0.02}, found);
  }
  return error;
}

TEST(OdometryError, IsThatOfACommonRobotBeforeItIsLearned) {
  const Pose2 told{0.4, 0, 0};
  const double common = OdometryError{}.deviation(told);
  EXPECT_GT(common, 0.05);
  EXPECT_LT(common, 0.1);
  EXPECT_EQ(learned(9, 2, 0.1).deviation(told), common);
  EXPECT_EQ(OdometryError{}.corrected(told), told);
}

TEST(OdometryError, IsWhatTheScansSaw) {
  const Pose2 told{0.4, 0, 0};
  const double exact = learned(100, 1, 0.005).deviation(told);
  const double rough = learned(100, 1, 0.05).deviation(told);
  EXPECT_GT(exact, 0.005);
  EXPECT_LT(exact, 0.012);
  EXPECT_NEAR(rough / exact, 10, 2);
  EXPECT_GT(learned(100, 1, 0.005).deviation({0.8, 0, 0}), exact);
}

TEST(OdometryError, WheelsThatAreLargerThanSaidAreMeasured) {
  const OdometryError error = learned(100, 0.9, 0.005);
  EXPECT_NEAR(error.corrected({0.9, 0, 0.5}).x, 1, 0.01);
  EXPECT_EQ(error.corrected({0.9, 0, 0.5}).theta, 0.5);
  EXPECT_LT(error.deviation({0.4, 0, 0}), 0.015);
}

TEST(OdometryError, ForgetsWhatWasLongAgo) {
  OdometryError error = learned(100, 1, 0.1);
  for (int i = 0; i < 100; ++i) { error.learn({0.4, 0, 0}, {0.4, 0, 0}); }
  EXPECT_LT(error.deviation({0.4, 0, 0}), 1e-9);
}

}  // namespace
}  // namespace flirt
