// flirt/registration/window_kernels.cpp: sums of shifted rows, compiled once per instruction set.
#include "flirt/registration/window_kernels.hpp"

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/registration/window_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include "flirt/registration/byte_sums-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// A loop that compilers turn into vectors.
void row_offsets(const CellIndex* cells, std::size_t count, std::int32_t x, std::int32_t y, std::int32_t* offsets) {
  for (std::size_t i = 0; i < count; ++i) { offsets[i] = LocalMap::row_begin({cells[i].x + x, cells[i].y + y}); }
}

/// sums[k] = Σᵢ bytes[offsets[i] + k] for k < width.
template <std::size_t width>
void sum_bytes(const std::uint8_t* bytes, const std::int32_t* offsets, std::size_t count, std::uint16_t* sums) {
  constexpr std::size_t in_a_byte = 255 / LocalMap::largest;
  const hn::CappedTag<std::uint8_t, width> d8;
  for (std::size_t k = 0; k < width; ++k) { sums[k] = 0; }
  for (std::size_t part = 0; part < width; part += hn::MaxLanes(d8)) {
    for (std::size_t begin = 0; begin < count; begin += in_a_byte) {
      const std::size_t end = HWY_MIN(count, begin + in_a_byte);
      auto sum = hn::Zero(d8);
      for (std::size_t i = begin; i < end; ++i) { sum = hn::Add(sum, hn::LoadU(d8, bytes + part + offsets[i])); }
      add_to_words(d8, sum, sums + part);
    }
  }
}

void sum_rows(const std::uint8_t* bytes, const std::int32_t* offsets, std::size_t count, std::uint16_t* sums) {
  sum_bytes<LocalMap::row_length>(bytes, offsets, count, sums);
}
void sum_tiles(const std::uint8_t* bytes, const std::int32_t* offsets, std::size_t count, std::uint16_t* sums) {
  sum_bytes<LocalMap::row_length / 2>(bytes, offsets, count, sums);
}

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt {
namespace {

HWY_EXPORT(row_offsets);
HWY_EXPORT(sum_rows);
HWY_EXPORT(sum_tiles);

}  // namespace

namespace window {

void row_offsets(std::span<const CellIndex> cells, std::int32_t x, std::int32_t y, std::span<std::int32_t> offsets) {
  HWY_DYNAMIC_DISPATCH(row_offsets)(cells.data(), cells.size(), x, y, offsets.data());
}

RowSums sum_rows(const std::uint8_t* bytes, std::span<const std::int32_t> offsets) {
  RowSums sums;
  HWY_DYNAMIC_DISPATCH(sum_rows)(bytes, offsets.data(), offsets.size(), sums.data());
  return sums;
}

TileSums sum_tiles(const std::uint8_t* bytes, std::span<const std::int32_t> offsets) {
  TileSums sums;
  HWY_DYNAMIC_DISPATCH(sum_tiles)(bytes, offsets.data(), offsets.size(), sums.data());
  return sums;
}

}  // namespace window
}  // namespace flirt
#endif  // HWY_ONCE
