// flirt/slam/odometry_error.hpp: how far off this robot's odometry is, learned while driving.
#pragma once

#include "flirt/core/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace flirt {

/// Translation errors of odometry's last motions that the scans measured well, as shares of what was driven.
class OdometryError {
 public:
  void learn(const Pose2& told, const Pose2& found) {
    constexpr std::size_t remembered = 50;  // motions
    const double share = norm((inverse(told) * found).translation()) / extent(told);
    if (shares_.size() < remembered) {
      shares_.push_back(share);
    } else {
      shares_[next_] = share;
    }
    next_ = (next_ + 1) % remembered;
  }

  /// m, deviation of a motion's translation in any direction: four of five errors were smaller in both. Before ten
  /// motions were learned that of a common robot.
  [[nodiscard]] double deviation(const Pose2& told) const {
    constexpr std::size_t fewest = 10;
    constexpr double common = 0.15;
    if (shares_.size() < fewest) { return common * extent(told); }
    std::vector<double> sorted = shares_;
    const auto quantile = sorted.begin() + static_cast<std::ptrdiff_t>(4 * sorted.size() / 5);
    std::ranges::nth_element(sorted, quantile);
    return *quantile * extent(told);
  }

 private:
  /// m; a robot that stands or turns on the spot is told to have moved by some millimetres, too.
  static double extent(const Pose2& told) { return 0.05 + norm(told.translation()) + 0.2 * std::abs(told.theta); }

  std::vector<double> shares_{};
  std::size_t next_{0};  ///< place of the share that is forgotten next
};

}  // namespace flirt
