// flirt/io/tum.hpp: trajectories in the format of the TUM RGB-D benchmark, which evo and others read:
// `stamp x y z qx qy qz qw`, one pose a line, # comments.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/core/stamped_pose.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace flirt {

/// One line a pose, in this order; stamps with six decimals or more. Numbers read back the same but for the rounding of
/// the heading (1e-15 rad).
[[nodiscard]] std::string to_tum(std::span<const StampedPose> trajectory);

/// to_tum into a file, at once or not at all.
[[nodiscard]] Result<void> write_tum(const std::filesystem::path& path, std::span<const StampedPose> trajectory);

/// Reads a plain or gzip file, in its order. Poses in space lose height, roll and pitch. Errors: lines of other than
/// eight finite numbers, a quaternion that is not of length 1 (by more than 1 %).
[[nodiscard]] Result<std::vector<StampedPose>> read_tum(const std::filesystem::path& path);

}  // namespace flirt
