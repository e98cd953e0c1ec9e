#include "flirt/sim/office.hpp"

#include "flirt/sim/free_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

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

/// Share of the discs of a plan that stand where they stood in another.
double share_in_place(const FloorPlan& plan, const FloorPlan& before) {
  std::set<std::pair<double, double>> places;
  for (const PlanDisc& disc : before.discs) { places.emplace(disc.center.x, disc.center.y); }
  std::size_t kept = 0;
  for (const PlanDisc& disc : plan.discs) { kept += places.count({disc.center.x, disc.center.y}); }
  return static_cast<double>(kept) / static_cast<double>(before.discs.size());
}

TEST(Office, AsMuchOfTheFurnitureMovesAsAskedFor) {
  const World before = make_office({.area = 5000});
  for (const double changed : {0.1, 0.3, 0.6}) {
    const World later = make_office({.area = 5000, .changed = changed});
    EXPECT_NEAR(share_in_place(later.plan, before.plan), 1 - changed, 0.06);
    EXPECT_TRUE(std::ranges::equal(later.places, before.places));
    const Rectangle box = bounds(before.plan);  // what was pushed stays within the walls
    const Rectangle later_box = bounds(later.plan);
    EXPECT_LT(norm(later_box.low - box.low) + norm(later_box.high - box.high), 1e-9);
  }
  EXPECT_EQ(share_in_place(make_office({.area = 5000, .visit = 9}).plan, before.plan), 1);
  EXPECT_LT(share_in_place(make_office({.area = 5000, .changed = 0.3, .visit = 9}).plan,
                           make_office({.area = 5000, .changed = 0.3}).plan),
            0.8);
}

TEST(Office, WithoutFurnitureOnlyDoorsMove) {
  const FloorPlan before = make_office({.area = 900, .furniture = 0}).plan;
  const FloorPlan later = make_office({.area = 900, .furniture = 0, .changed = 1}).plan;
  const auto ends = [](const FloorPlan& plan) {
    std::set<std::tuple<double, double, double, double>> all;
    for (const PlanSegment& segment : plan.segments) {
      all.emplace(segment.begin.x, segment.begin.y, segment.end.x, segment.end.y);
    }
    return all;
  };
  EXPECT_EQ(later.segments.size(), before.segments.size());
  std::vector<std::tuple<double, double, double, double>> moved;
  std::ranges::set_difference(ends(later), ends(before), std::back_inserter(moved));
  EXPECT_GT(moved.size(), 5U);  // leaves of doors, a metre wide at most
  for (const auto& [x0, y0, x1, y1] : moved) { EXPECT_LT(std::hypot(x1 - x0, y1 - y0), 1.1); }
}

}  // namespace
}  // namespace flirt
