// flirt/match/rigid.hpp: the rigid motion between two sets of paired points, in closed form, with its covariance.
#pragma once

#include "flirt/core/pose2.hpp"

#include <Eigen/Core>

#include <optional>
#include <span>

namespace flirt {

/// One physical point seen from two frames.
struct PointPair {
  Point2 query;      ///< m, query frame
  Point2 reference;  ///< m, reference frame
};

/// A rigid motion with its rotation ready for use: reference_from_query.
struct RigidMotion {
  double cosine{1};
  double sine{0};
  Point2 translation{};  ///< m

  [[nodiscard]] Pose2 pose() const;
  friend Point2 operator*(const RigidMotion& motion, Point2 p) {
    return {motion.translation.x + motion.cosine * p.x - motion.sine * p.y,
            motion.translation.y + motion.sine * p.x + motion.cosine * p.y};
  }
};

/// reference_from_query of least Σ |reference − reference_from_query · query|². Nothing for fewer than two pairs, when
/// all points of a side coincide, when every rotation fits equally well, or when a coordinate is not finite. O(pairs).
[[nodiscard]] std::optional<RigidMotion> fit_rigid(std::span<const PointPair> pairs);

/// Σ |reference − reference_from_query · query|², m².
[[nodiscard]] double sum_of_squares(std::span<const PointPair> pairs, const Pose2& reference_from_query);

/// Covariance of (x, y, theta) of the fit: the errors of all points, isotropic with standard deviation
/// `point_deviation` per coordinate (m) on both sides and independent, sent through the first derivatives of the
/// closed-form solution at the measured points (P1 §3.2 after Tipaldi, Grisetti and Burgard 2007). `pairs` must have a
/// fit. O(pairs).
[[nodiscard]] Eigen::Matrix3d rigid_covariance(std::span<const PointPair> pairs, double point_deviation);

/// Standard deviation per point and coordinate that the residuals of the fit itself suggest, m:
/// √(Σ|residual|² / (2 (2n − 3))), since a residual carries the errors of two points and the fit uses three of the 2n
/// equations. Needs n ≥ 2.
[[nodiscard]] double deviation_from_residuals(std::span<const PointPair> pairs, const Pose2& reference_from_query);

}  // namespace flirt
