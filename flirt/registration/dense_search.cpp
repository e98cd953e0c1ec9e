// flirt/registration/dense_search.cpp: sums of shifted rows, compiled once per instruction set.
#include "flirt/registration/dense_search.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>
#include <utility>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/registration/dense_search.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#ifndef FLIRT_REGISTRATION_DENSE_SEARCH_ONCE
#define FLIRT_REGISTRATION_DENSE_SEARCH_ONCE
namespace flirt {

inline constexpr std::size_t block_columns = CoarseField::block_width;
inline constexpr std::size_t block_rows = CoarseField::block_height;

inline constexpr std::size_t tile_columns = 4;
inline constexpr std::size_t tiles_per_block = block_columns / tile_columns;

/// Sums over the end points at each cell of a block.
struct BlockSums {
  alignas(64) std::uint16_t sums[block_rows * block_columns];
};

}  // namespace flirt
#endif

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::CappedTag<std::uint8_t, block_columns>;
using Words = hn::Repartition<std::uint16_t, Bytes>;
constexpr std::size_t byte_lanes = hn::MaxLanes(Bytes{});
constexpr std::size_t byte_parts = block_columns / byte_lanes;

/// sums[row][column] = Σ over points of corner[offset + row · stride + column]. Bytes hold `per_byte` values before
/// they have to be added to words.
void sum_block(const std::uint8_t* corner, std::size_t stride, const std::int32_t* offsets, std::size_t count,
               std::size_t per_byte, BlockSums& result) {
  const Bytes d8;
  const hn::Rebind<std::uint16_t, hn::Half<Bytes>> d16;
  const hn::Half<Bytes> d8_half;
  constexpr std::size_t half_lanes = hn::MaxLanes(d8_half);
  std::memset(result.sums, 0, sizeof(result.sums));
  for (std::size_t part = 0; part < byte_parts; ++part) {
    const std::uint8_t* const part_corner = corner + part * byte_lanes;
    for (std::size_t begin = 0; begin < count; begin += per_byte) {
      const std::size_t end = HWY_MIN(count, begin + per_byte);
      auto row0 = hn::Zero(d8);
      auto row1 = hn::Zero(d8);
      auto row2 = hn::Zero(d8);
      auto row3 = hn::Zero(d8);
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint8_t* const first = part_corner + offsets[k];
        row0 = hn::Add(row0, hn::LoadU(d8, first));
        row1 = hn::Add(row1, hn::LoadU(d8, first + stride));
        row2 = hn::Add(row2, hn::LoadU(d8, first + 2 * stride));
        row3 = hn::Add(row3, hn::LoadU(d8, first + 3 * stride));
      }
      alignas(64) std::uint8_t bytes[block_rows * byte_lanes];
      hn::Store(row0, d8, bytes);
      hn::Store(row1, d8, bytes + byte_lanes);
      hn::Store(row2, d8, bytes + 2 * byte_lanes);
      hn::Store(row3, d8, bytes + 3 * byte_lanes);
      for (std::size_t row = 0; row < block_rows; ++row) {
        for (std::size_t column = 0; column < byte_lanes; column += half_lanes) {
          std::uint16_t* const sum = result.sums + row * block_columns + part * byte_lanes + column;
          const auto more = hn::PromoteTo(d16, hn::LoadU(d8_half, bytes + row * byte_lanes + column));
          hn::StoreU(hn::Add(hn::LoadU(d16, sum), more), d16, sum);
        }
      }
    }
  }
}

/// best[tile] = the largest of 16 · sum + 4 · row + column over the 4 × 4 cells of the tile in which one can stand.
void best_in_tiles(const BlockSums& block, const std::uint8_t* standable, std::size_t standable_stride,
                   std::uint16_t* best) {
  const Words d;
  const hn::Rebind<std::uint8_t, Words> d_bytes;
  constexpr std::size_t lanes = hn::MaxLanes(d);
  const auto column = hn::And(hn::Iota(d, 0), hn::Set(d, 3));
  alignas(64) std::uint16_t keys[block_columns];
  for (std::size_t first = 0; first < block_columns; first += lanes) {
    auto largest = hn::Zero(d);
    for (std::size_t row = 0; row < block_rows; ++row) {
      const auto sum = hn::LoadU(d, block.sums + row * block_columns + first);
      const auto in_tile = hn::Add(column, hn::Set(d, static_cast<std::uint16_t>(4 * row)));
      const auto key =
          hn::Or(hn::ShiftLeft<4>(sum),
                 lanes < tile_columns ? hn::Add(in_tile, hn::Set(d, static_cast<std::uint16_t>(first & 3U))) : in_tile);
      const auto allowed = hn::PromoteTo(d, hn::LoadU(d_bytes, standable + row * standable_stride + first));
      largest = hn::Max(largest, hn::IfThenElseZero(hn::Ne(allowed, hn::Zero(d)), key));
    }
    hn::StoreU(largest, d, keys + first);
  }
  for (std::size_t tile = 0; tile < tiles_per_block; ++tile) {
    const std::uint16_t* const four = keys + tile * tile_columns;
    const std::uint16_t left = HWY_MAX(four[0], four[1]);
    const std::uint16_t right = HWY_MAX(four[2], four[3]);
    best[tile] = HWY_MAX(left, right);
  }
}

/// Best places of one block; offsets are those of the rows to add.
void search_block(const std::uint8_t* corner, std::size_t stride, const std::int32_t* offsets, std::size_t count,
                  std::size_t per_byte, const std::uint8_t* standable, std::size_t standable_stride,
                  std::uint16_t* best) {
  BlockSums sums;
  sum_block(corner, stride, offsets, count, per_byte, sums);
  best_in_tiles(sums, standable, standable_stride, best);
}

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt {
namespace {

HWY_EXPORT(search_block);

constexpr std::int32_t tile_side = tile_columns;
static_assert(block_rows == tile_columns);

/// A block's best place in each tile: sum above 4 bits of (row, column) in the tile; 0 where nobody can stand.
using TileKeys = std::array<std::uint16_t, tiles_per_block>;

/// End points turned to one heading, as steps in coarse cells.
struct Steps {
  std::vector<CellIndex> cells;
  CellIndex min{};
  CellIndex max{};
};

Steps steps_at(const ScanPoints& points, double heading, double cell_size, std::size_t count) {
  Steps steps;
  steps.cells.reserve(count);
  const double c = std::cos(heading) / cell_size;
  const double s = std::sin(heading) / cell_size;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = k * points.size() / count;
    const auto dx = static_cast<std::int32_t>(std::lround(c * points.x[i] - s * points.y[i]));
    const auto dy = static_cast<std::int32_t>(std::lround(s * points.x[i] + c * points.y[i]));
    steps.cells.push_back({dx, dy});
    steps.min = {std::min(steps.min.x, dx), std::min(steps.min.y, dy)};
    steps.max = {std::max(steps.max.x, dx), std::max(steps.max.y, dy)};
  }
  return steps;
}

/// Where the rows to add begin, as offsets from the block's corner. Steps that leave the padded field read padding.
void offsets_of(const Steps& steps, const CoarseField& coarse, CellIndex corner, std::vector<std::int32_t>& offsets) {
  const std::int32_t stride = coarse.values.width;
  offsets.resize(steps.cells.size());
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    const std::int32_t x = std::clamp(corner.x + steps.cells[k].x, -CoarseField::pad_x, coarse.width);
    const std::int32_t y = std::clamp(corner.y + steps.cells[k].y, -CoarseField::pad_y, coarse.height);
    offsets[k] = (y - corner.y) * stride + (x - corner.x);
  }
}

bool stays_inside(const Steps& steps, const CoarseField& coarse, CellIndex corner) {
  return corner.x + steps.min.x >= -CoarseField::pad_x && corner.x + steps.max.x <= coarse.width &&
         corner.y + steps.min.y >= -CoarseField::pad_y && corner.y + steps.max.y <= coarse.height;
}

/// Best key of each tile of some blocks at one heading; keys[i] belongs to blocks[i].
void search_heading(const CoarseField& coarse, const Steps& steps, std::span<const std::uint32_t> blocks,
                    std::vector<TileKeys>& keys) {
  const std::size_t per_byte = 255U / coarse.largest;
  const std::int32_t stride = coarse.values.width;
  std::vector<std::int32_t> inside(steps.cells.size());
  for (std::size_t k = 0; k < inside.size(); ++k) { inside[k] = steps.cells[k].y * stride + steps.cells[k].x; }
  std::vector<std::int32_t> clamped;
  keys.resize(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const CellIndex corner = coarse.blocks[blocks[i]];
    const bool all_inside = stays_inside(steps, coarse, corner);
    if (!all_inside) { offsets_of(steps, coarse, corner, clamped); }
    const std::int32_t* const offsets = all_inside ? inside.data() : clamped.data();
    HWY_DYNAMIC_DISPATCH(search_block)
    (&coarse.values.at(corner.x + CoarseField::pad_x, corner.y + CoarseField::pad_y), static_cast<std::size_t>(stride),
     offsets, inside.size(), per_byte, &coarse.standable.at(corner.x, corner.y),
     static_cast<std::size_t>(coarse.standable.width), keys[i].data());
  }
}

/// The best of some neighbouring headings in one tile.
struct TileBest {
  std::uint16_t key{0};
  std::uint16_t heading{0};
  std::uint32_t tile{0};  // block · tiles_per_block + tile in block
};

CoarsePose pose_of(const TileBest& best, const MapFields& fields, double heading_step, double scale) {
  const CoarseField& coarse = fields.coarse;
  const CellIndex corner = coarse.blocks[best.tile / tiles_per_block];
  const auto in_block = static_cast<std::int32_t>(best.tile % tiles_per_block) * tile_side;
  const std::int32_t x = corner.x + in_block + (best.key & 3);
  const std::int32_t y = corner.y + (best.key >> 2 & 3);
  return {{fields.origin.x + (x + 0.5) * coarse.cell_size, fields.origin.y + (y + 0.5) * coarse.cell_size,
           wrap_angle(best.heading * heading_step)},
          static_cast<float>((best.key >> 4) * scale)};
}

/// The `count` largest keys, equal ones in the order of headings and tiles. O(n + count log count).
void keep_best(std::vector<TileBest>& tiles, std::size_t count) {
  const auto better = [](const TileBest& a, const TileBest& b) {
    const int sum_a = a.key >> 4;
    const int sum_b = b.key >> 4;
    if (sum_a != sum_b) { return sum_a > sum_b; }
    return a.heading != b.heading ? a.heading < b.heading : a.tile < b.tile;
  };
  if (tiles.size() > count) {
    std::ranges::nth_element(tiles, tiles.begin() + static_cast<std::ptrdiff_t>(count), better);
    tiles.resize(count);
  }
  std::ranges::sort(tiles, better);
}

/// Headings that divide a full turn evenly.
struct Headings {
  std::size_t count;
  double step;  // rad
};

Headings headings_of(const DenseSearchParams& params) {
  const auto count = static_cast<std::size_t>(std::ceil(2 * std::numbers::pi / params.heading_step - 1e-9));
  return {count, 2 * std::numbers::pi / static_cast<double>(count)};
}

/// For each heading the blocks to search, in rising order.
using BlocksOfHeadings = std::vector<std::vector<std::uint32_t>>;

/// The blocks and headings around given places.
BlocksOfHeadings blocks_near(const MapFields& fields, std::span<const Pose2> places, const DenseSearchParams& params) {
  const CoarseField& coarse = fields.coarse;
  const Headings headings = headings_of(params);
  const std::int32_t columns = coarse.width / CoarseField::block_width;
  const std::int32_t rows = coarse.height / CoarseField::block_height;
  std::vector<std::int32_t> block_at(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), -1);
  const auto at = [&](std::int32_t column, std::int32_t row) -> std::int32_t& {
    return block_at[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                    static_cast<std::size_t>(column)];
  };
  for (std::size_t i = 0; i < coarse.blocks.size(); ++i) {
    at(coarse.blocks[i].x / CoarseField::block_width, coarse.blocks[i].y / CoarseField::block_height) =
        static_cast<std::int32_t>(i);
  }
  const auto block_of = [&](double metres, std::int32_t cells, std::int32_t count) {
    return std::clamp(static_cast<std::int32_t>(std::floor(metres / (coarse.cell_size * cells))), 0, count - 1);
  };
  const auto turns = static_cast<std::int64_t>(std::ceil(params.near_heading / headings.step));
  const auto turn = static_cast<std::int64_t>(headings.count);
  BlocksOfHeadings blocks(headings.count);
  for (const Pose2& place : places) {
    const double x = place.x - fields.origin.x;
    const double y = place.y - fields.origin.y;
    const double reach = params.near_distance;
    if (x < -reach || y < -reach || x > coarse.width * coarse.cell_size + reach ||
        y > coarse.height * coarse.cell_size + reach) {
      continue;
    }
    const std::int64_t heading = std::lround(place.theta / headings.step);
    for (std::int32_t row = block_of(y - reach, CoarseField::block_height, rows);
         row <= block_of(y + reach, CoarseField::block_height, rows); ++row) {
      for (std::int32_t column = block_of(x - reach, CoarseField::block_width, columns);
           column <= block_of(x + reach, CoarseField::block_width, columns); ++column) {
        if (at(column, row) < 0) { continue; }
        for (std::int64_t h = heading - turns; h <= heading + turns; ++h) {
          blocks[static_cast<std::size_t>((h % turn + turn) % turn)].push_back(
              static_cast<std::uint32_t>(at(column, row)));
        }
      }
    }
  }
  for (std::vector<std::uint32_t>& of_heading : blocks) {
    std::ranges::sort(of_heading);
    const auto doubles = std::ranges::unique(of_heading);
    of_heading.erase(doubles.begin(), doubles.end());
  }
  return blocks;
}

std::vector<CoarsePose> search_blocks(const MapFields& fields, const ScanPoints& points, const BlocksOfHeadings& blocks,
                                      const DenseSearchParams& params) {
  const CoarseField& coarse = fields.coarse;
  FLIRT_ASSERT(coarse.largest > 0);
  const std::size_t largest_count = std::min<std::size_t>(params.largest_point_count, 4095U / coarse.largest);
  const std::size_t count = std::min(points.size(), largest_count);
  const Headings headings = headings_of(params);

  std::vector<TileBest> tiles;
  std::vector<TileBest> group(coarse.blocks.size() * tiles_per_block);
  std::vector<std::uint32_t> touched;
  std::vector<TileKeys> keys;
  for (std::size_t heading = 0; heading < headings.count; ++heading) {
    const std::vector<std::uint32_t>& at_heading = blocks[heading];
    if (!at_heading.empty()) {
      const double angle = static_cast<double>(heading) * headings.step;
      search_heading(coarse, steps_at(points, angle, coarse.cell_size, count), at_heading, keys);
    }
    for (std::size_t i = 0; i < at_heading.size(); ++i) {
      for (std::size_t k = 0; k < tiles_per_block; ++k) {
        const std::size_t tile = at_heading[i] * tiles_per_block + k;
        const std::uint16_t key = keys[i][k];
        if (key <= group[tile].key) { continue; }
        if (group[tile].key == 0) { touched.push_back(static_cast<std::uint32_t>(tile)); }
        group[tile] = {key, static_cast<std::uint16_t>(heading), static_cast<std::uint32_t>(tile)};
      }
    }
    if ((heading + 1) % params.headings_per_tile == 0 || heading + 1 == headings.count) {
      for (const std::uint32_t tile : touched) { tiles.push_back(std::exchange(group[tile], {})); }
      touched.clear();
    }
  }
  keep_best(tiles, params.candidates);
  const double scale = 1.0 / (static_cast<double>(count) * coarse.largest);
  std::vector<CoarsePose> poses;
  poses.reserve(tiles.size());
  for (const TileBest& best : tiles) { poses.push_back(pose_of(best, fields, headings.step, scale)); }
  return poses;
}

}  // namespace

std::vector<CoarsePose> dense_search(const MapFields& fields, const ScanPoints& points,
                                     const DenseSearchParams& params) {
  if (fields.empty() || points.size() == 0) { return {}; }
  std::vector<std::uint32_t> all(fields.coarse.blocks.size());
  std::iota(all.begin(), all.end(), 0U);
  return search_blocks(fields, points, BlocksOfHeadings(headings_of(params).count, all), params);
}

std::vector<CoarsePose> dense_search_near(const MapFields& fields, const ScanPoints& points,
                                          std::span<const Pose2> map_from_sensor, const DenseSearchParams& params) {
  if (fields.empty() || points.size() == 0) { return {}; }
  return search_blocks(fields, points, blocks_near(fields, map_from_sensor, params), params);
}

}  // namespace flirt
#endif  // HWY_ONCE
