// flirt/grid/nearest_cells.hpp: for each cell of a raster, the nearest marked cell within a reach.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// Where the nearest marked cell lies, in cells from the asking cell.
struct CellOffset {
  static constexpr std::uint8_t none = 255;  ///< squared_distance when no marked cell is within reach
  std::int8_t dx{0};
  std::int8_t dy{0};
  std::uint8_t squared_distance{none};  ///< dx² + dy², cells²

  friend bool operator==(const CellOffset&, const CellOffset&) = default;
};

/// Largest reach of `nearest_cells`, cells.
inline constexpr int longest_reach = 15;

/// Exact Euclidean distance transform up to `reach` (1..15) cells: for each cell of the raster (width · height bytes,
/// row by row, not 0 is marked) the nearest marked cell whose centre is at most `reach` away. Of several equally near
/// ones the lowest row, in it the lowest column, is taken. Separable (rows, then columns); O(cells · reach) with whole
/// vectors of cells at a time.
[[nodiscard]] std::vector<CellOffset> nearest_cells(std::span<const std::uint8_t> marked, std::size_t width, int reach);

}  // namespace flirt
