#include "flirt/sim/floor_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace flirt {
namespace {

TEST(FloorPlan, BoundsHoldEverySegmentDiscAndImage) {
  FloorPlan plan{{{{1, 2}, {3, -4}}}, {{{5, 5}, 0.5}}, {{-2, 0, std::acos(0.0)}, 0.5, 4, 2, {}}};
  plan.image.pixels.assign(8, CellState::free);
  const Rectangle box = bounds(plan);
  EXPECT_NEAR(box.low.x, -3, 1e-12);  // the image stands on its side: 1 m wide to the left
  EXPECT_NEAR(box.low.y, -4, 1e-12);
  EXPECT_NEAR(box.high.x, 5.5, 1e-12);
  EXPECT_NEAR(box.high.y, 5.5, 1e-12);
}

TEST(FloorPlan, DistanceIsToTheNearestSurface) {
  const FloorPlan plan{{{{0, 0}, {4, 0}}}, {{{2, 5}, 1}}, {}};
  EXPECT_NEAR(distance_to_surface(plan, {2, 1}), 1, 1e-12);
  EXPECT_NEAR(distance_to_surface(plan, {7, 4}), 4.0990195135927845, 1e-9);  // sqrt(26) - 1 to the disc
  EXPECT_NEAR(distance_to_surface(plan, {-3, -4}), 5, 1e-12);
  EXPECT_EQ(distance_to_surface(plan, {2.5, 5}), 0);
  EXPECT_EQ(distance_to_surface(FloorPlan{}, {0, 0}), std::numeric_limits<double>::infinity());
}

TEST(FloorPlan, ImageRowsRunUpwards) {
  const GreyImage image{2, 2, {0, 255, 255, 205}};  // occupied top left, unknown bottom right
  const FloorPlan plan = plan_from_image(image, {.resolution = 0.5, .origin = {10, 20, 0}});
  ASSERT_EQ(plan.image.pixels.size(), 4U);
  EXPECT_EQ(plan.image.pixels[0], CellState::free);
  EXPECT_EQ(plan.image.pixels[1], CellState::unknown);
  EXPECT_EQ(plan.image.pixels[2], CellState::occupied);
  EXPECT_EQ(plan.image.pixels[3], CellState::free);
  EXPECT_NEAR(distance_to_surface(plan, {10.25, 20.25}), 0.25, 1e-12);
}

}  // namespace
}  // namespace flirt
