#include "flirt/features/normal.hpp"

#include "flirt/core/pose2.hpp"
#include "flirt/core/rng.hpp"

#include "tests/support/numbers.hpp"

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace flirt {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

struct Line {
  std::vector<double> x;
  std::vector<double> y;
};

/// Points of the wall x cos α + y sin α = ρ, ρ > 0.
Line wall(double alpha, double rho, int count) {
  Line line;
  for (int i = 0; i < count; ++i) {
    const double along = 0.1 * i * i - 0.3;
    line.x.push_back(rho * std::cos(alpha) - along * std::sin(alpha));
    line.y.push_back(rho * std::sin(alpha) + along * std::cos(alpha));
  }
  return line;
}

TEST(Normals, AreExactOnWallsAndPointAwayFromTheSensor) {
  for (int degrees = -180; degrees < 180; degrees += 7) {
    const double alpha = radians_from_degrees(degrees);
    for (const int window : {3, 5, 9}) {
      const Line line = wall(alpha, 2.5, 12);
      std::vector<double> normals;
      estimate_normals(line.x, line.y, window, false, normals);
      ASSERT_EQ(normals.size(), 12U);
      for (const double normal : normals) { EXPECT_NEAR(wrap_angle(normal - alpha), 0.0, 1e-9); }
    }
  }
}

TEST(Normals, MinimiseThePerpendicularDistances) {
  Rng rng(3);
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 50; ++i) {
    x.push_back(3.0 + rng.normal(0.0, 0.3));
    y.push_back(0.1 * i + rng.normal(0.0, 0.3));
  }
  std::vector<double> normals;
  estimate_normals(x, y, 7, false, normals);
  for (std::size_t i = 3; i + 3 < x.size(); ++i) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (std::size_t j = i - 3; j <= i + 3; ++j) { mean += Eigen::Vector2d(x[j], y[j]) / 7.0; }
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (std::size_t j = i - 3; j <= i + 3; ++j) {
      const Eigen::Vector2d d = Eigen::Vector2d(x[j], y[j]) - mean;
      scatter += d * d.transpose();
    }
    Eigen::Vector2d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(scatter).eigenvectors().col(0);
    if (normal.dot(mean) < 0.0) { normal = -normal; }
    EXPECT_NEAR(std::cos(normals[i]), normal.x(), 1e-9);
    EXPECT_NEAR(std::sin(normals[i]), normal.y(), 1e-9);
  }
}

TEST(Normals, AtTheEndsAreThoseOfTheNearestFullWindow) {
  const std::vector<double> x{1, 1, 1, 2, 3, 3, 3};
  const std::vector<double> y{0, 1, 2, 2, 2, 3, 5};
  std::vector<double> normals;
  estimate_normals(x, y, 3, false, normals);
  EXPECT_EQ(normals[0], normals[1]);
  EXPECT_EQ(normals[6], normals[5]);
}

TEST(Normals, GoAroundAClosedCurve) {
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 60; ++i) {
    x.push_back(2.0 * std::cos(2.0 * pi * i / 60));
    y.push_back(2.0 * std::sin(2.0 * pi * i / 60));
  }
  std::vector<double> normals;
  estimate_normals(x, y, 5, true, normals);
  for (std::size_t i = 0; i < 60; ++i) {
    EXPECT_NEAR(wrap_angle(normals[i] - 2.0 * pi * static_cast<double>(i) / 60), 0.0, 1e-9);
  }
  EXPECT_NEAR(unwrap(normals), 2.0 * pi, 1e-12);
  for (std::size_t i = 1; i < 60; ++i) { EXPECT_NEAR(normals[i] - normals[i - 1], 2.0 * pi / 60, 1e-9); }
}

TEST(Normals, ExistForOneAndTwoPoints) {
  std::vector<double> normals;
  estimate_normals(std::vector<double>{}, std::vector<double>{}, 3, true, normals);
  EXPECT_TRUE(normals.empty());
  estimate_normals(std::vector<double>{1.0}, std::vector<double>{0.0}, 3, true, normals);
  EXPECT_THAT(normals, Each(::testing::Truly([](double angle) { return std::isfinite(angle); })));
  estimate_normals(std::vector<double>{1.0, 2.0}, std::vector<double>{0.0, 5.0}, 3, false, normals);
  EXPECT_EQ(normals.size(), 2U);
}

TEST(Unwrap, LeavesNoJumpAboveHalfATurn) {
  std::vector<double> angles{3.0, -3.0, 2.5, -2.5 + 2 * pi, 1.0};
  const double turn = unwrap(angles);
  for (std::size_t i = 1; i < angles.size(); ++i) { EXPECT_LE(std::abs(angles[i] - angles[i - 1]), pi + 1e-12); }
  EXPECT_EQ(turn, 0.0);
  std::vector<double> none;
  EXPECT_EQ(unwrap(none), 0.0);
}

}  // namespace
}  // namespace flirt
