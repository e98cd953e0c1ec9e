#include "flirt/sim/office.hpp"

#include "flirt/sim/free_space.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace flirt {
namespace {

TEST(Office, HasTheAreaAskedFor) {
  for (const double area : {500.0, 2000.0, 20000.0, 100000.0}) {
    const Rectangle box = bounds(make_office({.area = area}).plan);
    EXPECT_NEAR(box.width() * box.height(), area, 0.03 * area);
  }
}

TEST(Office, CorridorsAreConnectedAndHalfOfTheRoomsCanBeEntered) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    for (const double area : {500.0, 3000.0}) {
      const World office = make_office({.area = area, .seed = seed});
      const FreeSpace space(office.plan, 0.25);
      int reachable = 0;
      for (const Point2 place : office.places) { reachable += space.nearest(place, 1).empty() ? 0 : 1; }
      EXPECT_GT(reachable, 0.5 * static_cast<double>(office.places.size())) << seed << " " << area;
    }
  }
}

TEST(Office, IsClosedButForGlass) {
  const World office = make_office({.area = 2000, .glass_fronts = 0});
  const Rectangle box = bounds(office.plan);
  const FreeSpace space(office.plan, 0.02);
  for (const Point2 place : space.spread(2, 1)) {
    EXPECT_GT(place.x, box.low.x);
    EXPECT_LT(place.x, box.high.x);
  }
  for (const PlanSegment& segment : office.plan.segments) { EXPECT_EQ(segment.material, Material::solid); }
}

TEST(Office, FurnitureIsAsMuchAsAskedFor) {
  const auto pieces = [](double furniture) {
    const FloorPlan plan = make_office({.area = 2000, .furniture = furniture}).plan;
    return plan.segments.size() + plan.discs.size();
  };
  EXPECT_LT(pieces(0), pieces(0.5));
  EXPECT_LT(pieces(0.5), pieces(1));
}

TEST(Office, ClosedDoorsCloseAllRooms) {
  const World office = make_office({.area = 900, .open_doors = 0, .half_open_doors = 0});
  const World open = make_office({.area = 900, .open_doors = 1, .half_open_doors = 0});
  EXPECT_LT(FreeSpace(office.plan, 0.25).area(), 0.5 * FreeSpace(open.plan, 0.25).area());
}

TEST(Office, EqualSeedsBuildAlikeAndOthersDoNot) {
  const auto corners = [](std::uint64_t seed) {
    std::vector<Point2> points;
    for (const PlanSegment& segment : make_office({.area = 900, .seed = seed}).plan.segments) {
      points.push_back(segment.begin);
    }
    return points;
  };
  EXPECT_EQ(corners(1), corners(1));
  EXPECT_NE(corners(1), corners(2));
}

TEST(Office, RoomsDiffer) {
  const World office = make_office({.area = 5000, .twin_rooms = 0});
  std::set<long> widths;  // of the rooms' fronts, cm
  for (const PlanSegment& segment : office.plan.segments) {
    if (segment.begin.y == segment.end.y) {
      widths.insert(std::lround(100 * std::abs(segment.end.x - segment.begin.x)));
    }
  }
  EXPECT_GT(widths.size(), 100U);
}

}  // namespace
}  // namespace flirt
