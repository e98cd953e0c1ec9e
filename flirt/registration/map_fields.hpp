// flirt/registration/map_fields.hpp: a map's evidence, prepared for finding scans in it.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/grid/evidence_grid.hpp"
#include "flirt/registration/coarse_field.hpp"
#include "flirt/registration/map_tile.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace flirt {

/// All that finding a scan in a map needs of the map; made once, then only read, by any number of threads. The fine
/// layers lie in tiles, the coarse ones in fields of up to some 500 m a side, both absent where there is nothing to
/// know, and copies share them: memory grows with the mapped area. Only the table of tiles, 16 bytes for each 3.2 m
/// square, covers the map's box.
struct MapFields {
  /// Of the largest map that fields are made of; with cells of 0.05 m a box of 100 km².
  static constexpr std::size_t most_tiles = 10'000'000;

  Point2 origin;           ///< m, lower corner of the box in the map frame
  double cell_size{0.05};  ///< m
  MapFieldParams params{};
  CellIndex first_tile{};                                    ///< of the box, in tiles of the evidence grid
  std::int32_t columns{0};                                   ///< tiles
  std::int32_t rows{0};                                      ///< tiles
  std::vector<std::shared_ptr<const MapTile>> tiles{};       ///< row by row; null: nothing seen there or near
  std::vector<std::shared_ptr<const CoarseField>> coarse{};  ///< block by block; a map up to 400 m wide has one

  [[nodiscard]] bool empty() const { return tiles.empty(); }
  /// Bytes of all layers.
  [[nodiscard]] std::size_t bytes() const;
  /// m², what a dense search over the whole map looks at.
  [[nodiscard]] double searched_area() const;

  /// The tile of cell (x, y), counted from the origin; null outside of the box, and where nothing was seen.
  [[nodiscard]] const MapTile* tile_at(std::int32_t x, std::int32_t y) const {
    return contains(x, y) ? tiles[tile_index(x, y)].get() : nullptr;
  }
  [[nodiscard]] bool contains(std::int32_t x, std::int32_t y) const {
    return static_cast<std::uint32_t>(x) < static_cast<std::uint32_t>(columns * MapTile::side) &&
           static_cast<std::uint32_t>(y) < static_cast<std::uint32_t>(rows * MapTile::side);
  }
  /// Of a cell in the box.
  [[nodiscard]] std::size_t tile_index(std::int32_t x, std::int32_t y) const {
    return row_offset(x / MapTile::side, y / MapTile::side, columns);
  }
};

/// Whether the box is small enough for fields of a map in it.
[[nodiscard]] constexpr bool is_mappable(const CellBox& box) {
  constexpr std::size_t side = MapTile::side;
  return box.width() / side <= MapFields::most_tiles / std::max<std::size_t>(box.height() / side, 1);
}

/// Empty when the grid is, or when its box is not mappable. O(cells of the mapped area · reach + tiles of the box).
[[nodiscard]] MapFields map_fields(const EvidenceGrid& grid, const MapFieldParams& params = {});

/// The fields that `map_fields(grid, before.params)` would make; tiles around which the evidence means the same as when
/// `before` was made are shared with it, others are made anew.
[[nodiscard]] MapFields updated_fields(const MapFields& before, const EvidenceGrid& grid);

}  // namespace flirt
