#include "flirt/registration/map_fields.hpp"

#include "flirt/registration/coarse_blocks.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

namespace flirt {
namespace {

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
  table.first = {box.min.x / MapTile::side, box.min.y / MapTile::side};  // a box of whole tiles
  table.tiles.width = static_cast<std::int32_t>(box.width()) / MapTile::side;
  table.tiles.height = static_cast<std::int32_t>(box.height()) / MapTile::side;
  table.tiles.cells.resize(static_cast<std::size_t>(table.tiles.width) * static_cast<std::size_t>(table.tiles.height));
  grid.for_each_tile([&](CellIndex tile, std::span<const EvidenceCell> cells) {
    table.tiles.at(tile.x - table.first.x, tile.y - table.first.y) = std::make_unique<const TileMarks>(cells);
  });
  return table;
}

TileSurroundings surroundings_of(const MarkTable& table, std::int32_t x, std::int32_t y, std::int32_t reach) {
  TileSurroundings around{.reach = reach, .marks = {}};
  for (std::int32_t dy = -reach; dy <= reach; ++dy) {
    for (std::int32_t dx = -reach; dx <= reach; ++dx) { around.marks.push_back(table.at(x + dx, y + dy)); }
  }
  return around;
}

/// 1 for the tiles of the box that have marks within reach.
Raster<std::uint8_t> tiles_near_marks(const EvidenceGrid& grid, const MarkTable& table, std::int32_t reach) {
  Raster<std::uint8_t> near(table.tiles.width, table.tiles.height);
  grid.for_each_tile([&](CellIndex tile, std::span<const EvidenceCell> /*cells*/) {
    const CellIndex at{tile.x - table.first.x, tile.y - table.first.y};
    for (std::int32_t y = std::max(at.y - reach, 0); y <= std::min(at.y + reach, near.height - 1); ++y) {
      for (std::int32_t x = std::max(at.x - reach, 0); x <= std::min(at.x + reach, near.width - 1); ++x) {
        near.at(x, y) = 1;
      }
    }
  });
  return near;
}

/// A tile of `before` by its place in the map.
const std::shared_ptr<const MapTile>* find_tile(const MapFields& before, CellIndex tile) {
  const std::int32_t x = tile.x - before.first_tile.x;
  const std::int32_t y = tile.y - before.first_tile.y;
  if (x < 0 || y < 0 || x >= before.columns || y >= before.rows) { return nullptr; }
  const auto& found = before.tiles[row_offset(x, y, before.columns)];
  return found ? &found : nullptr;
}

/// Null when it would be blank. `before` may be, too.
std::shared_ptr<const MapTile> made_tile(const TileSurroundings& around, const MapFields& fields,
                                         const MapTile* before) {
  if (is_far_from_all(around, fields.params, fields.cell_size)) { return nullptr; }
  auto tile = std::make_shared<const MapTile>(map_tile(around, fields.params, fields.cell_size, before));
  return is_blank(*tile) ? nullptr : tile;
}

MapFields empty_fields(const EvidenceGrid& grid, const MapFieldParams& params) {
  MapFields fields;
  fields.cell_size = grid.params().cell_size;
  fields.params = params;
  const auto box = grid.bounds();
  if (!box || !is_mappable(*box)) { return fields; }
  fields.origin = {box->min.x * fields.cell_size, box->min.y * fields.cell_size};
  fields.first_tile = {box->min.x / MapTile::side, box->min.y / MapTile::side};
  fields.columns = static_cast<std::int32_t>(box->width()) / MapTile::side;
  fields.rows = static_cast<std::int32_t>(box->height()) / MapTile::side;
  fields.tiles.resize(static_cast<std::size_t>(fields.columns) * static_cast<std::size_t>(fields.rows));
  return fields;
}

bool same_box(const MapFields& a, const MapFields& b) {
  return a.first_tile == b.first_tile && a.columns == b.columns && a.rows == b.rows;
}

}  // namespace

std::size_t MapFields::bytes() const {
  std::size_t sum = tiles.size() * sizeof(tiles[0]);
  for (const auto& tile : tiles) { sum += tile ? tile->bytes() : 0; }
  for (const auto& field : coarse) { sum += field->bytes(); }
  return sum;
}

double MapFields::searched_area() const {
  double sum = 0;
  for (const auto& field : coarse) { sum += field->searched_area(); }
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
  const Raster<std::uint8_t> near = tiles_near_marks(grid, table, reach);
  std::vector<CellIndex> changed;
  for (std::int32_t y = 0; y < fields.rows; ++y) {
    for (std::int32_t x = 0; x < fields.columns; ++x) {
      const auto* const old = find_tile(before, {fields.first_tile.x + x, fields.first_tile.y + y});
      auto& tile = fields.tiles[row_offset(x, y, fields.columns)];
      if (near.at(x, y) != 0) {
        const TileSurroundings around = surroundings_of(table, x, y, reach);
        if (old != nullptr && (*old)->sources == sources_of(around)) {
          tile = *old;
          continue;
        }
        tile = made_tile(around, fields, old != nullptr ? old->get() : nullptr);
      }
      if (tile != nullptr || old != nullptr) { changed.push_back({x, y}); }
    }
  }
  fields.coarse =
      same_box(before, fields) ? coarse_fields(fields, before.coarse, changed) : coarse_fields(fields, {}, {});
  return fields;
}

}  // namespace flirt
