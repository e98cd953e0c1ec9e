#include "flirt/sim/warehouse.hpp"

#include "flirt/sim/free_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

namespace flirt {
namespace {

constexpr std::size_t box_sides = 4;
using Corners = std::array<double, 4>;

Corners corners_of(const PlanSegment& segment) {
  return {segment.begin.x, segment.begin.y, segment.end.x, segment.end.y};
}

bool equal(std::span<const PlanSegment> a, std::span<const PlanSegment> b) {
  return std::ranges::equal(a, b, {}, corners_of, corners_of);
}

bool equal(const World& a, const World& b) {
  return equal(a.plan.segments, b.plan.segments);
}

std::size_t goods_sides(const WarehouseParams& params) {
  return box_sides * static_cast<std::size_t>(params.length / 5);
}

/// Walls, office and posts: what stands before the first pallet.
std::vector<PlanSegment> building_of(WarehouseParams params) {
  params.filled = 0;
  std::vector<PlanSegment> segments = make_warehouse(params).plan.segments;
  segments.resize(segments.size() - goods_sides(params));
  return segments;
}

/// The sides of pallets and of goods on the floor.
struct Movables {
  std::span<const PlanSegment> pallets;
  std::span<const PlanSegment> goods;
};

Movables movables_of(const World& world, const WarehouseParams& params) {
  const std::span<const PlanSegment> segments = world.plan.segments;
  const std::size_t goods = goods_sides(params);
  const std::size_t building = building_of(params).size();
  return {segments.subspan(building, segments.size() - building - goods), segments.last(goods)};
}

/// Share of the segments that are not among the others.
double share_gone(std::span<const PlanSegment> segments, std::span<const PlanSegment> others) {
  std::set<Corners> kept;
  for (const PlanSegment& other : others) { kept.insert(corners_of(other)); }
  const auto gone =
      std::ranges::count_if(segments, [&](const PlanSegment& segment) { return !kept.contains(corners_of(segment)); });
  return static_cast<double>(gone) / static_cast<double>(segments.size());
}

TEST(Warehouse, IsAsLargeAsAskedFor) {
  for (const auto& [length, width] : {std::array{60.0, 40.0}, std::array{20.0, 15.0}, std::array{100.0, 25.0}}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Rectangle box = bounds(make_warehouse({.length = length, .width = width, .seed = seed}).plan);
      EXPECT_EQ(box.low, (Point2{0, -0.25}));  // the dock doors stand back
      EXPECT_EQ(box.high, (Point2{length, width}));
    }
  }
}

TEST(Warehouse, RobotReachesAllPlacesAndDoesNotGetOut) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const World world = make_warehouse({.length = 40, .width = 30, .seed = seed});
    const FreeSpace space(world.plan, 0.4);
    for (const Point2& place : world.places) { EXPECT_TRUE(space.contains(place)); }
    EXPECT_LT(space.area(), 40 * 30);
    EXPECT_FALSE(space.contains({-1, 15}));
  }
}

TEST(Warehouse, RobotThatDoesNotFitIntoBaysReachesTheAisles) {
  const World world = make_warehouse({.seed = 3});
  const FreeSpace space(world.plan, 1.2);
  for (const Point2& place : world.places) {
    if (place.y > 5) { EXPECT_TRUE(space.contains(place)) << place.x << ", " << place.y; }
  }
}

TEST(Warehouse, PlacesAreFree) {
  constexpr double clear = 0.6;
  std::vector<WarehouseParams> buildings;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const double changed : {0.0, 0.3, 1.0}) {
      buildings.push_back({.changed = changed, .seed = seed, .visit = seed + 1});
      buildings.push_back({.length = 20, .width = 15, .aisle = 2, .filled = 1, .changed = changed, .seed = seed});
      buildings.push_back({.length = 33, .width = 18.1, .aisle = 2, .filled = 1, .changed = changed, .seed = seed});
      buildings.push_back({.length = 47, .width = 31.7, .aisle = 8, .filled = 1, .changed = changed, .seed = seed});
    }
  }
  for (const WarehouseParams& params : buildings) {
    const World world = make_warehouse(params);
    EXPECT_GT(world.places.size(), 4U);
    for (const Point2& place : world.places) {
      EXPECT_GE(distance_to_surface(world.plan, place), clear)
          << place.x << ", " << place.y << " of " << params.length << " x " << params.width << ", seed " << params.seed;
      EXPECT_TRUE(place.x > 0 && place.x < params.length && place.y > 0 && place.y < params.width);
    }
  }
}

TEST(Warehouse, PlacesLieInAllAislesAndAtTheDocks) {
  const std::vector<Point2> places = make_warehouse({}).places;
  for (const double lane : {4.145, 8.9, 14.3, 19.7, 25.1, 30.5}) {
    EXPECT_EQ(std::ranges::count_if(places, [&](Point2 place) { return std::abs(place.y - lane) < 1e-9; }), 11);
  }
  for (const double end : {2.975, 30.0, 57.025}) {
    EXPECT_GE(std::ranges::count_if(places, [&](Point2 place) { return std::abs(place.x - end) < 0.05; }), 6);
  }
}

TEST(Warehouse, AnotherSeedIsAnotherBuilding) {
  EXPECT_TRUE(equal(make_warehouse({.seed = 1}), make_warehouse({.seed = 1})));
  EXPECT_GT(share_gone(building_of({.seed = 1}), building_of({.seed = 2})), 0.05);  // pillars, doors, the office
  const World one = make_warehouse({.seed = 1});
  const World other = make_warehouse({.seed = 2});
  EXPECT_EQ(share_gone(movables_of(one, {.seed = 1}).pallets, movables_of(other, {.seed = 2}).pallets), 1);
}

TEST(Warehouse, WallsAreOthersAfterHalfATurn) {
  constexpr Point2 far{60, 39.4};  // the posts are the same
  const auto rounded = [](double value) { return std::round(10 * value); };
  const auto walls_of = [&](std::uint64_t seed, bool turned) {
    std::vector<PlanSegment> walls;
    for (const auto& [begin, end, material] : building_of({.length = far.x, .width = far.y, .seed = seed})) {
      const double to_wall = std::min({begin.x, begin.y, far.x - begin.x, far.y - begin.y});
      if (to_wall > 0.35) { continue; }
      const Point2 a = turned ? far - begin : begin;
      const Point2 b = turned ? far - end : end;
      walls.push_back({{rounded(a.x), rounded(a.y)}, {rounded(b.x), rounded(b.y)}});
    }
    return walls;
  };
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    EXPECT_EQ(share_gone(walls_of(seed, false), walls_of(seed, false)), 0);
    EXPECT_GT(share_gone(walls_of(seed, false), walls_of(seed, true)), 0.4);
  }
}

TEST(Warehouse, SharesOfPlacesAreTakenAsAskedFor) {
  const auto sides = [](double filled) {
    const World world = make_warehouse({.filled = filled});
    return static_cast<double>(movables_of(world, {}).pallets.size());
  };
  EXPECT_EQ(sides(0), 0);
  EXPECT_NEAR(sides(0.55) / sides(1), 0.55, 0.06);
}

TEST(Warehouse, WithoutChangesTheVisitDoesNotMatter) {
  EXPECT_TRUE(equal(make_warehouse({.visit = 1}), make_warehouse({.visit = 2})));
}

TEST(Warehouse, ChangesMovePalletsAndGoodsOnly) {
  const WarehouseParams before{.length = 100, .width = 60};
  WarehouseParams after = before;
  after.changed = 0.3;
  const World first = make_warehouse(before);
  const World later = make_warehouse(after);
  const std::vector<PlanSegment> building = building_of(before);
  EXPECT_TRUE(equal(building, std::span(first.plan.segments).first(building.size())));
  EXPECT_TRUE(equal(building, std::span(later.plan.segments).first(building.size())));
  const Movables old = movables_of(first, before);
  const Movables now = movables_of(later, after);
  EXPECT_NEAR(share_gone(old.pallets, now.pallets), 0.3, 0.04);
  EXPECT_NEAR(share_gone(now.pallets, old.pallets), 0.3, 0.04);
  const double goods = share_gone(old.goods, now.goods);
  EXPECT_GE(goods, 0.05);
  EXPECT_LE(goods, 0.6);
  EXPECT_TRUE(std::ranges::equal(first.places, later.places));
}

TEST(Warehouse, AnotherVisitFindsOtherChanges) {
  const WarehouseParams before{.length = 100, .width = 60};
  WarehouseParams one = before;
  one.changed = 0.3;
  WarehouseParams other = one;
  other.visit = 2;
  const World first = make_warehouse(one);
  const World later = make_warehouse(other);
  EXPECT_TRUE(equal(first, make_warehouse(one)));
  EXPECT_NEAR(share_gone(movables_of(first, one).pallets, movables_of(later, other).pallets), 0.51, 0.05);  // 1 − .7²
  one.changed = 1;
  other.changed = 1;
  const World all = make_warehouse(one);
  const World all_later = make_warehouse(other);
  EXPECT_EQ(share_gone(movables_of(all, one).pallets, movables_of(all_later, other).pallets), 1);
  EXPECT_EQ(share_gone(movables_of(all, one).goods, movables_of(all_later, other).goods), 1);
}

}  // namespace
}  // namespace flirt
