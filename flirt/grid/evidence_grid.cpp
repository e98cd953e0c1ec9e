#include "flirt/grid/evidence_grid.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

namespace flirt {
namespace {

constexpr std::uint32_t no_tile = std::numeric_limits<std::uint32_t>::max();
constexpr std::int32_t tile_shift = 6;
static_assert(1 << tile_shift == EvidenceGrid::tile_side);

/// Sensor and end points of the usable beams, in cells.
struct Fan {
  FixedPoint2 sensor;
  std::vector<FixedPoint2> ends;
};

Fan beam_fan(const Scan& scan, const Pose2& map_from_sensor, const EvidenceGridParams& params) {
  const double scale = 1.0 / params.cell_size;
  Fan fan{fixed_point(scale * map_from_sensor.translation()), {}};
  fan.ends.reserve(scan.ranges.size());
  for (const BeamPoint& hit : hit_points(scan)) {
    const double range = scan.ranges[hit.beam];
    if (range < params.range_min || range >= params.range_max) { continue; }
    fan.ends.push_back(fixed_point(scale * (map_from_sensor * hit.point)));
  }
  return fan;
}

/// Index of a cell within the cells of its tile.
std::size_t index_in_tile(std::int32_t x, std::int32_t y) {
  constexpr std::int32_t mask = EvidenceGrid::tile_side - 1;
  return static_cast<std::size_t>(y & mask) * EvidenceGrid::tile_side + static_cast<std::size_t>(x & mask);
}

CellIndex tile_index(CellIndex cell) {
  return {cell.x >> tile_shift, cell.y >> tile_shift};
}

/// Smallest box of tiles around a fan.
CellBox tile_box(const Fan& fan) {
  CellBox box{tile_index(fan.sensor.index()), tile_index(fan.sensor.index())};
  for (const FixedPoint2& end : fan.ends) {
    const CellIndex tile = tile_index(end.index());
    box = {{std::min(box.min.x, tile.x), std::min(box.min.y, tile.y)},
           {std::max(box.max.x, tile.x), std::max(box.max.y, tile.y)}};
  }
  return {box.min, {box.max.x + 1, box.max.y + 1}};
}

}  // namespace

EvidenceGrid::EvidenceGrid(const EvidenceGridParams& params, std::span<const CellIndex> tiles,
                           std::span<const EvidenceCell> cells)
    : params_(params) {
  constexpr std::size_t cells_per_tile = std::tuple_size_v<Cells>;
  FLIRT_ASSERT(cells.size() == tiles.size() * cells_per_tile);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const std::uint32_t place = tile_at(tiles[i]);
    FLIRT_ASSERT(place == i);
    Tile& tile = tiles_[place];
    std::ranges::copy(cells.subspan(i * cells_per_tile, cells_per_tile), tile.cells.begin());
    for (const EvidenceCell& cell : tile.cells) { tile.counts += std::uint64_t{cell.hits} + cell.passes; }
  }
}

EvidenceGrid::SavedTiles EvidenceGrid::save_tiles() const {
  std::vector<const Tile*> sorted;
  sorted.reserve(tiles_.size());
  for (const Tile& tile : tiles_) { sorted.push_back(&tile); }
  std::ranges::sort(sorted, {}, [](const Tile* tile) { return std::pair(tile->index.y, tile->index.x); });
  SavedTiles saved;
  saved.cells.reserve(sorted.size() * std::tuple_size_v<Cells>);
  for (const Tile* tile : sorted) {
    saved.tiles.push_back(tile->index);
    saved.cells.insert(saved.cells.end(), tile->cells.begin(), tile->cells.end());
  }
  return saved;
}

std::uint32_t EvidenceGrid::tile_at(CellIndex index) {
  const auto [entry, fresh] = tile_of_.try_emplace(index, static_cast<std::uint32_t>(tiles_.size()));
  if (fresh) { tiles_.push_back({.index = index}); }
  return entry->second;
}

const EvidenceGrid::Tile* EvidenceGrid::find(CellIndex index) const {
  const auto entry = tile_of_.find(index);
  return entry == tile_of_.end() ? nullptr : &tiles_[entry->second];
}

template <EvidenceGrid::Change change>
void EvidenceGrid::count_beams(const Scan& scan, const Pose2& map_from_sensor) {
  FLIRT_ASSERT(is_finite(map_from_sensor) && norm(map_from_sensor.translation()) <= 2.1e7);  // in 32 bits of 1 cm
  const Fan fan = beam_fan(scan, map_from_sensor, params_);
  const CellBox box = tile_box(fan);
  const std::size_t width = box.width();
  // Tiles of the fan's box, looked up once each: the loop over cells then needs no hashing.
  std::vector<std::uint32_t> tile_of_box(width * box.height(), no_tile);
  Tile* tiles = tiles_.data();
  const auto tile_of_cell = [&](std::int32_t x, std::int32_t y) -> Tile& {
    const CellIndex tile = tile_index({x, y});
    std::uint32_t& place = tile_of_box[static_cast<std::size_t>(tile.y - box.min.y) * width +
                                       static_cast<std::size_t>(tile.x - box.min.x)];
    if (place == no_tile) {
      place = tile_at(tile);
      tiles = tiles_.data();
    }
    return tiles[place];
  };
  std::uint64_t lost = 0;
  const auto change_count = [&](Tile& tile, std::uint16_t& value) {
    if constexpr (change == Change::add) {
      const bool full = value == std::numeric_limits<std::uint16_t>::max();
      value = static_cast<std::uint16_t>(value + (full ? 0 : 1));
      lost += full ? 1 : 0;
      tile.counts += full ? 0 : 1;
    } else {
      FLIRT_ASSERT(value > 0);
      const bool full = value == std::numeric_limits<std::uint16_t>::max();  // how many it lost nobody knows
      value = static_cast<std::uint16_t>(value - (full ? 0 : 1));
      tile.counts -= full ? 0 : 1;
    }
  };
  const auto cell_of = [](Tile& tile, std::int32_t x, std::int32_t y) -> EvidenceCell& {
    return tile.cells[index_in_tile(x, y)];
  };
  for (const FixedPoint2& end : fan.ends) {
    traverse(fan.sensor, end, [&](std::int32_t x, std::int32_t y) {
      Tile& tile = tile_of_cell(x, y);
      change_count(tile, cell_of(tile, x, y).passes);
    });
    const CellIndex last = end.index();
    Tile& tile = tile_of_cell(last.x, last.y);
    change_count(tile, cell_of(tile, last.x, last.y).hits);
  }
  lost_counts_ += lost;
}

void EvidenceGrid::drop_empty_tiles() {
  for (std::size_t i = 0; i < tiles_.size();) {
    if (tiles_[i].counts != 0) {
      ++i;
      continue;
    }
    tile_of_.erase(tiles_[i].index);
    if (i + 1 != tiles_.size()) {
      tiles_[i] = tiles_.back();
      tile_of_[tiles_[i].index] = static_cast<std::uint32_t>(i);
    }
    tiles_.pop_back();
  }
}

void EvidenceGrid::add(const Scan& scan, const Pose2& map_from_sensor) {
  count_beams<Change::add>(scan, map_from_sensor);
}

void EvidenceGrid::remove(const Scan& scan, const Pose2& map_from_sensor) {
  count_beams<Change::remove>(scan, map_from_sensor);
  drop_empty_tiles();
}

void EvidenceGrid::count(CellIndex index, EvidenceCell evidence) {
  Tile& tile = tiles_[tile_at(tile_index(index))];
  const auto row = static_cast<std::size_t>(index.y & (tile_side - 1));
  const auto column = static_cast<std::size_t>(index.x & (tile_side - 1));
  EvidenceCell& cell = tile.cells[row * std::size_t{tile_side} + column];
  const auto raise = [&](std::uint16_t& value, std::uint16_t by) {
    const auto room = static_cast<std::uint16_t>(std::numeric_limits<std::uint16_t>::max() - value);
    const std::uint16_t counted = std::min(room, by);
    value = static_cast<std::uint16_t>(value + counted);
    tile.counts += counted;
    lost_counts_ += static_cast<std::uint64_t>(by - counted);
  };
  raise(cell.hits, evidence.hits);
  raise(cell.passes, evidence.passes);
}

EvidenceCell EvidenceGrid::cell(CellIndex index) const {
  const Tile* tile = find(tile_index(index));
  if (tile == nullptr) { return {}; }
  return tile->cells[index_in_tile(index.x, index.y)];
}

std::optional<CellBox> EvidenceGrid::bounds() const {
  if (tiles_.empty()) { return std::nullopt; }
  CellIndex min = tiles_.front().index;
  CellIndex max = min;
  for (const Tile& tile : tiles_) {
    min = {std::min(min.x, tile.index.x), std::min(min.y, tile.index.y)};
    max = {std::max(max.x, tile.index.x), std::max(max.y, tile.index.y)};
  }
  return CellBox{{min.x * tile_side, min.y * tile_side}, {(max.x + 1) * tile_side, (max.y + 1) * tile_side}};
}

bool operator==(const EvidenceGrid& a, const EvidenceGrid& b) {
  if (a.params_ != b.params_ || a.tiles_.size() != b.tiles_.size()) { return false; }
  return std::ranges::all_of(a.tiles_, [&b](const EvidenceGrid::Tile& tile) {
    const EvidenceGrid::Tile* other = b.find(tile.index);
    return other != nullptr && other->cells == tile.cells;
  });
}

}  // namespace flirt
