// apps/flirt/tracking_log.hpp: logs as robots would see them, for the bench of tracking.
#pragma once

#include "flirt/core/scan.hpp"

#include "apps/flirt/command.hpp"

#include <string>

namespace flirt::app {

/// A log with poses (see `read_posed_log`), and with odometry: its own, or, where it has none but its corrected poses,
/// what a fair robot's wheels would have said on that way (sim/odometry.hpp), by the session's seed.
[[nodiscard]] ScanLog log_to_track(const std::string& path, const Session& session, const std::string& poses = {});

}  // namespace flirt::app
