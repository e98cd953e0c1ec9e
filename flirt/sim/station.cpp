#include "flirt/sim/station.hpp"

#include "flirt/core/rng.hpp"

#include <algorithm>
#include <span>
#include <vector>

namespace flirt {
namespace {

constexpr double hall_depth = 40;      // m, west to east
constexpr double hallway_width = 9;    // m
constexpr double platform_low = 30;    // m, y of the platform's southern edge
constexpr double platform_width = 8;   // m
constexpr double passage_width = 6;    // m, at the eastern end
constexpr double place_spacing = 2.5;  // m, between places where people walk

void add_line(FloorPlan& plan, std::span<const Point2> points, Material material = Material::solid) {
  for (std::size_t i = 1; i < points.size(); ++i) { plan.segments.push_back({points[i - 1], points[i], material}); }
}

void add_box(FloorPlan& plan, const Rectangle& box) {
  const std::vector<Point2> around{box.low, {box.high.x, box.low.y}, box.high, {box.low.x, box.high.y}, box.low};
  add_line(plan, around);
}

/// Places for people to walk between, all over a rectangle.
void add_places(std::vector<Point2>& places, const Rectangle& area) {
  for (double y = area.low.y + 0.6; y <= area.high.y - 0.6; y += place_spacing / 2) {
    for (double x = area.low.x + 0.6; x <= area.high.x - 0.6; x += place_spacing) { places.push_back({x, y}); }
  }
}

/// A side of the hallway from `from` to `to`: shop after shop, set back by different depths, `outward` being the
/// direction (±1) in which y leaves the hallway.
void add_shops(FloorPlan& plan, double from, double to, double y, double outward, Rng& rng) {
  std::vector<Point2> front{{from, y}};
  double x = from;
  while (x < to) {
    const double pier = std::min(x + rng.uniform(0.4, 2.5), to);
    const double end = std::min(pier + rng.uniform(3, 9), to);
    const double back = y + outward * rng.uniform(0.3, 4);
    front.insert(front.end(), {{pier, y}, {pier, back}, {end, back}, {end, y}});
    if (rng.uniform() < 0.25) { add_line(plan, std::vector<Point2>{{pier, y}, {end, y}}, Material::glass); }
    if (rng.uniform() < 0.3) {  // a stand before the shop
      const double stand = rng.uniform(pier, end);
      const double near = y - outward * 0.2;
      const double far = y - outward * 1.1;
      add_box(plan, {{stand, std::min(near, far)}, {stand + rng.uniform(0.5, 1.6), std::max(near, far)}});
    }
    x = end;
  }
  add_line(plan, front);
}

/// Columns in a row, benches and machines between some of them.
void add_platform(FloorPlan& plan, double from, double to, Rng& rng) {
  constexpr double column_spacing = 9;
  const double middle = platform_low + 0.65 * platform_width;
  for (double x = from + 5; x < to; x += column_spacing) {
    plan.discs.push_back({{x, middle}, 0.25});
    const double at = x + rng.uniform(1.5, 5.5);
    if (rng.uniform() < 0.6) { add_box(plan, {{at, middle - 0.3}, {at + rng.uniform(0.6, 2), middle + 0.3}}); }
  }
  // The train: cars of 26 m with doors set back, beside the platform's edge.
  std::vector<Point2> train{{from, platform_low + platform_width}};
  const double edge = platform_low + platform_width;
  for (double x = from + 1; x + 26 < to; x += 26.5) {
    for (const double door : {5.0, 19.5}) {
      train.insert(train.end(),
                   {{x + door, edge}, {x + door, edge + 0.4}, {x + door + 1.4, edge + 0.4}, {x + door + 1.4, edge}});
    }
    train.insert(train.end(), {{x + 26, edge}, {x + 26, edge + 1.5}, {x + 26.5, edge + 1.5}, {x + 26.5, edge}});
  }
  train.push_back({to, edge});
  add_line(plan, train);
  // The building's side: a wall with stairs, lifts and doors.
  std::vector<Point2> side{{from, platform_low}};
  for (double x = from + rng.uniform(4, 15); x + 6 < to; x += rng.uniform(9, 28)) {
    const double end = x + rng.uniform(1.2, 4);
    const double back = platform_low - rng.uniform(0.2, 2.5);
    side.insert(side.end(), {{x, platform_low}, {x, back}, {end, back}, {end, platform_low}});
    x = end;
  }
  side.push_back({to, platform_low});
  add_line(plan, side);
}

void add_hall(FloorPlan& plan, Rng& rng) {
  const double top = platform_low + platform_width;
  add_line(plan,
           std::vector<Point2>{{0, 0}, {0, -6}, {-12, -6}, {-12, -9}, {-hall_depth, -9}, {-hall_depth, top}, {0, top}});
  add_line(plan, std::vector<Point2>{{0, hallway_width}, {0, platform_low}});
  for (double x = -34; x < -4; x += 10) {
    for (double y = 2; y < top - 4; y += 11) { plan.discs.push_back({{x, y}, 0.45}); }
  }
  for (int i = 0; i < 6; ++i) {  // kiosks and ticket machines
    const Point2 low{-36 + 5.5 * i, rng.uniform(12, 24)};
    add_box(plan, {low, low + Point2{rng.uniform(0.7, 2.5), rng.uniform(0.7, 3)}});
  }
}

}  // namespace

World make_tunnel(const TunnelParams& params) {
  const double w = params.width;
  const double end = params.length;
  World world;
  FloorPlan& plan = world.plan;
  // Where the way begins: a landing with stairs to one side. Where it ends: a hall behind a convex corner.
  add_line(plan, std::vector<Point2>{{end, 0}, {end, -4}, {end + 8, -4}, {end + 8, w}, {end, w}});
  add_line(plan, std::vector<Point2>{{0, w}, {end, w}});
  add_line(plan, std::vector<Point2>{{0, 0}, {end, 0}});
  add_line(plan, std::vector<Point2>{{0, w}, {-3, w}, {-3, w + 3}, {-12, w + 3}, {-12, -5}, {0, -5}, {0, 0}});
  plan.discs.push_back({{end + 4, 0.2 * w}, 0.3});
  plan.discs.push_back({{-5, 0.5 * w - 3.2}, 0.35});
  const Point2 bin{-7.5, w + 1.2};
  add_line(plan, std::vector<Point2>{bin, bin + Point2{0.7, 0}, bin + Point2{0.35, 0.6}, bin});
  add_places(world.places, {{-11, 0}, {end + 7, w}});
  world.tour = {{end + 6, 0.5 * w}, {0.5 * end, 0.5 * w}, {-8.5, 0.4 * w}};
  return world;
}

World make_station(const StationParams& params) {
  const double length = params.length;
  const double east = length + passage_width;
  const double top = platform_low + platform_width;
  Rng rng(params.seed);
  World world;
  FloorPlan& plan = world.plan;
  add_hall(plan, rng);
  add_shops(plan, 0, length, 0, -1, rng);
  add_shops(plan, 0, length, hallway_width, 1, rng);
  add_platform(plan, 0, length, rng);
  add_line(plan, std::vector<Point2>{{length, hallway_width}, {length, platform_low}});
  add_line(plan, std::vector<Point2>{{length, 0},
                                     {east, 0},
                                     {east, 12},
                                     {east + 1.2, 12},
                                     {east + 1.2, 15},
                                     {east, 15},
                                     {east, top},
                                     {length, top}});
  plan.discs.push_back({{length + 1.2, 19}, 0.3});
  add_places(world.places, {{-hall_depth, -9}, {0, top}});
  add_places(world.places, {{0, 0}, {east, hallway_width}});
  add_places(world.places, {{0, platform_low}, {east, top}});
  add_places(world.places, {{length, hallway_width}, {east, platform_low}});
  const double hallway = 0.5 * hallway_width;
  const double platform = platform_low + 0.3 * platform_width;
  world.tour = {{-20, 6},
                {-8, platform},
                {0.5 * length, platform},
                {length + 3, platform},
                {length + 3, hallway},
                {0.5 * length, hallway},
                {-8, hallway},
                {-20, 6}};
  return world;
}

}  // namespace flirt
