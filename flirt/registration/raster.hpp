// flirt/registration/raster.hpp: a rectangle of cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

/// Place of (x, y), neither negative, in rows of `width`.
[[nodiscard]] constexpr std::size_t row_offset(std::int32_t x, std::int32_t y, std::int32_t width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

/// Square cells, row by row from the lower left corner.
template <class T>
struct Raster {
  std::int32_t width{0};   ///< cells
  std::int32_t height{0};  ///< cells
  std::vector<T> cells{};

  Raster() = default;
  Raster(std::int32_t columns, std::int32_t rows, const T& value = {})
      : width(columns),
        height(rows),
        cells(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), value) {}

  [[nodiscard]] bool contains(std::int32_t x, std::int32_t y) const {
    return static_cast<std::uint32_t>(x) < static_cast<std::uint32_t>(width) &&
           static_cast<std::uint32_t>(y) < static_cast<std::uint32_t>(height);
  }
  [[nodiscard]] std::size_t offset(std::int32_t x, std::int32_t y) const { return row_offset(x, y, width); }
  [[nodiscard]] const T& at(std::int32_t x, std::int32_t y) const { return cells[offset(x, y)]; }
  [[nodiscard]] T& at(std::int32_t x, std::int32_t y) { return cells[offset(x, y)]; }
};

}  // namespace flirt
