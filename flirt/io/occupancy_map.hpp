// flirt/io/occupancy_map.hpp: the grid map that navigation loads, from accumulated evidence.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/grid/evidence_grid.hpp"
#include "flirt/io/ros_map.hpp"

#include <string>

namespace flirt {

/// Cells that beams ended in at least twice and in at least 0.15 of all that came there are occupied, other seen cells
/// free (254), the rest unknown (205), as map_server's trinary mode reads them. What only passed by, people above all,
/// is free: most beams went through where it had been. Of occupied cells those that most beams ended in are black, the
/// others (legs of tables, doors that stood open at times) dark grey (60), which `place_map_from_grid` tells apart.
/// Cells that one beam ended in and five or fewer crossed are grey (115): unknown to map_server, since the reading may
/// be stray, but in a building seen once in passing many walls consist of them. Cropped to what was seen; one unknown
/// pixel for an empty grid. `image_name` goes into the metadata. Where the box holds more than 2^28 cells (820 m × 820
/// m of 0.05 m) or 10^6 of them in a row, a pixel is a square of up to 16 × 16 cells and shows the darkest of those
/// seen. Error: a box larger than even that allows, of scans that lie far apart. O(cells seen + pixels).
[[nodiscard]] Result<GridMapImage> occupancy_map(const EvidenceGrid& grid, const std::string& image_name);

}  // namespace flirt
