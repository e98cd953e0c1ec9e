// flirt/sim/cell_grid.hpp: a regular grid that a ray crosses in a few steps, jumping over empty squares.
#pragma once

#include "flirt/core/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace flirt {

/// Square cells, each with the number of steps (king's moves) to the nearest cell that holds something: 0 = this one.
struct CellGrid {
  Point2 origin{};      ///< m, lower left corner of cell 0
  double cell_size{1};  ///< m
  std::int32_t columns{0};
  std::int32_t rows{0};
  std::vector<std::uint8_t> steps_to_content{};  ///< rows × columns; 255 means "255 or more"

  [[nodiscard]] std::size_t index(std::int32_t column, std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
};

/// Fills `steps_to_content` from its own zeros: cells that hold something are 0, all others anything. O(cells).
void measure_steps(CellGrid& grid);

enum class GridAxis : std::uint8_t { none, x, y };

/// A cell on the way of a ray.
struct CellVisit {
  std::size_t cell{0};
  double enter{0};  ///< m along the ray
  double leave{0};  ///< m along the ray
  GridAxis crossed{
      GridAxis::none};  ///< direction of travel through the border by which the ray came in; none: the ray starts in it
};

/// Calls visit(CellVisit) for the cells with content that the ray origin + t · direction, t in [from, to], runs
/// through, in order, until visit returns true. `direction` has length 1. After Amanatides and Woo 1987, with jumps.
template <class Visit>
void walk(const CellGrid& grid, Point2 origin, Point2 direction, double from, double to, Visit&& visit) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double scale = 1.0 / grid.cell_size;
  const Point2 start = scale * (origin - grid.origin);  // cells
  const Point2 inverse{direction.x != 0 ? grid.cell_size / direction.x : infinity,
                       direction.y != 0 ? grid.cell_size / direction.y : infinity};  // m per cell
  const Point2 slope = scale * direction;                                            // cells per m
  GridAxis crossed = GridAxis::none;
  const auto clip = [&](double position, double inverse_slope, double cells, GridAxis axis) {
    if (std::isinf(inverse_slope)) { return position >= 0 && position <= cells; }
    const double first = -position * inverse_slope;
    const double second = (cells - position) * inverse_slope;
    if (std::min(first, second) > from) {
      from = std::min(first, second);
      crossed = axis;
    }
    to = std::min(to, std::max(first, second));
    return from <= to;
  };
  if (!clip(start.x, inverse.x, grid.columns, GridAxis::x) || !clip(start.y, inverse.y, grid.rows, GridAxis::y)) {
    return;
  }

  const auto cell_at = [](double position, std::int32_t low, std::int32_t high) {
    return std::clamp(static_cast<std::int32_t>(position), low, high);
  };
  std::int32_t column = cell_at(start.x + from * slope.x, 0, grid.columns - 1);
  std::int32_t row = cell_at(start.y + from * slope.y, 0, grid.rows - 1);
  double enter = from;
  while (true) {
    const std::size_t cell = grid.index(column, row);
    const std::int32_t steps = grid.steps_to_content[cell];
    const std::int32_t reach = std::max(steps, 1);  // the square of cells within reach - 1 has nothing else in it
    const std::int32_t border_x = direction.x > 0 ? column + reach : column + 1 - reach;
    const std::int32_t border_y = direction.y > 0 ? row + reach : row + 1 - reach;
    const double leave_x = direction.x != 0 ? (border_x - start.x) * inverse.x : infinity;
    const double leave_y = direction.y != 0 ? (border_y - start.y) * inverse.y : infinity;
    const double leave = std::min(leave_x, leave_y);
    if (steps == 0 && visit(CellVisit{cell, enter, leave, crossed})) { return; }
    if (leave >= to) { return; }
    enter = std::max(enter, leave);
    if (leave_x <= leave_y) {
      column = direction.x > 0 ? column + reach : column - reach;
      row = cell_at(start.y + leave * slope.y, row + 1 - reach, row + reach - 1);
      crossed = GridAxis::x;
    } else {
      row = direction.y > 0 ? row + reach : row - reach;
      column = cell_at(start.x + leave * slope.x, column + 1 - reach, column + reach - 1);
      crossed = GridAxis::y;
    }
    if (column < 0 || column >= grid.columns || row < 0 || row >= grid.rows) { return; }
  }
}

}  // namespace flirt
