// flirt/match/alignment.hpp: what matching two scans yields.
#pragma once

#include "flirt/core/pose2.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace flirt {

/// A candidate correspondence: a keypoint of the query, one of the reference, and the distance of their descriptors.
struct Match {
  std::uint32_t query{0};
  std::uint32_t reference{0};
  float distance{0};

  friend bool operator==(const Match&, const Match&) = default;
};

/// A rigid motion that a set of matches agrees on.
struct Alignment {
  Pose2 reference_from_query{};                         ///< maps query sensor coordinates into the reference sensor's
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};  ///< of (x, y, theta) of `reference_from_query`: m², m·rad, rad²
  std::vector<Match> inliers{};
  double residual{0};  ///< m², mean truncated squared distance over all query keypoints (item 44)
};

}  // namespace flirt
