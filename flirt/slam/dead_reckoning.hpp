// flirt/slam/dead_reckoning.hpp: what is known of a motion before the scans are compared.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/slam/slam_params.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>

namespace flirt {

/// Whether odometry tells of a motion that no robot makes.
enum class OdometryJump : std::uint8_t {
  none,
  perhaps,   ///< much farther than of late, in a time that is not known
  probable,  ///< much faster than of late
  certain,   ///< farther than any map of one place
};

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
  /// What the scans said of the step before, whatever odometry tells of this one.
  [[nodiscard]] const Pose2& last_motion() const { return last_motion_; }
  /// A counter was set back, say, or a message damaged: three times as fast as of late and over 3 m/s, or, where stamps
  /// tell nothing, three times as far; in any case over 1.5 m.
  [[nodiscard]] OdometryJump odometry_jump(const SlamScan& scan) const {
    constexpr double shortest = 1.5;   // m
    constexpr double longest = 100;    // m
    constexpr double slowest = 3;      // m/s
    constexpr std::size_t fewest = 5;  // steps to compare with
    if (!uses_odometry(scan)) { return OdometryJump::none; }
    const double way = norm(motion(scan).translation());
    if (way < shortest) { return OdometryJump::none; }
    const double seconds = scan.scan.stamp - last_stamp_;
    if (way > longest) { return OdometryJump::certain; }
    if (seconds > 0 && speeds_.size() >= fewest) {
      return way > seconds * std::max(slowest, 3 * std::ranges::max(speeds_)) ? OdometryJump::probable
                                                                              : OdometryJump::none;
    }
    return way > 3 * longest_step() ? OdometryJump::perhaps : OdometryJump::none;
  }
  /// m, of the last motions.
  [[nodiscard]] double longest_step() const { return steps_.empty() ? 0 : std::ranges::max(steps_); }
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
    const double seconds = scan.scan.stamp - last_stamp_;
    last_stamp_ = scan.scan.stamp;
    if (is_first_) {
      is_first_ = false;
      return;
    }
    keep_last(steps_, norm(found.translation()));
    if (seconds > 0) { keep_last(speeds_, norm(found.translation()) / seconds); }
  }
  /// The last motion says nothing of the next one.
  void forget_motion() { last_motion_ = {}; }

 private:
  static void keep_last(std::deque<double>& values, double value) {
    constexpr std::size_t remembered = 20;
    values.push_back(value);
    if (values.size() > remembered) { values.pop_front(); }
  }

  SlamParams params_;
  std::optional<Pose2> last_odometry_{};
  Pose2 last_motion_{};
  double last_stamp_{0};         ///< s
  bool is_first_{true};          ///< no scan was seen
  std::deque<double> steps_{};   ///< m, of the last motions found
  std::deque<double> speeds_{};  ///< m/s, of those whose stamps tell how long they took
  bool has_moved_{false};        ///< odometry did, ever
};

}  // namespace flirt
