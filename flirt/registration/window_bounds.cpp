#include "flirt/registration/window_bounds.hpp"

#include <algorithm>
#include <array>

namespace flirt {
namespace {

constexpr std::int32_t lanes = 2 * WindowBounds::strip_tiles;  // tiles that are summed side by side
constexpr std::size_t cells_in_a_byte = 17;                    // 17 · 15 = 255
static_assert(WindowBounds::strip_tiles * WindowBounds::tile_side == LocalMap::row_length);
static_assert(cells_in_a_byte * LocalMap::largest <= 255);

using Lanes = std::array<std::uint16_t, lanes>;

/// into[i] = max(into[i], other[i]); a loop that compilers turn into vectors.
void take_maximum(std::uint8_t* into, const std::uint8_t* other, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) { into[i] = into[i] < other[i] ? other[i] : into[i]; }
}

/// A loop that compilers turn into vectors.
void copy_every_fourth(const std::uint8_t* from, std::uint8_t* to, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) { to[i] = from[i * WindowBounds::tile_side]; }
}

/// The largest of each four neighbours in a row of the map.
void largest_in_row(const LocalMap& map, CellIndex first, std::vector<std::uint8_t>& row) {
  for (std::size_t x = 0; x < row.size(); x += LocalMap::row_length) {
    const auto n = std::min<std::size_t>(LocalMap::row_length, row.size() - x);
    std::copy_n(map.row({first.x + static_cast<std::int32_t>(x), first.y}), n,
                row.begin() + static_cast<std::ptrdiff_t>(x));
  }
  const std::size_t n = row.size();
  for (const std::size_t step : {std::size_t{1}, std::size_t{2}}) {
    take_maximum(row.data(), row.data() + step, n - step);
  }
}

}  // namespace

WindowBounds::WindowBounds(const LocalMap& map, CellIndex middle, std::int32_t radius, std::int32_t reach)
    : reach_(reach), first_{middle.x - radius - reach, middle.y - radius - reach}, stride_(0) {
  const std::int32_t width = 2 * (radius + reach) + 1;
  const std::int32_t beyond = lanes * tile_side;  // read, but not asked for
  stride_ = (static_cast<std::size_t>(width) + beyond + tile_side - 1) / tile_side;
  const std::size_t in_row = stride_ * tile_side;
  const auto rows = static_cast<std::size_t>(width) + tile_side;
  largest_.resize(rows * in_row);
  std::array<std::vector<std::uint8_t>, tile_side> newest;
  for (auto& row : newest) { row.assign(in_row + tile_side, 0); }
  std::vector<std::uint8_t> best(in_row + tile_side);
  for (std::size_t y = 0; y < rows + tile_side - 1; ++y) {
    largest_in_row(map, {first_.x, first_.y + static_cast<std::int32_t>(y)}, newest[y % tile_side]);
    if (y + 1 < tile_side) { continue; }
    best = newest[0];
    for (std::size_t k = 1; k < tile_side; ++k) { take_maximum(best.data(), newest.at(k).data(), best.size()); }
    std::uint8_t* row = largest_.data() + (y + 1 - tile_side) * in_row;
    for (std::size_t k = 0; k < tile_side; ++k) { copy_every_fourth(best.data() + k, row + k * stride_, stride_); }
  }
}

std::vector<std::uint16_t> WindowBounds::of(std::span<const CellIndex> cells) const {
  const std::int32_t count = strips();
  std::vector<std::uint16_t> bounds;
  bounds.reserve(static_cast<std::size_t>(tile_rows()) * static_cast<std::size_t>(count));
  for (std::int32_t row = 0; row < tile_rows(); ++row) {
    const std::int32_t y = tile_side * row - reach_;
    for (std::int32_t strip = 0; strip < count; strip += 2) {
      const std::int32_t x = LocalMap::row_length * strip - reach_;
      Lanes sums{};
      for (std::size_t begin = 0; begin < cells.size(); begin += cells_in_a_byte) {
        std::array<std::uint8_t, lanes> bytes{};
        for (const CellIndex& cell : cells.subspan(begin, std::min(cells_in_a_byte, cells.size() - begin))) {
          const std::uint8_t* largest = at({cell.x + x, cell.y + y});
          for (std::size_t k = 0; k < bytes.size(); ++k) {
            bytes[k] = static_cast<std::uint8_t>(bytes[k] + largest[k]);
          }
        }
        for (std::size_t k = 0; k < bytes.size(); ++k) { sums[k] = static_cast<std::uint16_t>(sums[k] + bytes[k]); }
      }
      bounds.push_back(*std::max_element(sums.begin(), sums.begin() + strip_tiles));
      if (strip + 1 < count) { bounds.push_back(*std::max_element(sums.begin() + strip_tiles, sums.end())); }
    }
  }
  return bounds;
}

}  // namespace flirt
