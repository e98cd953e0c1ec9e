#include "flirt/slam/rbpf_map.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace flirt {
namespace {

constexpr std::int32_t tile_shift = 5;
constexpr std::int32_t tile_mask = RbpfMap::tile_side - 1;
static_assert(1 << tile_shift == RbpfMap::tile_side);

/// Of a cell in its tile, and of a tile in its block.
std::size_t index_within(std::int32_t x, std::int32_t y) {
  return static_cast<std::size_t>((y & tile_mask) << tile_shift | (x & tile_mask));
}

void mark(RbpfMap::Tile& tile, std::int32_t x, std::int32_t y, bool occupied) {
  const std::uint32_t bit = 1U << static_cast<std::uint32_t>(x & tile_mask);
  std::uint32_t& row = tile.occupied[static_cast<std::size_t>(y & tile_mask)];
  row = occupied ? row | bit : row & ~bit;
}

void count_pass(RbpfMap::Tile& tile, std::int32_t x, std::int32_t y) {
  EvidenceCell& evidence = tile.cells[index_within(x, y)].evidence;
  if (evidence.passes == std::numeric_limits<std::uint16_t>::max()) { return; }
  ++evidence.passes;
  if (evidence.hits != 0) { mark(tile, x, y, evidence.occupied()); }
}

void count_hit(RbpfMap::Tile& tile, FixedPoint2 end) {
  const auto [x, y] = end.index();
  RbpfCell& cell = tile.cells[index_within(x, y)];
  if (cell.evidence.hits == std::numeric_limits<std::uint16_t>::max()) { return; }
  ++cell.evidence.hits;
  constexpr std::int64_t in_cell = FixedPoint2::cell - 1;
  constexpr float unit = 1.0F / static_cast<float>(FixedPoint2::cell);
  const float share = 1.0F / static_cast<float>(cell.evidence.hits);
  cell.x += share * (unit * static_cast<float>(end.x & in_cell) - cell.x);
  cell.y += share * (unit * static_cast<float>(end.y & in_cell) - cell.y);
  mark(tile, x, y, cell.evidence.occupied());
}

/// Squared distance in cells² from a place to the mean end point of a cell, both from the lower corner of the same one.
float squared_cells(const RbpfCell& cell, float off_x, float off_y, float in_cell_x, float in_cell_y) {
  const float dx = cell.x + off_x - in_cell_x;
  const float dy = cell.y + off_y - in_cell_y;
  return dx * dx + dy * dy;
}

/// What is pointed to, for writing: made when it is missing, copied when another map shares it.
template <class T>
T& own(std::shared_ptr<T>& shared) {
  if (!shared) {
    shared = std::make_shared<T>();
  } else if (shared.use_count() != 1) {
    shared = std::make_shared<T>(*shared);
  } else {
    // Whoever shared it before has read it for the last time before letting it go.
    std::atomic_thread_fence(std::memory_order_acquire);
  }
  return *shared;
}

std::int32_t floor_of(double value) {
  const auto towards_zero = static_cast<std::int32_t>(value);
  return towards_zero - (value < towards_zero ? 1 : 0);
}

}  // namespace

const RbpfMap::Tile* RbpfMap::find(std::int32_t tile_x, std::int32_t tile_y) const {
  const std::int32_t block_x = tile_x >> tile_shift;
  const std::int32_t block_y = tile_y >> tile_shift;
  const auto x = static_cast<std::uint32_t>(block_x - table_.low.x);
  const auto y = static_cast<std::uint32_t>(block_y - table_.low.y);
  if (x >= static_cast<std::uint32_t>(table_.width) || y >= static_cast<std::uint32_t>(table_.height)) {
    return nullptr;
  }
  const Block* block = table_.blocks[slot(block_x, block_y)].get();
  return block == nullptr ? nullptr : block->tiles[index_within(tile_x, tile_y)].get();
}

bool RbpfMap::is_occupied(std::int32_t x, std::int32_t y) const {
  const Tile* tile = find(x >> tile_shift, y >> tile_shift);
  return tile != nullptr && (tile->occupied[static_cast<std::size_t>(y & tile_mask)] >> (x & tile_mask) & 1U) != 0;
}

RbpfCell RbpfMap::cell(CellIndex index) const {
  const Tile* tile = find(index.x >> tile_shift, index.y >> tile_shift);
  return tile == nullptr ? RbpfCell{} : tile->cells[index_within(index.x, index.y)];
}

double RbpfMap::squared_distance(Point2 in_map) const {
  constexpr float none = 1e9F;
  const double scale = 1 / cell_size_;
  const Point2 in_cells{scale * in_map.x, scale * in_map.y};
  const std::int32_t x = floor_of(in_cells.x);
  const std::int32_t y = floor_of(in_cells.y);
  const Tile* tile = find(x >> tile_shift, y >> tile_shift);
  if (tile == nullptr) { return unseen; }
  const auto in_cell_x = static_cast<float>(in_cells.x - x);
  const auto in_cell_y = static_cast<float>(in_cells.y - y);
  float least = none;
  const std::int32_t column = x & tile_mask;
  const std::int32_t row = y & tile_mask;
  const auto compare = [&](const RbpfCell& cell, std::int32_t dx, std::int32_t dy) {
    least = std::min(least, squared_cells(cell, static_cast<float>(dx), static_cast<float>(dy), in_cell_x, in_cell_y));
  };
  if (column > 0 && column < tile_mask && row > 0 && row < tile_mask) {
    const auto bits = [&](std::int32_t dy) {
      const std::int32_t beside = row + dy;
      return tile->occupied[static_cast<std::size_t>(beside)] >> (column - 1) & 7U;
    };
    // Nine cells, a bit each, three a row: only the occupied ones are looked at.
    for (std::uint32_t nine = bits(-1) | bits(0) << 3U | bits(1) << 6U; nine != 0; nine &= nine - 1) {
      const std::int32_t i = std::countr_zero(nine);
      const std::int32_t dy = i / 3 - 1;
      const std::int32_t dx = i % 3 - 1;
      compare(tile->cells[index_within(column + dx, row + dy)], dx, dy);
    }
  } else {
    for (std::int32_t dy = -1; dy <= 1; ++dy) {
      for (std::int32_t dx = -1; dx <= 1; ++dx) {
        if (is_occupied(x + dx, y + dy)) { compare(cell({x + dx, y + dy}), dx, dy); }
      }
    }
  }
  if (least < none) { return cell_size_ * cell_size_ * static_cast<double>(least); }
  return tile->cells[index_within(x, y)].evidence.seen() ? nothing_near : unseen;
}

/// Makes the table reach over [low, high] blocks, with room to grow.
void RbpfMap::include(CellIndex low, CellIndex high) {
  constexpr std::int32_t room = 1;
  if (table_.width > 0 && low.x >= table_.low.x && low.y >= table_.low.y && high.x < table_.low.x + table_.width &&
      high.y < table_.low.y + table_.height) {
    return;
  }
  const bool empty = table_.width == 0;
  Table grown;
  grown.low = {(empty ? low.x : std::min(low.x, table_.low.x)) - room,
               (empty ? low.y : std::min(low.y, table_.low.y)) - room};
  grown.width = (empty ? high.x + 1 : std::max(high.x + 1, table_.low.x + table_.width)) + room - grown.low.x;
  grown.height = (empty ? high.y + 1 : std::max(high.y + 1, table_.low.y + table_.height)) + room - grown.low.y;
  grown.blocks.resize(static_cast<std::size_t>(grown.width) * static_cast<std::size_t>(grown.height));
  std::swap(table_, grown);
  for (std::int32_t y = 0; y < grown.height; ++y) {
    const auto row = grown.blocks.begin() + static_cast<std::ptrdiff_t>(y) * grown.width;
    const auto to = static_cast<std::ptrdiff_t>(slot(grown.low.x, grown.low.y + y));
    std::move(row, row + grown.width, table_.blocks.begin() + to);
  }
}

RbpfMap::Tile& RbpfMap::own_tile(std::int32_t tile_x, std::int32_t tile_y) {
  Block& block = own(table_.blocks[slot(tile_x >> tile_shift, tile_y >> tile_shift)]);
  return own(block.tiles[index_within(tile_x, tile_y)]);
}

void RbpfMap::add(Point2 sensor_in_robot, std::span<const Point2> ends_in_robot, const Pose2& map_from_robot) {
  const double scale = 1 / cell_size_;
  const double c = std::cos(map_from_robot.theta);
  const double s = std::sin(map_from_robot.theta);
  const auto in_cells = [&](Point2 p) {
    return fixed_point(
        {scale * (map_from_robot.x + c * p.x - s * p.y), scale * (map_from_robot.y + s * p.x + c * p.y)});
  };
  const FixedPoint2 sensor = in_cells(sensor_in_robot);
  std::vector<FixedPoint2> ends;
  ends.reserve(ends_in_robot.size());
  CellIndex low = sensor.index();
  CellIndex high = low;
  for (const Point2 end : ends_in_robot) {
    ends.push_back(in_cells(end));
    const CellIndex at = ends.back().index();
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y)};
  }
  const CellIndex low_tile{low.x >> tile_shift, low.y >> tile_shift};
  const CellIndex high_tile{high.x >> tile_shift, high.y >> tile_shift};
  include({low_tile.x >> tile_shift, low_tile.y >> tile_shift}, {high_tile.x >> tile_shift, high_tile.y >> tile_shift});
  // Tiles that this map has made its own already, so that each is looked at once.
  const std::int32_t width = high_tile.x - low_tile.x + 1;
  std::vector<Tile*> owned(static_cast<std::size_t>(width * (high_tile.y - low_tile.y + 1)), nullptr);
  const auto tile_of = [&](std::int32_t x, std::int32_t y) -> Tile& {
    const std::int32_t tile_x = x >> tile_shift;
    const std::int32_t tile_y = y >> tile_shift;
    Tile*& tile = owned[static_cast<std::size_t>((tile_y - low_tile.y) * width + tile_x - low_tile.x)];
    if (tile == nullptr) { tile = &own_tile(tile_x, tile_y); }
    return *tile;
  };
  for (const FixedPoint2& end : ends) {
    traverse(sensor, end, [&](std::int32_t x, std::int32_t y) { count_pass(tile_of(x, y), x, y); });
    const CellIndex last = end.index();
    count_hit(tile_of(last.x, last.y), end);
  }
}

std::vector<const RbpfMap::Tile*> RbpfMap::tiles() const {
  std::vector<const Tile*> found;
  for (const std::shared_ptr<Block>& block : table_.blocks) {
    if (!block) { continue; }
    for (const std::shared_ptr<Tile>& tile : block->tiles) {
      if (tile) { found.push_back(tile.get()); }
    }
  }
  return found;
}

}  // namespace flirt
