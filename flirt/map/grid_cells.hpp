// flirt/map/grid_cells.hpp: a grid map resampled to the cells of an evidence grid.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/grid/beam_traversal.hpp"
#include "flirt/grid/evidence_grid.hpp"
#include "flirt/grid/grey_image.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

/// The cells of a box around a grid map, row by row from the lowest, with indices as in an evidence grid.
struct GridCells {
  CellIndex first{};  ///< lower left cell
  std::int32_t width{0};
  std::int32_t height{0};
  std::vector<CellState> states{};
  std::vector<float> occupied_share{};  ///< of a cell's area, 0..1, by what scans end on
  std::vector<std::uint8_t> solid{};    ///< not 0: occupied, and no beam passes

  [[nodiscard]] bool contains(CellIndex cell) const {
    return cell.x >= first.x && cell.y >= first.y && cell.x < first.x + width && cell.y < first.y + height;
  }
  [[nodiscard]] std::size_t offset(CellIndex cell) const {
    return static_cast<std::size_t>(cell.y - first.y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(cell.x - first.x);
  }
  /// Outside of the box everything is unknown.
  [[nodiscard]] CellState at(CellIndex cell) const {
    return contains(cell) ? states[offset(cell)] : CellState::unknown;
  }
};

/// A cell is occupied when anything in it is (what that means, `grid_pixels` tells), free when most of it is, else
/// unknown. It is solid when solid pixels fill half of it, or of what a wall one pixel wide fills where pixels are
/// finer than cells: of two cells beside each other that a wall lies across a scan may end in the farther one. By
/// sample points inside each cell, 4 × 4 or as many as it takes to meet every smaller pixel. Errors: pixels smaller
/// than 1 mm, more than 1 km² of cells, or more than 1000 km from the origin. O(pixels + cells · samples).
[[nodiscard]] Result<GridCells> grid_cells(const GreyImage& image, const GridMapMetadata& metadata, double cell_size);

/// Hits `counts` · share of its area (at least 2) for an occupied cell, with one more pass than hits unless it is
/// solid; `counts` passes for a free one. O(cells).
[[nodiscard]] EvidenceGrid evidence_of(const GridCells& cells, std::uint32_t counts, double cell_size);

}  // namespace flirt
