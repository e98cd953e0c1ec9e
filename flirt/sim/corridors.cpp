#include "flirt/sim/corridors.hpp"

#include "flirt/core/rng.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace flirt {
namespace {

constexpr int blocks_along = 3;
constexpr int blocks_across = 2;

/// A wall with shut doors, `into` being the direction away from the corridor.
void add_wall(FloorPlan& plan, Point2 begin, Point2 end, Point2 into, Rng& rng) {
  constexpr double door = 1;                                      // m wide
  constexpr double depth = 0.15;                                  // m that it stands back
  constexpr double least = 0.3;                                   // m of wall before a corner
  constexpr std::array<double, 5> pauses{4.2, 4.2, 5, 6.3, 3.1};  // m of wall between doors
  const double length = norm(end - begin);
  const Point2 along = 1 / length * (end - begin);
  Point2 last = begin;
  const auto draw_to = [&](Point2 next) {
    plan.segments.push_back({last, next});
    last = next;
  };
  double at = 0;
  while (true) {
    const auto pick = static_cast<std::size_t>(rng.uniform(0, static_cast<double>(pauses.size())));
    const double jamb = at + pauses[std::min(pick, pauses.size() - 1)];
    if (jamb + door > length - least) { break; }
    const Point2 near = begin + jamb * along;
    const Point2 far = begin + (jamb + door) * along;
    draw_to(near);
    draw_to(near + depth * into);
    draw_to(far + depth * into);
    draw_to(far);
    at = jamb + door;
  }
  draw_to(end);
}

/// The four walls of a rectangle, seen from outside (`side` = 1) or from within (−1).
void add_walls(FloorPlan& plan, const Rectangle& box, double side, Rng& rng) {
  const Point2 low_right{box.high.x, box.low.y};
  const Point2 high_left{box.low.x, box.high.y};
  add_wall(plan, box.low, low_right, {0, side}, rng);
  add_wall(plan, low_right, box.high, {-side, 0}, rng);
  add_wall(plan, box.high, high_left, {0, -side}, rng);
  add_wall(plan, high_left, box.low, {side, 0}, rng);
}

}  // namespace

World make_corridors(const CorridorParams& params) {
  const double along = params.length / blocks_along;
  const double across = params.length / 2 / blocks_across;
  const double half = 0.5 * params.width;
  Rng rng(params.seed);
  World world;
  for (int i = 0; i < blocks_along; ++i) {
    for (int j = 0; j < blocks_across; ++j) {
      const Rectangle block{{i * along + half, j * across + half}, {(i + 1) * along - half, (j + 1) * across - half}};
      add_walls(world.plan, block, 1, rng);
    }
  }
  const Rectangle outside{{-half, -half}, {params.length + half, 0.5 * params.length + half}};
  add_walls(world.plan, outside, -1, rng);
  for (int i = 0; i <= 2 * blocks_along; ++i) {
    for (int j = 0; j <= 2 * blocks_across; ++j) {
      if (i % 2 == 0 || j % 2 == 0) { world.places.push_back({0.5 * i * along, 0.5 * j * across}); }
    }
  }
  return world;
}

}  // namespace flirt
