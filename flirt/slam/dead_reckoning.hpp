// flirt/slam/dead_reckoning.hpp: what is known of a motion before the scans are compared.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/slam/slam_params.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <Eigen/Core>

#include <cmath>
#include <optional>

namespace flirt {

/// The motion that odometry tells, or that of the step before where there is none (P1 §3).
class DeadReckoning {
 public:
  explicit DeadReckoning(const SlamParams& params) : params_(params) {}

  /// Odometry that has said the same from the beginning on is none: many a log has zeros there.
  [[nodiscard]] bool uses_odometry(const SlamScan& scan) const {
    const bool is_there =
        params_.odometry == OdometryUse::use && params_.window == 0 && scan.odom_from_robot && last_odometry_;
    return is_there && (has_moved_ || *scan.odom_from_robot != *last_odometry_);
  }
  [[nodiscard]] Pose2 motion(const SlamScan& scan) const {
    return uses_odometry(scan) ? inverse(*last_odometry_) * *scan.odom_from_robot : last_motion_;
  }
  /// Inverse covariance of `motion`.
  [[nodiscard]] Eigen::Matrix3d information(const SlamScan& scan) const {
    const FlirtParams& flirt = params_.flirt;
    Eigen::Vector3d deviation(flirt.constant_translation, flirt.constant_translation, flirt.constant_rotation);
    if (uses_odometry(scan)) {
      constexpr double turn_a_metre = 0.05;  // rad/m
      constexpr double least = 0.05;         // m and rad; also what a turn may shift the robot per rad
      const Pose2 moved = motion(scan);
      const double way = norm(moved.translation());
      const double turn = std::abs(moved.theta);
      const double translation = least + flirt.odometry_translation * way + least * turn;
      deviation = {translation, translation, least + flirt.odometry_rotation * turn + turn_a_metre * way};
    }
    return deviation.cwiseProduct(deviation).cwiseInverse().asDiagonal();
  }
  /// To be told of every scan, with the motion that was found in the end.
  void remember(const SlamScan& scan, const Pose2& found) {
    last_motion_ = found;
    has_moved_ = has_moved_ || (scan.odom_from_robot && last_odometry_ && *scan.odom_from_robot != *last_odometry_);
    last_odometry_ = scan.odom_from_robot;
  }
  /// The last motion says nothing of the next one.
  void forget_motion() { last_motion_ = {}; }

 private:
  SlamParams params_;
  std::optional<Pose2> last_odometry_{};
  Pose2 last_motion_{};
  bool has_moved_{false};  ///< odometry did, ever
};

}  // namespace flirt
