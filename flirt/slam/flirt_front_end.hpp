// flirt/slam/flirt_front_end.hpp: the papers' way from one scan to the next: keypoints matched with those of the scan
// before (P1 §3.2, algorithm 1, lines 1-3).
#pragma once

#include "flirt/slam/constraint_match.hpp"
#include "flirt/slam/dead_reckoning.hpp"
#include "flirt/slam/front_end.hpp"
#include "flirt/slam/slam_params.hpp"

#include <optional>

namespace flirt {

/// Where the keypoints give no motion, odometry does, or the motion before, with its own covariance; and it says what
/// the keypoints tell about the place (P1 §4.2).
class FlirtFrontEnd {
 public:
  explicit FlirtFrontEnd(const SlamParams& params) : params_(params), reckoning_(params), matcher_(params.flirt) {}

  [[nodiscard]] ScanMotion add(const SlamScan& scan);

 private:
  SlamParams params_;
  DeadReckoning reckoning_;
  ConstraintMatcher matcher_;
  std::optional<SlamScan> last_{};
};

}  // namespace flirt
