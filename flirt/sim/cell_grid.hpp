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

/// A ray's way through the cells along one axis. Lengths along the ray are in m, positions in cells but for `start`.
class AxisWalk {
 public:
  AxisWalk(double start, double direction, double cell_size, double cells_per_metre, std::int32_t cells)
      : start_(start * cells_per_metre),
        slope_(direction * cells_per_metre),
        inverse_(direction != 0 ? cell_size / direction : 0),
        step_(direction > 0   ? 1
              : direction < 0 ? -1
                              : 0),
        cells_(cells) {}

  /// Shortens [from, to] to what lies within the grid along this axis; false when nothing is left.
  [[nodiscard]] bool clip(double& from, double& to) const {
    if (step_ == 0) { return start_ >= 0 && start_ <= cells_; }
    const double first = -start_ * inverse_;
    const double second = (cells_ - start_) * inverse_;
    from = std::max(from, std::min(first, second));
    to = std::min(to, std::max(first, second));
    return from <= to;
  }
  /// Goes to the cell at `length`, no further away than `reach` cells.
  void enter(double length, std::int32_t reach) {
    const auto at = static_cast<std::int32_t>(start_ + length * slope_);  // positions in the grid are positive
    enter_cell(std::clamp(at, std::max(0, cell_ - reach), std::min(cells_ - 1, cell_ + reach)));
  }
  void enter_cell(std::int32_t cell) {
    cell_ = cell;
    leave_ = leave_after(1);
  }
  void enter_next() {
    cell_ += step_;
    leave_ += std::abs(inverse_);
  }
  /// Length at which the ray leaves this cell and the `count` − 1 next ones.
  [[nodiscard]] double leave_after(std::int32_t count) const {
    if (step_ == 0) { return std::numeric_limits<double>::infinity(); }
    return ((step_ > 0 ? cell_ + count : cell_ + 1 - count) - start_) * inverse_;
  }
  [[nodiscard]] double leave() const { return leave_; }
  [[nodiscard]] std::int32_t cell() const { return cell_; }
  [[nodiscard]] std::int32_t step() const { return step_; }
  [[nodiscard]] bool is_inside() const {
    return static_cast<std::uint32_t>(cell_) < static_cast<std::uint32_t>(cells_);
  }

 private:
  double start_;
  double slope_;    ///< cells per m
  double inverse_;  ///< m per cell; 0 when the ray does not move along this axis
  std::int32_t step_;
  std::int32_t cells_;
  std::int32_t cell_{0};
  double leave_{0};
};

/// Calls visit(CellVisit) for the cells with content that the ray origin + t · direction, t in [from, to], runs
/// through, in order, until visit returns true. `direction` has length 1. After Amanatides and Woo 1987, with jumps.
template <class Visit>
void walk(const CellGrid& grid, Point2 origin, Point2 direction, double from, double to, Visit&& visit) {
  constexpr std::int32_t least_jump = 3;  // cells; shorter ways are faster step by step
  const Point2 offset = origin - grid.origin;
  const double cells_per_metre = 1 / grid.cell_size;
  AxisWalk x(offset.x, direction.x, grid.cell_size, cells_per_metre, grid.columns);
  AxisWalk y(offset.y, direction.y, grid.cell_size, cells_per_metre, grid.rows);
  double enter = from;
  if (!x.clip(enter, to)) { return; }
  GridAxis crossed = enter > from ? GridAxis::x : GridAxis::none;
  const double enter_x = enter;
  if (!y.clip(enter, to)) { return; }
  if (enter > enter_x) { crossed = GridAxis::y; }
  x.enter(enter, grid.columns);
  y.enter(enter, grid.rows);
  while (true) {
    const std::int32_t steps = grid.steps_to_content[grid.index(x.cell(), y.cell())];
    if (steps == 0 &&
        visit(CellVisit{grid.index(x.cell(), y.cell()), enter, std::min(x.leave(), y.leave()), crossed})) {
      return;
    }
    // Both axes are spelled out: a reference to one of them would keep both walks out of the registers.
    if (steps < least_jump) {
      if (x.leave() <= y.leave()) {
        crossed = GridAxis::x;
        enter = x.leave();
        x.enter_next();
      } else {
        crossed = GridAxis::y;
        enter = y.leave();
        y.enter_next();
      }
    } else {  // the square of cells less than `steps` away is empty
      const double leave_x = x.leave_after(steps);
      const double leave_y = y.leave_after(steps);
      if (leave_x <= leave_y) {
        crossed = GridAxis::x;
        enter = leave_x;
        x.enter_cell(x.cell() + steps * x.step());
        y.enter(enter, steps - 1);
      } else {
        crossed = GridAxis::y;
        enter = leave_y;
        y.enter_cell(y.cell() + steps * y.step());
        x.enter(enter, steps - 1);
      }
    }
    if (enter > to || !x.is_inside() || !y.is_inside()) { return; }
  }
}

}  // namespace flirt
