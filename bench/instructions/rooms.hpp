// bench/instructions/rooms.hpp: scans of a made-up floor, the same for every commit: nothing of the library that may
// change (simulator, random numbers) takes part in making them.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/core/scan.hpp"

#include <cstddef>
#include <vector>

namespace flirt::bench {

struct PlacedScan {
  Scan scan;
  Pose2 map_from_sensor;
};

/// `count` scans of 360 beams over half a turn, along a winding way through rooms with furniture; readings carry 1 cm
/// of noise. O(count · beams · walls).
[[nodiscard]] std::vector<PlacedScan> scans_in_rooms(std::size_t count);

}  // namespace flirt::bench
