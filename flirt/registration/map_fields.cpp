#include "flirt/registration/map_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

namespace flirt {
namespace {

constexpr std::int32_t tile_side = MapTile::side;

/// The marks of all tiles of the grid over its box, in rows; null where nothing was seen.
struct MarkTable {
  CellIndex first;
  Raster<std::unique_ptr<const TileMarks>> tiles;

  [[nodiscard]] const TileMarks* at(std::int32_t x, std::int32_t y) const {
    return tiles.contains(x, y) ? tiles.at(x, y).get() : nullptr;
  }
};

MarkTable mark_table(const EvidenceGrid& grid, const CellBox& box) {
  MarkTable table;
  table.first = {box.min.x / tile_side, box.min.y / tile_side};  // a box of whole tiles
  table.tiles.width = static_cast<std::int32_t>(box.width()) / tile_side;
  table.tiles.height = static_cast<std::int32_t>(box.height()) / tile_side;
  table.tiles.cells.resize(static_cast<std::size_t>(table.tiles.width) * static_cast<std::size_t>(table.tiles.height));
  grid.for_each_tile([&](CellIndex tile, std::span<const EvidenceCell> cells) {
    table.tiles.at(tile.x - table.first.x, tile.y - table.first.y) = std::make_unique<const TileMarks>(cells);
  });
  return table;
}

/// Nothing when no tile around has any marks.
std::optional<TileSurroundings> surroundings_of(const MarkTable& table, std::int32_t x, std::int32_t y,
                                                std::int32_t reach) {
  TileSurroundings around{.reach = reach, .marks = {}};
  bool any = false;
  for (std::int32_t dy = -reach; dy <= reach; ++dy) {
    for (std::int32_t dx = -reach; dx <= reach; ++dx) {
      around.marks.push_back(table.at(x + dx, y + dy));
      any |= around.marks.back() != nullptr;
    }
  }
  if (!any) { return std::nullopt; }
  return around;
}

/// What the fine cells of one coarse cell are.
struct CoarseCell {
  int nearest{Agreement::distance_mask};  // cells², least squared distance to something occupied
  int free{0};
};

CoarseCell coarse_cell(const MapFields& fields, std::int32_t x, std::int32_t y, std::int32_t factor) {
  CoarseCell coarse;
  for (std::int32_t v = y * factor; v < (y + 1) * factor; ++v) {
    for (std::int32_t u = x * factor; u < (x + 1) * factor; ++u) {
      const MapTile* const tile = fields.tile_at(u, v);
      if (tile == nullptr) { continue; }
      const std::uint8_t cell = tile->agreement[MapTile::offset(u, v)];
      coarse.nearest = std::min(coarse.nearest, cell & Agreement::distance_mask);
      coarse.free += (cell & Agreement::free) != 0 ? 1 : 0;
    }
  }
  return coarse;
}

/// Coarse values by squared distance; by its best fine cell where something occupied is near, less where most is free.
class CoarseValues {
 public:
  explicit CoarseValues(const MapFields& fields) {
    const double sigma = fields.params.likelihood_sigma / fields.cell_size;
    for (int squared = 0; squared <= Agreement::distance_mask; ++squared) {
      const bool far = squared == Agreement::distance_mask;
      const double value = fields.params.coarse_peak * (far ? 0.0 : std::exp(-squared / (2 * sigma * sigma)));
      const auto at = static_cast<std::size_t>(squared);
      of_free_[at] = static_cast<std::uint8_t>(std::lround(value));
      of_other_[at] = static_cast<std::uint8_t>(std::lround(value + fields.params.free_penalty));
    }
  }
  [[nodiscard]] std::uint8_t of(const CoarseCell& cell, std::int32_t factor) const {
    const auto at = static_cast<std::size_t>(cell.nearest);
    return 2 * cell.free > factor * factor ? of_free_[at] : of_other_[at];
  }

 private:
  std::array<std::uint8_t, Agreement::distance_mask + 1> of_free_{};
  std::array<std::uint8_t, Agreement::distance_mask + 1> of_other_{};
};

/// The coarse cells that touch tile (x, y) of the fields, read from its fine cells.
void coarsen_tile(MapFields& fields, const CoarseValues& values, std::int32_t x, std::int32_t y) {
  const auto factor = static_cast<std::int32_t>(fields.params.coarse_factor);
  CoarseField& coarse = fields.coarse;
  for (std::int32_t v = y * tile_side / factor;
       v < std::min(((y + 1) * tile_side + factor - 1) / factor, coarse.height); ++v) {
    for (std::int32_t u = x * tile_side / factor;
         u < std::min(((x + 1) * tile_side + factor - 1) / factor, coarse.width); ++u) {
      const CoarseCell cell = coarse_cell(fields, u, v, factor);
      set_cell(coarse, {u, v}, values.of(cell, factor), cell.free > 0);
    }
  }
}

CoarseField blank_coarse_field(const MapFields& fields) {
  const auto factor = static_cast<std::int32_t>(fields.params.coarse_factor);
  return unknown_field((fields.columns * tile_side + factor - 1) / factor,
                       (fields.rows * tile_side + factor - 1) / factor, factor * fields.cell_size,
                       static_cast<std::uint8_t>(fields.params.free_penalty),
                       static_cast<std::uint8_t>(fields.params.free_penalty + fields.params.coarse_peak));
}

/// The coarse cells of some tiles. O(cells of the tiles and of the box around them).
void coarsen(MapFields& fields, std::span<const CellIndex> tiles) {
  if (tiles.empty()) { return; }
  const CoarseValues values(fields);
  CellIndex min = tiles.front();
  CellIndex max = min;
  for (const CellIndex& tile : tiles) {
    coarsen_tile(fields, values, tile.x, tile.y);
    min = {std::min(min.x, tile.x), std::min(min.y, tile.y)};
    max = {std::max(max.x, tile.x), std::max(max.y, tile.y)};
  }
  const auto factor = static_cast<std::int32_t>(fields.params.coarse_factor);
  const auto end = [&](std::int32_t tile, std::int32_t size) {
    return std::min(((tile + 1) * tile_side + factor - 1) / factor, size);
  };
  finish(fields.coarse, {min.x * tile_side / factor, min.y * tile_side / factor},
         {end(max.x, fields.coarse.width), end(max.y, fields.coarse.height)});
}

void coarsen_all(MapFields& fields) {
  fields.coarse = blank_coarse_field(fields);
  std::vector<CellIndex> all;
  for (std::int32_t y = 0; y < fields.rows; ++y) {
    for (std::int32_t x = 0; x < fields.columns; ++x) { all.push_back({x, y}); }
  }
  coarsen(fields, all);
}

/// A tile of `before` by its place in the map.
const std::shared_ptr<const MapTile>* find_tile(const MapFields& before, CellIndex tile) {
  const std::int32_t x = tile.x - before.first_tile.x;
  const std::int32_t y = tile.y - before.first_tile.y;
  if (x < 0 || y < 0 || x >= before.columns || y >= before.rows) { return nullptr; }
  const auto& found = before.tiles[row_offset(x, y, before.columns)];
  return found ? &found : nullptr;
}

MapFields empty_fields(const EvidenceGrid& grid, const MapFieldParams& params) {
  MapFields fields;
  fields.cell_size = grid.params().cell_size;
  fields.params = params;
  const auto box = grid.bounds();
  if (!box) { return fields; }
  fields.origin = {box->min.x * fields.cell_size, box->min.y * fields.cell_size};
  fields.first_tile = {box->min.x / tile_side, box->min.y / tile_side};
  fields.columns = static_cast<std::int32_t>(box->width()) / tile_side;
  fields.rows = static_cast<std::int32_t>(box->height()) / tile_side;
  fields.tiles.resize(static_cast<std::size_t>(fields.columns) * static_cast<std::size_t>(fields.rows));
  return fields;
}

bool same_box(const MapFields& a, const MapFields& b) {
  return a.first_tile == b.first_tile && a.columns == b.columns && a.rows == b.rows;
}

}  // namespace

std::size_t MapFields::bytes() const {
  std::size_t sum = coarse.bytes() + tiles.size() * sizeof(tiles[0]);
  for (const auto& tile : tiles) { sum += tile ? tile->bytes() : 0; }
  return sum;
}

MapFields map_fields(const EvidenceGrid& grid, const MapFieldParams& params) {
  MapFields nothing;
  nothing.params = params;
  return updated_fields(nothing, grid);
}

MapFields updated_fields(const MapFields& before, const EvidenceGrid& grid) {
  MapFields fields = empty_fields(grid, before.params);
  if (fields.empty()) { return fields; }
  const MarkTable table = mark_table(grid, *grid.bounds());
  const std::int32_t reach = tile_reach(fields.params, fields.cell_size);
  std::vector<CellIndex> changed;
  for (std::int32_t y = 0; y < fields.rows; ++y) {
    for (std::int32_t x = 0; x < fields.columns; ++x) {
      const auto* const old = find_tile(before, {fields.first_tile.x + x, fields.first_tile.y + y});
      auto& tile = fields.tiles[row_offset(x, y, fields.columns)];
      const auto around = surroundings_of(table, x, y, reach);
      if (around && old != nullptr && (*old)->sources == sources_of(*around)) {
        tile = *old;
        continue;
      }
      if (around) {
        auto made = std::make_shared<const MapTile>(
            map_tile(*around, fields.params, fields.cell_size, old != nullptr ? old->get() : nullptr));
        if (!is_blank(*made)) { tile = std::move(made); }
      }
      if (tile != nullptr || old != nullptr) { changed.push_back({x, y}); }
    }
  }
  if (before.empty() || !same_box(before, fields)) {
    coarsen_all(fields);
  } else {
    fields.coarse = before.coarse;
    coarsen(fields, changed);
  }
  return fields;
}

}  // namespace flirt
