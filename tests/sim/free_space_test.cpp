#include "flirt/sim/free_space.hpp"

#include "flirt/core/rng.hpp"
#include "flirt/sim/office.hpp"

#include "tests/sim/closed_room.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace flirt {
namespace {

TEST(FreeSpace, ClearanceIsALowerBoundWithinThreeCells) {
  const FloorPlan plan = make_office({.area = 800}).plan;
  const FreeSpace space(plan, 0.25);
  const Rectangle box = bounds(plan);
  Rng rng(1);
  for (int i = 0; i < 3000; ++i) {
    const Point2 point{rng.uniform(box.low.x, box.high.x), rng.uniform(box.low.y, box.high.y)};
    const double truth = distance_to_surface(plan, point);
    EXPECT_LE(space.clearance(point), truth + 1e-6);
    EXPECT_GE(space.clearance(point), truth - 3 * space.cell_size());
  }
}

TEST(FreeSpace, IsTheRoomWithoutAMarginAsWideAsTheDisc) {
  const FreeSpace space(closed_room(8, 6), 0.5);
  EXPECT_NEAR(space.area(), 7 * 5, 35 * 0.05);
  EXPECT_TRUE(space.contains({4, 3}));
  EXPECT_FALSE(space.contains({0.45, 3}));
  EXPECT_FALSE(space.contains({-1, 3}));
  EXPECT_TRUE(FreeSpace(FloorPlan{}, 0.5).spread(1, 1).empty());
}

TEST(FreeSpace, KeepsTheInsideOfABuildingNotItsSurroundings) {
  FloorPlan plan = closed_room(8, 6);
  plan.segments.push_back({{-30, -30}, {-29, -30}});  // a yard, larger than the room
  const FreeSpace space(plan, 0.3);
  EXPECT_TRUE(space.contains({4, 3}));
  EXPECT_FALSE(space.contains({-10, -10}));
}

TEST(FreeSpace, UnknownPixelsAreNotFree) {
  PixelPlan image{{}, 0.1, 60, 40, std::vector<CellState>(2400, CellState::unknown)};
  for (std::size_t row = 5; row < 35; ++row) {
    for (std::size_t column = 5; column < 30; ++column) { image.pixels[row * 60 + column] = CellState::free; }
  }
  const FreeSpace space({{}, {}, image}, 0.2);
  EXPECT_TRUE(space.contains({1.5, 2}));
  EXPECT_FALSE(space.contains({4.5, 2}));
}

TEST(FreeSpace, SpreadPointsKeepTheirDistanceAndLeaveNoGap) {
  const FreeSpace space(closed_room(8, 6), 0.3);
  const std::vector<Point2> points = space.spread(1.5, 4);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_TRUE(space.contains(points[i]));
    for (std::size_t j = 0; j < i; ++j) { EXPECT_GE(norm(points[i] - points[j]), 1.5); }
  }
  Rng rng(2);
  for (int i = 0; i < 500; ++i) {
    const Point2 any{rng.uniform(0.5, 7.5), rng.uniform(0.5, 5.5)};
    double nearest = std::numeric_limits<double>::infinity();
    for (const Point2 point : points) { nearest = std::min(nearest, norm(point - any)); }
    EXPECT_LE(nearest, 1.5 + space.cell_size());
  }
}

TEST(FreeSpace, NearestPointIsInTheSpace) {
  const FreeSpace space(closed_room(8, 6), 0.5);
  EXPECT_EQ(space.nearest({4, 3}, 1), (std::vector<Point2>{{4, 3}}));
  const std::vector<Point2> snapped = space.nearest({0.2, 3}, 1);
  ASSERT_EQ(snapped.size(), 1U);
  EXPECT_TRUE(space.contains(snapped[0]));
  EXPECT_NEAR(norm(snapped[0] - Point2{0.2, 3}), 0.35, 0.1);
  EXPECT_TRUE(space.nearest({-5, 3}, 1).empty());
}

}  // namespace
}  // namespace flirt
