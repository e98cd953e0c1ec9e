#include "flirt/grid/beam_traversal.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace flirt {
namespace {

std::vector<CellIndex> traversed(FixedPoint2 begin, FixedPoint2 end) {
  std::vector<CellIndex> cells;
  traverse(begin, end, [&](std::int32_t x, std::int32_t y) { cells.push_back({x, y}); });
  return cells;
}

/// A slow derivation: all crossings of cell boundaries sorted along the line, the cell between each two by its middle.
std::vector<CellIndex> by_sorted_crossings(FixedPoint2 begin, FixedPoint2 end) {
  const auto cell = static_cast<long double>(FixedPoint2::cell);
  const long double x = begin.x / cell;
  const long double y = begin.y / cell;
  const long double dx = (end.x - begin.x) / cell;
  const long double dy = (end.y - begin.y) / cell;
  std::vector<long double> crossings{0, 1};
  const auto add = [&](long double from, long double step) {
    const long double low = std::min(from, from + step);
    const long double high = std::max(from, from + step);
    for (long double line = std::ceil(low); line < high; line += 1) { crossings.push_back((line - from) / step); }
  };
  add(x, dx);
  add(y, dy);
  std::ranges::sort(crossings);
  std::vector<CellIndex> cells;
  for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
    const long double middle = (crossings[i] + crossings[i + 1]) / 2;
    const CellIndex index{static_cast<std::int32_t>(std::floor(x + middle * dx)),
                          static_cast<std::int32_t>(std::floor(y + middle * dy))};
    if (index != end.index()) { cells.push_back(index); }
  }
  return cells;
}

TEST(Traverse, EqualsSortedCrossingsOnRandomLines) {
  Rng rng(1);
  for (int i = 0; i < 2000; ++i) {
    const FixedPoint2 begin = fixed_point({rng.uniform(-30, 30), rng.uniform(-30, 30)});
    const FixedPoint2 end = fixed_point({rng.uniform(-30, 30), rng.uniform(-30, 30)});
    EXPECT_EQ(traversed(begin, end), by_sorted_crossings(begin, end)) << i;
  }
}

TEST(Traverse, VisitsAStraightRowOnce) {
  const std::vector<CellIndex> expected{{2, 5}, {1, 5}, {0, 5}, {-1, 5}};
  EXPECT_EQ(traversed(fixed_point({2.5, 5.5}), fixed_point({-1.5, 5.5})), (std::vector<CellIndex>(expected)));
}

TEST(Traverse, CrossesXFirstThroughACorner) {
  const std::vector<CellIndex> expected{{0, 0}, {1, 0}, {1, 1}, {2, 1}};
  EXPECT_EQ(traversed(fixed_point({0.5, 0.5}), fixed_point({2.5, 2.5})), expected);
}

TEST(Traverse, VisitsNothingWithinOneCell) {
  EXPECT_TRUE(traversed(fixed_point({0.1, 0.1}), fixed_point({0.9, 0.8})).empty());
}

TEST(Traverse, IsNeighbourByNeighbourFarFromTheOrigin) {
  const std::vector<CellIndex> cells = traversed(fixed_point({11520.3, -700.2}), fixed_point({11000.9, 420.7}));
  ASSERT_EQ(cells.size(), 520U + 1121U);
  for (std::size_t i = 1; i < cells.size(); ++i) {
    EXPECT_EQ(std::abs(cells[i].x - cells[i - 1].x) + std::abs(cells[i].y - cells[i - 1].y), 1);
  }
}

}  // namespace
}  // namespace flirt
