// flirt/registration/join_scans.hpp: the last few scans of a drive as one, held together by odometry.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/registration/scan_points.hpp"

#include <span>

namespace flirt {

/// End points of all scans in the sensor frame of the last one: its own first, then those of earlier scans, the latest
/// first, where no other lies within about `spacing` yet. Odometry says where earlier scans were taken, and each is
/// then drawn onto those that were joined before it (window search and alignment, where they share enough): a heading
/// off by a few degrees would double the walls. Points of earlier scans carry no beam (range 0): what stood between
/// them and the sensor is not known from here. Scans before a gap in the odometry are left out. O(beams + scans · cells
/// of the window).
[[nodiscard]] ScanPoints join_scans(std::span<const Scan> scans, const ScanPointParams& params = {});

}  // namespace flirt
