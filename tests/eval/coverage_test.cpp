#include "flirt/eval/coverage.hpp"

#include "flirt/core/rng.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace flirt {
namespace {

TEST(NormalizedSquaredError, CountsEachErrorInItsDeviations) {
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.04, 0.25, 0.01).asDiagonal();
  // 0.4 m of 0.2, 0.5 m of 0.5, 0.1 rad of 0.1, the heading across ±π.
  const Pose2 truth{1, 2, 3.1};
  const Pose2 pose{1.4, 1.5, wrap_angle(3.2)};
  EXPECT_NEAR(normalized_squared_error(pose, truth, covariance), 4 + 1 + 1, 1e-9);
}

TEST(NormalizedSquaredError, IsInfiniteForACovarianceThatIsNone) {
  EXPECT_EQ(normalized_squared_error({}, {}, Eigen::Matrix3d::Zero()), std::numeric_limits<double>::infinity());
}

TEST(Coverage, OfErrorsThatTheCovarianceDescribesIsWhatTheRegionsPromise) {
  Eigen::Matrix3d covariance;
  covariance << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.01;
  const Eigen::Matrix3d root = covariance.llt().matrixL();
  Rng rng(3);
  std::vector<double> errors;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d error = root * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    errors.push_back(normalized_squared_error({error.x(), error.y(), error.z()}, {}, covariance));
  }
  const Coverage found = coverage(errors);
  EXPECT_NEAR(found.within_50.value(), 0.5, 0.025);
  EXPECT_NEAR(found.within_90.value(), 0.9, 0.015);
  EXPECT_NEAR(found.within_95.value(), 0.95, 0.011);
  EXPECT_NEAR(found.median, 2.366, 0.12);
}

}  // namespace
}  // namespace flirt
