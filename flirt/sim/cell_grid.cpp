#include "flirt/sim/cell_grid.hpp"

#include <array>

namespace flirt {
namespace {

/// Lowers the cell to one step more than the least of the given neighbours.
void relax(CellGrid& grid, std::int32_t column, std::int32_t row,
           const std::array<std::array<std::int32_t, 2>, 4>& neighbours) {
  int steps = grid.steps_to_content[grid.index(column, row)];
  for (const auto& [right, up] : neighbours) {
    const std::int32_t x = column + right;
    const std::int32_t y = row + up;
    if (x < 0 || x >= grid.columns || y < 0 || y >= grid.rows) { continue; }
    steps = std::min(steps, grid.steps_to_content[grid.index(x, y)] + 1);
  }
  grid.steps_to_content[grid.index(column, row)] = static_cast<std::uint8_t>(steps);
}

}  // namespace

void measure_steps(CellGrid& grid) {
  for (std::uint8_t& steps : grid.steps_to_content) { steps = steps == 0 ? 0 : 255; }
  for (std::int32_t row = 0; row < grid.rows; ++row) {
    for (std::int32_t column = 0; column < grid.columns; ++column) {
      relax(grid, column, row, {{{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}});
    }
  }
  for (std::int32_t row = grid.rows - 1; row >= 0; --row) {
    for (std::int32_t column = grid.columns - 1; column >= 0; --column) {
      relax(grid, column, row, {{{1, 0}, {1, 1}, {0, 1}, {-1, 1}}});
    }
  }
}

}  // namespace flirt
