#include "flirt/sim/people.hpp"

#include "flirt/sim/office.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace flirt {
namespace {

class People : public testing::Test {
 protected:
  World office_ = make_office({.area = 900});
  FreeSpace space_{office_.plan, 0.25};
};

TEST_F(People, WalkAtWalkingSpeedAndSometimesStand) {
  const Crowd crowd(space_, office_.places, {.count = 12, .walking_speed = 1.2}, 1);
  ASSERT_EQ(crowd.size(), 12U);
  double walked = 0;
  int standing = 0;
  for (double stamp = 0; stamp < 60; stamp += 0.1) {
    const std::vector<Point2> before = crowd.positions(stamp);
    const std::vector<Point2> after = crowd.positions(stamp + 0.1);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double step = norm(after[i] - before[i]);
      EXPECT_LE(step, 1.2 * 1.25 * 0.1 + 1e-9);
      walked += step;
      standing += step == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(walked, 12 * 60 * 0.5);
  EXPECT_GT(standing, 0);
}

TEST_F(People, StayClearOfWalls) {
  const Crowd crowd(space_, office_.places, {.count = 8}, 2);
  for (double stamp = 0; stamp < 100; stamp += 0.5) {
    for (const Point2 position : crowd.positions(stamp)) {
      EXPECT_GE(distance_to_surface(office_.plan, position), 0.25 - 1e-9);
    }
  }
}

TEST_F(People, HaveTwoLegsAStepApartAtMost) {
  const Crowd crowd(space_, office_.places, {.count = 5, .leg_radius = 0.07}, 3);
  const std::vector<Point2> positions = crowd.positions(12.3);
  const std::vector<PlanDisc> legs = crowd.legs(12.3, {1000, 1000});
  ASSERT_EQ(legs.size(), 10U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(legs[2 * i].radius, 0.07);
    EXPECT_NEAR(norm(0.5 * (legs[2 * i].center + legs[2 * i + 1].center) - positions[i]), 0, 1e-9);
    const double apart = norm(legs[2 * i].center - legs[2 * i + 1].center);
    EXPECT_GE(apart, 0.2 - 1e-9);
    EXPECT_LE(apart, 0.55);
  }
}

TEST_F(People, StepAsideForTheRobot) {
  const Crowd crowd(space_, office_.places, {.count = 5}, 4);
  for (double stamp = 0; stamp < 30; stamp += 0.7) {
    const Point2 robot = crowd.positions(stamp)[2];
    for (const PlanDisc& leg : crowd.legs(stamp, robot)) { EXPECT_GE(norm(leg.center - robot), 0.6 - 0.36); }
  }
}

TEST_F(People, AreTheSameForEqualSeedsOnly) {
  const PeopleParams params{.count = 4};
  EXPECT_EQ(Crowd(space_, office_.places, params, 5).positions(7),
            Crowd(space_, office_.places, params, 5).positions(7));
  EXPECT_NE(Crowd(space_, office_.places, params, 5).positions(7),
            Crowd(space_, office_.places, params, 6).positions(7));
}

TEST_F(People, NobodyComesWhereThereIsNoPlaceToWalk) {
  EXPECT_EQ(Crowd(space_, {}, {.count = 3}, 1).size(), 0U);
  EXPECT_TRUE(Crowd(space_, {}, {.count = 3}, 1).legs(0, {0, 0}).empty());
}

}  // namespace
}  // namespace flirt
