// apps/flirt/posed_log.hpp: a log with poses: its own, or those that another program found for its scans (`--poses`).
#pragma once

#include "flirt/io/log.hpp"

#include "apps/flirt/command.hpp"

#include <string>

namespace flirt::app {

/// What `--poses` says in the help of a command.
inline constexpr const char* poses_flag_help =
    "trajectory of the robot (TUM, or a log with poses) to take instead of the log's own; scans whose stamp has no "
    "pose "
    "within 0.5 ms are left out";

/// Reads a log. Given the file of a trajectory, only the scans that it has poses for stay, at these. Throws BadInput
/// where a file can't be read, and when in the end no scan has a pose.
[[nodiscard]] LoadedLog read_posed_log(const std::string& path, const std::string& poses, const Session& session);

}  // namespace flirt::app
