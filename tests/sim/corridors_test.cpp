#include "flirt/sim/corridors.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace flirt {
namespace {

TEST(Corridors, AreAsLongAsAskedFor) {
  const Rectangle box = bounds(make_corridors({.length = 90, .width = 2}).plan);
  EXPECT_NEAR(box.width(), 92.3, 1e-9);  // the doors of the outer walls stand back
  EXPECT_NEAR(box.height(), 47.3, 1e-9);
}

TEST(Corridors, PlacesLieInTheMiddleBetweenTheWalls) {
  const World world = make_corridors({.length = 90, .width = 2});
  EXPECT_EQ(world.places.size(), 7U * 5U - 6U);
  for (const Point2& place : world.places) {
    const double clearance = distance_to_surface(world.plan, place);
    EXPECT_GT(clearance, 0.99);
    EXPECT_LT(clearance, 1.5);
  }
}

TEST(Corridors, AnotherSeedHasOtherDoors) {
  const World one = make_corridors({.length = 90, .seed = 1});
  const World same = make_corridors({.length = 90, .seed = 1});
  const World other = make_corridors({.length = 90, .seed = 2});
  EXPECT_TRUE(std::ranges::equal(one.plan.segments, same.plan.segments, {}, &PlanSegment::end, &PlanSegment::end));
  EXPECT_FALSE(std::ranges::equal(one.plan.segments, other.plan.segments, {}, &PlanSegment::end, &PlanSegment::end));
}

}  // namespace
}  // namespace flirt
