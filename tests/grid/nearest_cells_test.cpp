#include "flirt/grid/nearest_cells.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

namespace flirt {
namespace {

std::vector<CellOffset> by_trying_all(const std::vector<std::uint8_t>& marked, int width, int height, int reach) {
  std::vector<CellOffset> result(marked.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      int best = reach * reach + 1;
      for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
          const int squared = (u - x) * (u - x) + (v - y) * (v - y);
          if (marked[static_cast<std::size_t>(v * width + u)] == 0 || squared >= best) { continue; }
          best = squared;
          result[static_cast<std::size_t>(y * width + x)] = {
              static_cast<std::int8_t>(u - x), static_cast<std::int8_t>(v - y), static_cast<std::uint8_t>(squared)};
        }
      }
    }
  }
  return result;
}

TEST(NearestCells, EqualsTryingAll) {
  Rng rng(3);
  for (const int reach : {1, 4, 8, 15}) {
    const int width = 61;
    const int height = 37;
    std::vector<std::uint8_t> marked(static_cast<std::size_t>(width * height));
    for (int i = 0; i < 25; ++i) { marked[rng.below(static_cast<std::uint32_t>(marked.size()))] = 1; }
    EXPECT_EQ(nearest_cells(marked, width, reach), by_trying_all(marked, width, height, reach)) << reach;
  }
}

TEST(NearestCells, FindsNothingOnAnUnmarkedRaster) {
  const std::vector<CellOffset> none = nearest_cells(std::vector<std::uint8_t>(12), 4, 5);
  EXPECT_EQ(none, std::vector<CellOffset>(12));
  EXPECT_EQ(none.front().squared_distance, CellOffset::none);
}

TEST(NearestCells, AcceptsARasterOfOneRowOrColumn) {
  const std::vector<std::uint8_t> marked{0, 0, 1, 0};
  EXPECT_EQ(nearest_cells(marked, 4, 2)[0], (CellOffset{2, 0, 4}));
  EXPECT_EQ(nearest_cells(marked, 1, 2)[3], (CellOffset{0, -1, 1}));
}

}  // namespace
}  // namespace flirt
