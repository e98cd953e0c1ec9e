#include "flirt/match/rigid.hpp"

#include "flirt/core/rng.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace flirt {
namespace {

constexpr Pose2 true_motion{1.5, -0.7, 2.3};

std::vector<PointPair> exact_pairs(std::initializer_list<Point2> points) {
  std::vector<PointPair> pairs;
  for (const Point2 point : points) { pairs.push_back({point, true_motion * point}); }
  return pairs;
}

TEST(FitRigid, RecoversAnExactMotion) {
  for (const auto& pairs : {exact_pairs({{0, 0}, {1, 0}}), exact_pairs({{3, 4}, {-1, 2}, {0.5, -9}, {7, 7}})}) {
    const auto motion = fit_rigid(pairs);
    ASSERT_TRUE(motion);
    const Pose2 pose = motion->pose();
    EXPECT_NEAR(pose.x, true_motion.x, 1e-12);
    EXPECT_NEAR(pose.y, true_motion.y, 1e-12);
    EXPECT_NEAR(pose.theta, true_motion.theta, 1e-12);
    const Point2 point{-2, 5};
    EXPECT_LT(norm(*motion * point - pose * point), 1e-12);
  }
}

TEST(FitRigid, HasNoNeighbourOfSmallerResidual) {
  Rng rng(1);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<PointPair> pairs;
    for (int i = 0; i < 5; ++i) {
      pairs.push_back({{rng.normal(), rng.normal()}, {rng.normal(0.0, 2.0), rng.normal(0.0, 2.0)}});
    }
    const auto best = fit_rigid(pairs);
    ASSERT_TRUE(best);
    const double least = sum_of_squares(pairs, best->pose());
    for (int direction = 0; direction < 3; ++direction) {
      for (const double step : {-1e-4, 1e-4}) {
        Pose2 near = best->pose();
        (direction == 0 ? near.x : direction == 1 ? near.y : near.theta) += step;
        EXPECT_GT(sum_of_squares(pairs, near), least);
      }
    }
  }
}

TEST(FitRigid, IsNothingWhereNoRotationIsBest) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(fit_rigid({}));
  EXPECT_FALSE(fit_rigid(exact_pairs({{1, 2}})));
  EXPECT_FALSE(fit_rigid(exact_pairs({{1, 2}, {1, 2}})));
  EXPECT_FALSE(fit_rigid(std::vector<PointPair>{{{0, 0}, {5, 5}}, {{1, 0}, {5, 5}}})) << "a side that coincides";
  EXPECT_FALSE(
      fit_rigid(std::vector<PointPair>{{{1, 0}, {1, 0}}, {{-1, 0}, {-1, 0}}, {{0, 1}, {0, -1}}, {{0, -1}, {0, 1}}}))
      << "a mirror image fits at any turn";
  EXPECT_FALSE(fit_rigid(std::vector<PointPair>{{{0, 0}, {0, 0}}, {{1, 0}, {nan, 0}}}));
  EXPECT_FALSE(fit_rigid(std::vector<PointPair>{{{0, 0}, {0, 0}}, {{1, infinity}, {1, 0}}}));
}

TEST(FitRigid, MovesWithEitherFrame) {
  Rng rng(2);
  std::vector<PointPair> pairs;
  for (int i = 0; i < 6; ++i) { pairs.push_back({{rng.normal(), rng.normal()}, {rng.normal(), rng.normal()}}); }
  const Pose2 fit = fit_rigid(pairs)->pose();
  const Pose2 other_from_reference{-3, 8, -1};
  for (PointPair& pair : pairs) { pair.reference = other_from_reference * pair.reference; }
  const Pose2 moved = fit_rigid(pairs)->pose();
  const Pose2 expected = other_from_reference * fit;
  EXPECT_LT(distance(moved, expected), 1e-12);
  EXPECT_LT(heading_difference(moved, expected), 1e-12);
}

TEST(RigidCovariance, IsTheNumericalDerivativeOfTheFit) {
  std::vector<PointPair> pairs = exact_pairs({{3, 4}, {-1, 2}, {0.5, -9}, {7, 7}});
  Rng rng(3);
  for (PointPair& pair : pairs) {  // residuals matter to the derivative
    pair.reference = pair.reference + Point2{rng.normal(0.0, 0.2), rng.normal(0.0, 0.2)};
  }
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  const double step = 1e-6;
  for (PointPair& pair : pairs) {
    for (double* coordinate : {&pair.query.x, &pair.query.y, &pair.reference.x, &pair.reference.y}) {
      const double kept = *coordinate;
      *coordinate = kept + step;
      const Pose2 above = fit_rigid(pairs)->pose();
      *coordinate = kept - step;
      const Pose2 below = fit_rigid(pairs)->pose();
      *coordinate = kept;
      const Eigen::Vector3d derivative{(above.x - below.x) / (2 * step), (above.y - below.y) / (2 * step),
                                       (above.theta - below.theta) / (2 * step)};
      expected += 0.05 * 0.05 * derivative * derivative.transpose();
    }
  }
  EXPECT_TRUE(rigid_covariance(pairs, 0.05).isApprox(expected, 1e-6));
}

TEST(RigidCovariance, OfManyPointsShrinksLikeOneOverCount) {
  std::vector<PointPair> pairs = exact_pairs({{1, 0}, {0, 1}, {-1, 0}, {0, -1}});
  const Eigen::Matrix3d few = rigid_covariance(pairs, 0.1);
  EXPECT_NEAR(few(0, 0), 2 * 0.01 / 4, 1e-12);  // both scans' errors, averaged over four points about the origin
  EXPECT_NEAR(few(2, 2), 2 * 0.01 / 4, 1e-12);  // Σ|q'|² = 4 m²
  const std::vector<PointPair> once = pairs;
  for (int copy = 0; copy < 9; ++copy) { pairs.insert(pairs.end(), once.begin(), once.end()); }
  EXPECT_TRUE(rigid_covariance(pairs, 0.1).isApprox(few / 10, 1e-9));
}

/// Squared Mahalanobis distances of many noisy fits from the truth, sorted; χ² with 3 degrees of freedom if the
/// covariance is right.
std::vector<double> squared_errors(std::size_t points, double deviation, bool own_deviation) {
  Rng rng(4);
  std::vector<double> errors;
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<PointPair> pairs;
    for (std::size_t i = 0; i < points; ++i) {
      const Point2 point{rng.uniform(-8.0, 8.0), rng.uniform(-8.0, 8.0)};
      const auto noise = [&] { return Point2{rng.normal(0.0, deviation), rng.normal(0.0, deviation)}; };
      pairs.push_back({point + noise(), true_motion * point + noise()});
    }
    const Pose2 fit = fit_rigid(pairs)->pose();
    const double used = own_deviation ? deviation_from_residuals(pairs, fit) : deviation;
    const Eigen::Vector3d error{fit.x - true_motion.x, fit.y - true_motion.y,
                                wrap_angle(fit.theta - true_motion.theta)};
    errors.push_back(error.dot(rigid_covariance(pairs, used).inverse() * error));
  }
  std::ranges::sort(errors);
  return errors;
}

double share_below(const std::vector<double>& sorted, double limit) {
  return static_cast<double>(std::ranges::lower_bound(sorted, limit) - sorted.begin()) /
         static_cast<double>(sorted.size());
}

TEST(RigidCovariance, IsConsistentInMonteCarlo) {
  for (const std::size_t points : {3U, 8U, 25U}) {
    const std::vector<double> errors = squared_errors(points, 0.05, false);
    double mean = 0.0;
    for (const double error : errors) { mean += error / static_cast<double>(errors.size()); }
    // Standard deviation of the mean of 20000 draws is √(6 / 20000) = 0.017; shares vary by at most 0.0035.
    EXPECT_NEAR(mean, 3.0, 0.1) << points;
    EXPECT_NEAR(share_below(errors, 2.366), 0.50, 0.015) << points;  // quantiles of χ²₃
    EXPECT_NEAR(share_below(errors, 6.251), 0.90, 0.01) << points;
    EXPECT_NEAR(share_below(errors, 7.815), 0.95, 0.01) << points;
  }
}

TEST(RigidCovariance, FromResidualsIsConsistentForManyPoints) {
  const std::vector<double> errors = squared_errors(40, 0.05, true);  // F(3, 77) is close to χ²₃ / 3
  EXPECT_NEAR(share_below(errors, 2.366), 0.50, 0.02);
  EXPECT_NEAR(share_below(errors, 7.815), 0.95, 0.015);
}

TEST(DeviationFromResiduals, FindsTheNoiseThatWasAdded) {
  Rng rng(5);
  double sum = 0.0;
  const int trials = 4000;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<PointPair> pairs;
    for (int i = 0; i < 6; ++i) {
      const Point2 point{rng.uniform(-8.0, 8.0), rng.uniform(-8.0, 8.0)};
      const auto noise = [&] { return Point2{rng.normal(0.0, 0.03), rng.normal(0.0, 0.03)}; };
      pairs.push_back({point + noise(), true_motion * point + noise()});
    }
    const double deviation = deviation_from_residuals(pairs, fit_rigid(pairs)->pose());
    sum += deviation * deviation;
  }
  EXPECT_NEAR(std::sqrt(sum / trials), 0.03, 0.0005);
}

}  // namespace
}  // namespace flirt
