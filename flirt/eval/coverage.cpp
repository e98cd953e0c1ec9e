#include "flirt/eval/coverage.hpp"

#include <Eigen/Cholesky>

#include <limits>
#include <vector>

namespace flirt {
namespace {

Rate share_below(std::span<const double> values, double bound) {
  Rate rate{0, values.size()};
  for (const double value : values) { rate.hits += value <= bound ? 1 : 0; }
  return rate;
}

}  // namespace

double normalized_squared_error(const Pose2& pose, const Pose2& truth, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d error(pose.x - truth.x, pose.y - truth.y, wrap_angle(pose.theta - truth.theta));
  const Eigen::LLT<Eigen::Matrix3d> root(covariance);
  if (root.info() != Eigen::Success) { return std::numeric_limits<double>::infinity(); }
  return error.dot(root.solve(error));
}

Coverage coverage(std::span<const double> normalized_squared_errors) {
  constexpr double quantile_50 = 2.366;  // of χ² with three degrees of freedom
  constexpr double quantile_90 = 6.251;
  constexpr double quantile_95 = 7.815;
  return {.within_50 = share_below(normalized_squared_errors, quantile_50),
          .within_90 = share_below(normalized_squared_errors, quantile_90),
          .within_95 = share_below(normalized_squared_errors, quantile_95),
          .median = quantile({normalized_squared_errors.begin(), normalized_squared_errors.end()}, 0.5)};
}

}  // namespace flirt
