#include "flirt/grid/nearest_cells.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <cstdlib>

namespace flirt {
namespace {

/// A squared distance (at most 2 · 15² = 450, or `far`) above a 5-bit step + 16: the least key is the nearest cell, and
/// among equally near ones that of the lowest step.
using Key = std::uint16_t;
constexpr unsigned step_bits = 5;
constexpr Key step_mask = (1U << step_bits) - 1;
constexpr Key far = 1000;

Key key(int squared_distance, int step) {
  return static_cast<Key>((static_cast<unsigned>(squared_distance) << step_bits) | static_cast<unsigned>(step + 16));
}
int step_of(Key key) {
  return static_cast<int>(key & step_mask) - 16;
}
int squared_distance_of(Key key) {
  return key >> step_bits;
}

/// best[i] = min(best[i], other[i]); a loop that compilers turn into vectors.
void take_minimum(Key* best, const Key* other, Key add, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    const auto candidate = static_cast<Key>(other[i] + add);
    best[i] = best[i] < candidate ? best[i] : candidate;
  }
}

bool has_mark(std::span<const std::uint8_t> row) {
  return std::ranges::any_of(row, [](std::uint8_t mark) { return mark != 0; });
}

/// In one row: squared distance and step to the nearest marked cell. `padded` is scratch.
void nearest_in_row(const std::uint8_t* marked, std::size_t width, int reach, std::vector<Key>& padded, Key* best) {
  const auto margin = static_cast<std::size_t>(reach);
  padded.assign(width + 2 * margin, key(far, -16));
  for (std::size_t x = 0; x < width; ++x) {
    if (marked[x] != 0) { padded[margin + x] = key(0, -16); }
  }
  std::fill_n(best, width, key(far, 0));
  for (int step = -reach; step <= reach; ++step) {
    const Key* other = padded.data() + margin + step;
    take_minimum(best, other, key(step * step, step), width);
  }
}

}  // namespace

std::vector<CellOffset> nearest_cells(std::span<const std::uint8_t> marked, std::size_t width, int reach) {
  FLIRT_ASSERT(reach >= 1 && reach <= longest_reach && width > 0 && marked.size() % width == 0);
  const std::size_t height = marked.size() / width;
  std::vector<CellOffset> nearest(marked.size());
  std::vector<std::size_t> marked_rows;
  for (std::size_t y = 0; y < height; ++y) {
    if (has_mark(marked.subspan(y * width, width))) { marked_rows.push_back(y); }
  }
  if (marked_rows.empty()) { return nearest; }
  std::vector<Key> in_row(marked.size());           // of rows without marks: not used
  std::vector<Key> distance_in_row(marked.size());  // without the step in x
  std::vector<Key> scratch;
  for (const std::size_t y : marked_rows) {
    nearest_in_row(&marked[y * width], width, reach, scratch, &in_row[y * width]);
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      distance_in_row[i] = static_cast<Key>(in_row[i] & ~step_mask);
    }
  }

  std::vector<Key> best(width);
  for (std::size_t y = 0; y < height; ++y) {
    std::fill(best.begin(), best.end(), key(far, 0));
    const auto margin = static_cast<std::size_t>(reach);
    auto row = std::ranges::lower_bound(marked_rows, y - std::min(y, margin));
    if (row == marked_rows.end() || *row > y + margin) { continue; }
    for (; row != marked_rows.end() && *row <= y + margin; ++row) {
      const int step = static_cast<int>(*row) - static_cast<int>(y);
      take_minimum(best.data(), &distance_in_row[*row * width], key(step * step, step), width);
    }
    for (std::size_t x = 0; x < width; ++x) {
      const int squared = squared_distance_of(best[x]);
      if (squared > reach * reach) { continue; }
      const int dy = step_of(best[x]);
      const std::size_t nearest_row = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(y) + dy) * width;
      nearest[y * width + x] = {static_cast<std::int8_t>(step_of(in_row[nearest_row + x])),
                                static_cast<std::int8_t>(dy), static_cast<std::uint8_t>(squared)};
    }
  }
  return nearest;
}

}  // namespace flirt
