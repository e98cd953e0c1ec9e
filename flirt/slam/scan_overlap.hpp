// flirt/slam/scan_overlap.hpp: which scans see the same walls.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/registration/surface_points.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// Two scans that see the same walls.
struct ScanPair {
  std::uint32_t a{0};
  std::uint32_t b{0};  ///< a < b
};

/// For each scan the three before it, and up to `most` earlier ones that share the largest part of what they see:
/// pieces of 0.3 m of surface that face the same way, from wherever they were looked at. Of scans close in time only
/// one is taken, so that partners are spread over visits; and what a hundred scans saw needs no more of them, so that
/// the work does not grow with the square of the visits. Scans from where the robot has moved by less than 0.03 m and
/// 0.03 rad have one partner alone, that from where it did, and are nobody's. `scans[i]` belongs to node i.
/// O(scans · pieces a scan).
[[nodiscard]] std::vector<ScanPair> overlapping_pairs(std::span<const Pose2> map_from_node,
                                                      std::span<const SurfacePoints> scans, std::size_t most);

}  // namespace flirt
