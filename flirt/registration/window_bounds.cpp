#include "flirt/registration/window_bounds.hpp"

#include "flirt/registration/window_kernels.hpp"

#include <algorithm>
#include <array>
#include <tuple>

namespace flirt {
namespace {

constexpr std::int32_t lanes = 2 * WindowBounds::strip_tiles;  // tiles that are summed side by side
static_assert(WindowBounds::strip_tiles * WindowBounds::tile_side == LocalMap::row_length);
static_assert(lanes == std::tuple_size_v<window::TileSums>);

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
  std::vector<std::int32_t> offsets;
  offsets.reserve(cells.size());
  for (const CellIndex& cell : cells) { offsets.push_back(offset_of({cell.x - reach_, cell.y - reach_})); }
  std::vector<std::uint16_t> bounds;
  bounds.reserve(static_cast<std::size_t>(tile_rows()) * static_cast<std::size_t>(count));
  for (std::int32_t row = 0; row < tile_rows(); ++row) {
    for (std::int32_t strip = 0; strip < count; strip += 2) {
      // Tiles lie side by side, and tile_side rows of cells above each other.
      const std::size_t corner = static_cast<std::size_t>(row) * tile_side * tile_side * stride_ +
                                 static_cast<std::size_t>(strip) * strip_tiles;
      const window::TileSums sums = window::sum_tiles(largest_.data() + corner, offsets);
      bounds.push_back(*std::max_element(sums.begin(), sums.begin() + strip_tiles));
      if (strip + 1 < count) { bounds.push_back(*std::max_element(sums.begin() + strip_tiles, sums.end())); }
    }
  }
  return bounds;
}

}  // namespace flirt
