// flirt/slam/pair_front_end.hpp: each scan against the scan before alone, the way of most scan matchers: for
// comparison.
#pragma once

#include "flirt/slam/dead_reckoning.hpp"
#include "flirt/slam/front_end.hpp"
#include "flirt/slam/slam_params.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <optional>

namespace flirt {

/// `olson`: every pose in a window around the prediction, scored by the end points in the scan before (Olson 2009), the
/// best drawn onto its lines. `icp`: drawn onto its lines from the prediction. Where less than 0.3 of the points find
/// something there, the prediction stands.
class PairFrontEnd {
 public:
  explicit PairFrontEnd(const SlamParams& params) : params_(params), reckoning_(params) {}

  [[nodiscard]] ScanMotion add(const SlamScan& scan);

 private:
  [[nodiscard]] Pose2 start(const SlamScan& scan, const Pose2& prediction) const;

  SlamParams params_;
  DeadReckoning reckoning_;
  std::optional<SurfacePoints> last_{};
};

}  // namespace flirt
