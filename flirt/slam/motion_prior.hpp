// flirt/slam/motion_prior.hpp: how far motions are from what was predicted, learned as the robot drives.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/slam/slam_params.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace flirt {

/// Doors along a corridor look alike: among places that explain a scan about as well, one that asks the robot to leave
/// its way as it never did is the wrong one. Where scans are dense motions go on as they were to a few centimetres;
/// where they are a metre apart the prediction says little.
class MotionPrior {
 public:
  explicit MotionPrior(const SlamParams& params)
      : translation_(params.surprise_translation),
        rotation_(params.surprise_rotation),
        unusual_(params.surprise_unusual) {}

  /// Score lost by a pose that is `off` from the predicted one, m and rad: a part that grows with the distance, and the
  /// logarithm of Student's density about how far the last motions were off.
  [[nodiscard]] double surprise(const Pose2& off) const {
    const double translation = norm(off.translation());
    const double rotation = std::abs(off.theta);
    const double linear = translation_ * translation + rotation_ * rotation;
    if (learned_ < fewest) { return linear; }
    const auto tail = [](double deviations) { return std::log1p(deviations * deviations / 4); };
    return linear + unusual_ * (tail(translation / usual_translation_) + tail(rotation / usual_rotation_));
  }
  /// To be told of each motion that could be seen.
  void learn(const Pose2& off) {
    constexpr double least_translation = 0.03;  // m
    constexpr double least_rotation = 0.02;     // rad
    translations_[learned_ % remembered] = norm(off.translation());
    rotations_[learned_ % remembered] = std::abs(off.theta);
    ++learned_;
    usual_translation_ = std::max(least_translation, median(translations_));
    usual_rotation_ = std::max(least_rotation, median(rotations_));
  }

 private:
  static constexpr std::size_t remembered = 15;
  static constexpr std::size_t fewest = 5;
  using Offs = std::array<double, remembered>;

  [[nodiscard]] double median(Offs offs) const {
    const auto n = static_cast<std::ptrdiff_t>(std::min(learned_, remembered));
    std::nth_element(offs.begin(), offs.begin() + n / 2, offs.begin() + n);
    return offs[static_cast<std::size_t>(n / 2)];
  }

  double translation_;  // 1/m
  double rotation_;     // 1/rad
  double unusual_;
  Offs translations_{};
  Offs rotations_{};
  std::size_t learned_{0};
  double usual_translation_{0};  // m
  double usual_rotation_{0};     // rad
};

}  // namespace flirt
