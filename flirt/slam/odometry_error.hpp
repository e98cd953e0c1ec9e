// flirt/slam/odometry_error.hpp: how far off this robot's odometry is, learned while driving.
#pragma once

#include "flirt/core/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace flirt {

/// Compares odometry's last motions with what the scans said where they measured well.
class OdometryError {
 public:
  void learn(const Pose2& told, const Pose2& found) {
    constexpr std::size_t remembered = 100;
    if (motions_.size() < remembered) {
      motions_.push_back({told, found});
    } else {
      motions_[next_] = {told, found};
    }
    next_ = (next_ + 1) % remembered;
    scale_ = scale();
  }

  /// The motion with its translation by the scans' measure: wheels are larger or smaller than they are said to be.
  [[nodiscard]] Pose2 corrected(const Pose2& told) const { return {scale_ * told.x, scale_ * told.y, told.theta}; }

  /// m, deviation of the corrected translation in any direction: four of five errors were smaller in both. Before ten
  /// motions were learned that of a common robot.
  [[nodiscard]] double deviation(const Pose2& told) const {
    constexpr std::size_t fewest = 10;
    constexpr double common = 0.15;
    if (motions_.size() < fewest) { return common * extent(told); }
    std::vector<double> shares;
    for (const Motion& motion : motions_) {
      const Pose2 off = inverse(corrected(motion.told)) * motion.found;
      shares.push_back(norm(off.translation()) / extent(motion.told));
    }
    const auto quantile = shares.begin() + static_cast<std::ptrdiff_t>(4 * shares.size() / 5);
    std::ranges::nth_element(shares, quantile);
    return *quantile * extent(told);
  }

 private:
  struct Motion {
    Pose2 told;
    Pose2 found;
  };
  /// m; a robot that stands or turns on the spot is told to have moved by some millimetres, too.
  static double extent(const Pose2& told) { return 0.05 + norm(told.translation()) + 0.2 * std::abs(told.theta); }

  /// Least squares of found ≈ scale · told, and of scale ≈ 1 with the weight of some metres.
  [[nodiscard]] double scale() const {
    constexpr double prior = 1;  // m²
    constexpr double most = 0.2;
    double products = prior;
    double squares = prior;
    for (const Motion& motion : motions_) {
      products += dot(motion.told.translation(), motion.found.translation());
      squares += dot(motion.told.translation(), motion.told.translation());
    }
    return std::clamp(products / squares, 1 - most, 1 + most);
  }

  std::vector<Motion> motions_{};
  std::size_t next_{0};  ///< place of the motion that is forgotten next
  double scale_{1};
};

}  // namespace flirt
