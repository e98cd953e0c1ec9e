// flirt/eval/coverage.hpp: is a stated covariance of poses true? How often the truth lies in the region that it draws.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/eval/statistics.hpp"

#include <Eigen/Core>

#include <span>

namespace flirt {

/// eᵀ C⁻¹ e of the error e = (x, y, theta) of a pose in the map frame ("NEES"); +inf for a covariance that is not
/// positive definite. χ² with three degrees of freedom when the covariance is true and errors are normal.
[[nodiscard]] double normalized_squared_error(const Pose2& pose, const Pose2& truth, const Eigen::Matrix3d& covariance);

/// How many errors lie in the regions that should hold 50, 90 and 95 % of them.
struct Coverage {
  Rate within_50{};
  Rate within_90{};
  Rate within_95{};
  double median{0};  ///< of the normalised squared errors; 2.37 when all is true
};

[[nodiscard]] Coverage coverage(std::span<const double> normalized_squared_errors);

}  // namespace flirt
