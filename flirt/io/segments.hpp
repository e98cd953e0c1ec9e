// flirt/io/segments.hpp: floor plans as line segments, `x1,y1,x2,y2` in metres per line, as the vector maps of AMRL.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/sim/floor_plan.hpp"

#include <filesystem>

namespace flirt {

/// Reads a plain or gzip file. Spaces around numbers, blank lines and # comments are allowed. Errors: a line that is
/// not four finite numbers, a file without segments.
[[nodiscard]] Result<FloorPlan> read_segments(const std::filesystem::path& path);

}  // namespace flirt
