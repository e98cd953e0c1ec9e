// flirt/registration/dense_kernels.cpp: sums of shifted rows, compiled once per instruction set.
#include "flirt/registration/dense_kernels.hpp"

#include <algorithm>
#include <cstring>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/registration/dense_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include "flirt/registration/byte_sums-inl.hpp"

#ifndef FLIRT_REGISTRATION_DENSE_KERNELS_ONCE
#define FLIRT_REGISTRATION_DENSE_KERNELS_ONCE
namespace flirt::dense {

/// End points that a search uses at most: sums of them must leave 4 bits of a word for the place in a tile.
inline constexpr std::size_t most_points = 4096;
inline constexpr std::size_t lanes = 32;  ///< bytes valued together: the tiles of a panel's row, the cells of a pair
static_assert(lanes == CoarseField::panel_width / CoarseField::tile_side && lanes == CoarseField::pair_cells);

/// Where steps read: x · scale + y · stride + base, x and y held to a range.
struct Reading {
  std::int32_t x, y;  ///< of the place from which the steps are taken
  std::int32_t min_x, max_x, min_y, max_y;
  std::int32_t scale, stride;
};

/// Place of cell 4 · row + column in a pair's bytes, which lie column by column.
struct InTile {
  alignas(64) std::uint16_t of_lane[lanes];
};
constexpr InTile in_tile = [] {
  InTile table{};
  for (std::size_t i = 0; i < lanes; ++i) { table.of_lane[i] = static_cast<std::uint16_t>(4 * (i % 4) + i / 4 % 4); }
  return table;
}();

}  // namespace flirt::dense
#endif

HWY_BEFORE_NAMESPACE();
namespace flirt::dense::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using flirt::HWY_NAMESPACE::add_to_words;

using Bytes = hn::CappedTag<std::uint8_t, lanes>;
constexpr std::size_t byte_lanes = hn::MaxLanes(Bytes{});
constexpr std::size_t parts = lanes / byte_lanes;

/// offsets[k] of all steps, the last ones beyond `count` too.
void offsets_of(const std::int32_t* x, const std::int32_t* y, std::size_t count, const Reading& reading,
                std::int32_t* offsets) {
  const hn::CappedTag<std::int32_t, 16> d;
  const auto x0 = hn::Set(d, reading.x);
  const auto y0 = hn::Set(d, reading.y);
  for (std::size_t k = 0; k < count; k += hn::MaxLanes(d)) {
    const auto to_x = hn::Clamp(hn::Add(hn::LoadU(d, x + k), x0), hn::Set(d, reading.min_x), hn::Set(d, reading.max_x));
    const auto to_y = hn::Clamp(hn::Add(hn::LoadU(d, y + k), y0), hn::Set(d, reading.min_y), hn::Set(d, reading.max_y));
    const auto offset = hn::Add(hn::Mul(to_x, hn::Set(d, reading.scale)), hn::Mul(to_y, hn::Set(d, reading.stride)));
    hn::StoreU(offset, d, offsets + k);
  }
}

void bound_panel(const std::uint8_t* peaks, std::size_t step, const std::int32_t* offsets, std::size_t count,
                 std::size_t per_byte, const std::uint8_t* pairs, std::uint8_t* bounds) {
  constexpr std::size_t rows = CoarseField::panel_rows;
  alignas(64) std::uint16_t sums[rows * lanes] = {};
  const Bytes d8;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::uint8_t* const corner = peaks + part * byte_lanes;
    for (std::size_t begin = 0; begin < count; begin += per_byte) {
      const std::size_t end = HWY_MIN(count, begin + per_byte);
      auto row0 = hn::Zero(d8);
      auto row1 = hn::Zero(d8);
      auto row2 = hn::Zero(d8);
      auto row3 = hn::Zero(d8);
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint8_t* const first = corner + offsets[k];
        row0 = hn::Add(row0, hn::LoadU(d8, first));
        row1 = hn::Add(row1, hn::LoadU(d8, first + step));
        row2 = hn::Add(row2, hn::LoadU(d8, first + 2 * step));
        row3 = hn::Add(row3, hn::LoadU(d8, first + 3 * step));
      }
      add_to_words(d8, row0, sums + part * byte_lanes);
      add_to_words(d8, row1, sums + lanes + part * byte_lanes);
      add_to_words(d8, row2, sums + 2 * lanes + part * byte_lanes);
      add_to_words(d8, row3, sums + 3 * lanes + part * byte_lanes);
    }
  }
  // The larger of each two tiles, in sixteenths rounded up; the narrowing to bytes saturates.
  const hn::CappedTag<std::uint16_t, lanes / 2> d16;
  const hn::RebindToSigned<decltype(d16)> d_signed;
  const hn::Rebind<std::uint8_t, decltype(d16)> d_narrow;
  for (std::size_t i = 0; i < CoarseField::panel_pairs; i += hn::MaxLanes(d16)) {
    auto left = hn::Zero(d16);
    auto right = hn::Zero(d16);
    hn::LoadInterleaved2(d16, sums + 2 * i, left, right);
    const auto sixteenths = hn::ShiftRight<4>(hn::Add(hn::Max(left, right), hn::Set(d16, 15)));
    const auto bound = hn::DemoteTo(d_narrow, hn::BitCast(d_signed, sixteenths));
    hn::StoreU(hn::And(bound, hn::LoadU(d_narrow, pairs + i)), d_narrow, bounds + i);
  }
}

std::size_t largest_of(const std::uint16_t* sums) {
  const hn::CappedTag<std::uint16_t, lanes / 2> d;
  auto best = hn::Zero(d);
  for (std::size_t i = 0; i < lanes; i += hn::MaxLanes(d)) { best = hn::Max(best, hn::Load(d, sums + i)); }
  return hn::GetLane(hn::MaxOfLanes(d, best));
}

/// Gives up as soon as no sum can reach `least`, each end point being worth at most `largest`.
void search_pair(const std::uint8_t* quads, const std::int32_t* x, const std::int32_t* y, std::size_t count,
                 const Reading& reading, std::size_t largest, std::size_t least, const std::uint8_t* standable,
                 std::uint16_t* keys) {
  const std::size_t per_byte = 255U / largest;
  alignas(64) std::int32_t offsets[most_points + 16];
  offsets_of(x, y, count, reading, offsets);
  alignas(64) std::uint16_t sums[lanes] = {};
  const Bytes d8;
  for (std::size_t begin = 0; begin < count; begin += 2 * per_byte) {
    const std::size_t end = HWY_MIN(count, begin + 2 * per_byte);
    for (std::size_t part = 0; part < parts; ++part) {
      const std::uint8_t* const corner = quads + part * byte_lanes;
      auto even = hn::Zero(d8);  // two sums, as each addition waits for the last
      auto odd = hn::Zero(d8);
      std::size_t k = begin;
      for (; k + 2 <= end; k += 2) {
        even = hn::Add(even, hn::LoadU(d8, corner + offsets[k]));
        odd = hn::Add(odd, hn::LoadU(d8, corner + offsets[k + 1]));
      }
      if (k < end) { even = hn::Add(even, hn::LoadU(d8, corner + offsets[k])); }
      add_to_words(d8, even, sums + part * byte_lanes);
      add_to_words(d8, odd, sums + part * byte_lanes);
    }
    if (largest_of(sums) + (count - end) * largest < least) {
      keys[0] = 0;
      keys[1] = 0;
      return;
    }
  }
  const hn::CappedTag<std::uint16_t, lanes / 2> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d_narrow;
  for (std::size_t tile = 0; tile < 2; ++tile) {
    auto best = hn::Zero(d16);
    for (std::size_t i = tile * lanes / 2; i < (tile + 1) * lanes / 2; i += hn::MaxLanes(d16)) {
      const auto key = hn::Or(hn::ShiftLeft<4>(hn::LoadU(d16, sums + i)), hn::LoadU(d16, in_tile.of_lane + i));
      const auto allowed = hn::PromoteTo(d16, hn::LoadU(d_narrow, standable + i));
      best = hn::Max(best, hn::IfThenElseZero(hn::Ne(allowed, hn::Zero(d16)), key));
    }
    keys[tile] = hn::GetLane(hn::MaxOfLanes(d16, best));
  }
}

}  // namespace
}  // namespace flirt::dense::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt::dense {
namespace {

HWY_EXPORT(offsets_of);
HWY_EXPORT(bound_panel);
HWY_EXPORT(search_pair);

constexpr std::int32_t side = CoarseField::tile_side;
constexpr auto phases = static_cast<std::int32_t>(CoarseField::phases);

std::size_t per_byte(const CoarseField& field) {
  return 255U / field.largest;
}

}  // namespace

Steps::Steps(std::size_t points) : count(points) {
  const std::size_t whole_vectors = (points + 15) / 16 * 16;
  for (std::vector<std::int32_t>* column : {&x, &y, &tile_x, &peak_row}) { column->resize(whole_vectors); }
}

void Steps::set(std::size_t i, std::int32_t dx, std::int32_t dy) {
  x[i] = dx;
  y[i] = dy;
  tile_x[i] = dx >> 2;
  peak_row[i] = (dy >> 2) * phases + (dy & 3) * side + (dx & 3);
}

void bound_panel(const CoarseField& field, const CoarseField::Panel& panel, const Steps& steps, std::uint8_t* bounds) {
  const std::int32_t pad_x = CoarseField::panel_width / side;
  const std::int32_t pad_y = CoarseField::panel_rows;
  const std::int32_t stride = field.peak_stride();
  // Held to rows of the padding, where the phase makes no difference.
  const Reading reading{.x = panel.corner.x / side + pad_x,
                        .y = (panel.corner.y / side + pad_y) * phases,
                        .min_x = 0,
                        .max_x = CoarseField::tiles(field.width) + pad_x,
                        .min_y = 0,
                        .max_y = (CoarseField::tiles(field.height) + pad_y) * phases,
                        .scale = 1,
                        .stride = stride};
  alignas(64) std::array<std::int32_t, most_points + 16> offsets;
  HWY_DYNAMIC_DISPATCH(offsets_of)
  (steps.tile_x.data(), steps.peak_row.data(), steps.count, reading, offsets.data());
  HWY_DYNAMIC_DISPATCH(bound_panel)
  (field.peaks.data(), static_cast<std::size_t>(stride) * CoarseField::phases, offsets.data(), steps.count,
   per_byte(field), panel.pairs.data(), bounds);
}

PairKeys search_pair(const CoarseField& field, CellIndex corner, const std::uint8_t* standable, const Steps& steps,
                     int least) {
  const std::int32_t pad_x = CoarseField::pair_width;
  const std::int32_t pad_y = side;
  const Reading reading{.x = corner.x + pad_x,
                        .y = corner.y + pad_y,
                        .min_x = 0,
                        .max_x = field.width + pad_x,
                        .min_y = 0,
                        .max_y = field.height + pad_y,
                        .scale = side,
                        .stride = side * field.quads.width};
  PairKeys keys{};
  HWY_DYNAMIC_DISPATCH(search_pair)
  (field.quads.cells.front().data(), steps.x.data(), steps.y.data(), steps.count, reading, field.largest,
   static_cast<std::size_t>(least), standable, keys.data());
  return keys;
}

}  // namespace flirt::dense
#endif  // HWY_ONCE
