// flirt/slam/slam_scan.hpp: what mapping keeps of a scan.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/registration/evidence_score.hpp"
#include "flirt/registration/local_map.hpp"
#include "flirt/registration/surface_points.hpp"

#include <optional>

namespace flirt {

struct SlamScan {
  SurfacePoints points{};
  std::optional<Pose2> odom_from_robot{};  ///< finite where it is there
};

/// How a scan agrees with a map, in one number: weighted as in localization.
[[nodiscard]] inline double score_of(const Agreed& agreed, const EvidenceScoreParams& weights = {}) {
  return weights.likelihood * agreed.likelihood + weights.free * agreed.free + weights.unknown * agreed.unknown +
         weights.through * agreed.through;
}

}  // namespace flirt
