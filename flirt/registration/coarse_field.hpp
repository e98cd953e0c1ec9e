// flirt/registration/coarse_field.hpp: a map at low resolution, laid out for trying a scan at all of its places.
#pragma once

#include "flirt/grid/beam_traversal.hpp"
#include "flirt/registration/raster.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

/// Bytes of a map in cells of about 0.2 m, as the dense search reads them (registration/dense_search.cpp): all of it,
/// or, of a large map, one of the square blocks it is cut into with what can be seen from there. Points that lie
/// outside of the field count as unknown space, so that in a map of several blocks what is farther than the margin
/// from a place does not speak for it.
///
/// Places come in tiles of 4 × 4 cells; two tiles side by side are a pair, which one load of 32 bytes a point values;
/// 16 × 4 pairs are a panel, whose tiles are bounded together. Panels lie where a robot can have been. Around the map
/// all is unknown space.
struct CoarseField {
  static constexpr std::int32_t tile_side = 4;                             ///< cells
  static constexpr std::int32_t pair_width = 8;                            ///< cells
  static constexpr std::int32_t panel_columns = 16;                        ///< pairs
  static constexpr std::int32_t panel_rows = 4;                            ///< pairs
  static constexpr std::int32_t panel_width = panel_columns * pair_width;  ///< cells
  static constexpr std::int32_t panel_height = panel_rows * tile_side;     ///< cells
  static constexpr std::size_t panel_pairs = row_offset(0, panel_rows, panel_columns);
  static constexpr std::size_t pair_cells = row_offset(0, tile_side, pair_width);
  static constexpr std::size_t phases = row_offset(0, tile_side, tile_side);

  static constexpr std::int32_t block_side = 2048;  ///< cells
  static constexpr double block_margin = 51.2;      ///< m

  /// Values of the cells (x, y) .. (x, y + 3): eight of them are a pair of tiles at any shift.
  using Quad = std::array<std::uint8_t, tile_side>;

  struct Panel {
    CellIndex corner;                                                ///< cells of the field, lower left
    std::array<std::uint8_t, panel_pairs> pairs{};                   ///< 255: one can stand somewhere in the pair
    std::array<std::uint8_t, panel_pairs * pair_cells> standable{};  ///< 255, pair by pair, in it as quads lie
  };

  double cell_size{0.2};     ///< m
  std::uint8_t unknown{3};   ///< value of unknown space; free space is worth less, occupied more
  std::uint8_t largest{15};  ///< largest value
  std::int32_t width{0};     ///< cells
  std::int32_t height{0};    ///< cells
  CellIndex block{};         ///< that one can stand in, of the map's
  CellIndex first{};         ///< cell of the map that is the field's (0, 0)

  Raster<Quad> quads{};              ///< padded by a pair on the left and on the right, by a tile below and above
  Raster<std::uint8_t> standable{};  ///< not padded: 255 where a robot can have been (seen free space), else 0
  /// Largest value of the tile whose lower left cell is (x, y), for each x and y: by ⌊y / 4⌋, in that by phase (y mod
  /// 4, x mod 4), in that by ⌊x / 4⌋; padded by a panel on the left and on the right, below and above.
  std::vector<std::uint8_t> peaks{};
  std::vector<Panel> panels{};  ///< by rows, in them from left to right; they do not overlap

  /// Of the cell; unknown space outside of the field.
  [[nodiscard]] std::uint8_t value(std::int32_t x, std::int32_t y) const;
  /// Area of the panels, m²: what a dense search over the whole map looks at.
  [[nodiscard]] double searched_area() const;
  [[nodiscard]] std::size_t bytes() const;

  [[nodiscard]] std::int32_t peak_stride() const { return tiles(width) + 2 * pair_width / tile_side * panel_columns; }
  [[nodiscard]] std::int32_t peak_rows() const { return tiles(height) + 2 * panel_rows; }
  [[nodiscard]] static std::int32_t tiles(std::int32_t cells) { return (cells + tile_side - 1) / tile_side; }
};

/// A field of unknown space only.
[[nodiscard]] CoarseField unknown_field(std::int32_t width, std::int32_t height, double cell_size, std::uint8_t unknown,
                                        std::uint8_t largest);

/// Sets a cell; `finish` has to follow.
void set_cell(CoarseField& field, CellIndex cell, std::uint8_t value, bool standable);

/// Brings peaks and panels up to date after cells of the box [min, max) were set. O(cells of the box + box of the map).
void finish(CoarseField& field, CellIndex min, CellIndex max);

}  // namespace flirt
