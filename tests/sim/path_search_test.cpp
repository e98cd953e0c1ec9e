#include "flirt/sim/path_search.hpp"

#include "tests/sim/closed_room.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace flirt {
namespace {

TEST(PathSearch, GoesAroundAWall) {
  FloorPlan plan = closed_room(8, 6);
  plan.segments.push_back({{4, 0}, {4, 4.5}});
  const FreeSpace space(plan, 0.3);
  PathSearch search(space);
  const std::vector<Point2> way = search.path({2, 1}, {6, 1});
  ASSERT_FALSE(way.empty());
  EXPECT_LE(norm(way.front() - Point2{2, 1}), space.cell_size());
  EXPECT_LE(norm(way.back() - Point2{6, 1}), space.cell_size());
  double length = 0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    EXPECT_GE(distance_to_surface(plan, 0.5 * (way[i] + way[i - 1])), 0.3);
    length += norm(way[i] - way[i - 1]);
  }
  EXPECT_GE(length, 2 * std::hypot(2, 3.8));
  EXPECT_LE(length, 1.3 * 2 * std::hypot(2, 3.8));
}

TEST(PathSearch, FindsTheNearestGoalByWayNotByAir) {
  FloorPlan plan = closed_room(8, 6);
  plan.segments.push_back({{4, 0}, {4, 4.5}});
  const FreeSpace space(plan, 0.3);
  PathSearch search(space);
  const std::vector<Point2> goals{{4.6, 1}, {1, 4}};  // the first is near, but behind the wall
  const PathSearch::Found found = search.path_to_nearest({3.4, 1}, goals);
  EXPECT_EQ(found.goal, 1U);
  EXPECT_FALSE(found.path.empty());
  EXPECT_TRUE(search.path_to_nearest({3.4, 1}, {}).path.empty());
}

TEST(PathSearch, HasNoWayIntoAClosedRoom) {
  FloorPlan plan = closed_room(8, 6);
  plan.segments.push_back({{5, 0}, {5, 6}});
  const FreeSpace space(plan, 0.3);
  PathSearch search(space);
  EXPECT_TRUE(search.path({2, 3}, {6.5, 3}).empty());
}

}  // namespace
}  // namespace flirt
