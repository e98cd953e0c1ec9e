// flirt/grid/beam_traversal.hpp: the cells that a straight line crosses, by integers alone.
#pragma once

#include "flirt/core/pose2.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace flirt {

/// A cell of an unbounded square grid: covers [x, x + 1) × [y, y + 1) cell sizes.
struct CellIndex {
  std::int32_t x{0};
  std::int32_t y{0};

  friend bool operator==(const CellIndex&, const CellIndex&) = default;
};

/// A place in a grid in units of 1/8192 cell, always odd: it never lies on a boundary between cells, so that every
/// crossing of a line is strictly between its ends. At 0.05 m a cell the rounding is 6 µm.
struct FixedPoint2 {
  static constexpr std::int64_t cell = 8192;  ///< units per cell
  std::int64_t x{1};
  std::int64_t y{1};

  [[nodiscard]] CellIndex index() const {
    return {static_cast<std::int32_t>(x >> 13), static_cast<std::int32_t>(y >> 13)};
  }
};

/// The fixed point of a place given in cells.
[[nodiscard]] inline FixedPoint2 fixed_point(Point2 in_cells) {
  constexpr double half = 0.5 * static_cast<double>(FixedPoint2::cell);
  return {2 * static_cast<std::int64_t>(std::floor(in_cells.x * half)) + 1,
          2 * static_cast<std::int64_t>(std::floor(in_cells.y * half)) + 1};
}

/// Calls visit(x, y) for each cell that the line from `begin` to `end` crosses, in order, without the cell of `end`
/// (and so for none when both lie in one cell). Exact: no cell is missed and none is added, except that a line through
/// the very corner of four cells counts as crossing the boundary in x first. (Amanatides and Woo 1987, in integers;
/// no branch in the loop but its end.) O(cells).
template <class Visit>
void traverse(FixedPoint2 begin, FixedPoint2 end, const Visit& visit) {
  constexpr std::int64_t cell = FixedPoint2::cell;
  const std::int64_t dx = std::abs(end.x - begin.x);
  const std::int64_t dy = std::abs(end.y - begin.y);
  const std::int32_t step_x = end.x < begin.x ? -1 : 1;
  const std::int32_t step_y = end.y < begin.y ? -1 : 1;
  const std::int64_t in_cell_x = begin.x & (cell - 1);
  const std::int64_t in_cell_y = begin.y & (cell - 1);
  const std::int64_t to_boundary_x = step_x < 0 ? in_cell_x : cell - in_cell_x;
  const std::int64_t to_boundary_y = step_y < 0 ? in_cell_y : cell - in_cell_y;

  CellIndex at = begin.index();
  const CellIndex last = end.index();
  const std::int32_t steps = std::abs(last.x - at.x) + std::abs(last.y - at.y);
  // The next boundary in x comes first while to_boundary_x / dx <= to_boundary_y / dy.
  std::int64_t difference = to_boundary_x * dy - to_boundary_y * dx;
  const std::int64_t add_x = cell * dy;
  const std::int64_t add_y = -cell * dx;
  for (std::int32_t i = 0; i < steps; ++i) {
    visit(at.x, at.y);
    const bool cross_x = difference <= 0;
    at.x += cross_x ? step_x : 0;
    at.y += cross_x ? 0 : step_y;
    difference += cross_x ? add_x : add_y;
  }
}

}  // namespace flirt
