// flirt/registration/window_bounds.hpp: how good a scan's places can be at most, many at a time.
#pragma once

#include "flirt/registration/local_map.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// The largest values of a local map in squares of 4 × 4 cells, one for each cell as lower corner, around a place: one
/// sum of them bounds the sums at 16 places. Made once for a search (Olson 2009 does so with a second resolution).
class WindowBounds {
 public:
  static constexpr std::int32_t tile_side = 4;    ///< places
  static constexpr std::int32_t strip_tiles = 8;  ///< that one strip bounds: LocalMap::row_length places

  /// For scans whose cells lie within `radius` cells of `middle`, at places up to `reach` cells from it. O(radius²).
  WindowBounds(const LocalMap& map, CellIndex middle, std::int32_t radius, std::int32_t reach);

  [[nodiscard]] std::int32_t tile_rows() const { return (2 * reach_ + tile_side) / tile_side; }
  [[nodiscard]] std::int32_t strips() const { return (tile_rows() + strip_tiles - 1) / strip_tiles; }
  /// Bounds of the sums over the cells of a scan, for each strip of 8 × 1 tiles: tile_rows() × strips(), from the lower
  /// left. O(cells · tiles / 16).
  [[nodiscard]] std::vector<std::uint16_t> of(std::span<const CellIndex> cells) const;

 private:
  [[nodiscard]] std::int32_t offset_of(CellIndex index) const {
    const std::int32_t x = index.x - first_.x;
    const std::int32_t y = index.y - first_.y;
    return (y * tile_side + x % tile_side) * static_cast<std::int32_t>(stride_) + x / tile_side;
  }

  std::int32_t reach_;
  CellIndex first_;
  std::size_t stride_;  // bytes of a quarter of a row: every fourth cell, so that tiles lie side by side
  std::vector<std::uint8_t> largest_{};  // row by row; of a row the cells 0, 4, 8 …, then 1, 5, 9 …
};

}  // namespace flirt
