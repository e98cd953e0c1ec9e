// flirt/io/floor_plan.hpp: a floor plan from any of the files that can hold one.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/sim/floor_plan.hpp"

#include <filesystem>
#include <optional>

namespace flirt {

/// By the end of the name: .yaml and .yml are ROS grid maps, .png and .pgm images (dark pixels are walls) of
/// `resolution` m per pixel, all others line segments. Errors: those of the readers; an image without a resolution; a
/// resolution for a file that has its own.
[[nodiscard]] Result<FloorPlan> read_floor_plan(const std::filesystem::path& path,
                                                std::optional<double> resolution = std::nullopt);

}  // namespace flirt
