#include "rooms.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace flirt::bench {
namespace {

constexpr double range_max = 20.0;    // m
constexpr double room_side = 6.0;     // m
constexpr std::size_t room_rows = 4;  // and as many columns

/// Numerical Recipes' linear congruential generator, top bits: in [0, 1).
struct Dice {
  std::uint64_t state{1};

  double roll() {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 11U) * 0x1p-53;
  }
};

struct Wall {
  Point2 from;
  Point2 to;
};

void add_box(std::vector<Wall>& walls, double x, double y, double width, double depth) {
  const Point2 a{x, y};
  const Point2 b{x + width, y};
  const Point2 c{x + width, y + depth};
  const Point2 d{x, y + depth};
  walls.insert(walls.end(), {{a, b}, {b, c}, {c, d}, {d, a}});
}

/// Pillars where rooms meet, each with walls that leave a doorway, and two pieces of furniture in each room.
std::vector<Wall> walls_of_floor() {
  std::vector<Wall> walls;
  const double extent = room_side * static_cast<double>(room_rows);
  add_box(walls, 0, 0, extent, extent);
  Dice dice;
  for (std::size_t room = 0; room < room_rows * room_rows; ++room) {
    const double x = room_side * static_cast<double>(room % room_rows);
    const double y = room_side * static_cast<double>(room / room_rows);
    const double door = 1.5 + 2.0 * dice.roll();
    walls.push_back({{x, y}, {x + door, y}});
    walls.push_back({{x + door + 1.2, y}, {x + room_side, y}});
    walls.push_back({{x, y + 4.0 - door / 2}, {x, y + room_side}});
    for (int piece = 0; piece < 2; ++piece) {
      add_box(walls, x + 0.3 + 1.2 * dice.roll() + 3.0 * piece, y + 0.3 + 4.0 * dice.roll(), 0.4 + 0.8 * dice.roll(),
              0.3 + 0.5 * dice.roll());
    }
  }
  return walls;
}

double range_to(const Wall& wall, const Pose2& from, double cosine, double sine) {
  const double dx = wall.to.x - wall.from.x;
  const double dy = wall.to.y - wall.from.y;
  const double across = cosine * dy - sine * dx;
  if (std::abs(across) < 1e-12) { return range_max; }
  const double ox = wall.from.x - from.x;
  const double oy = wall.from.y - from.y;
  const double range = (ox * dy - oy * dx) / across;
  const double along = (ox * sine - oy * cosine) / across;
  return range > 0 && along >= 0 && along <= 1 ? range : range_max;
}

}  // namespace

std::vector<PlacedScan> scans_in_rooms(std::size_t count) {
  const std::vector<Wall> walls = walls_of_floor();
  Dice dice{7};
  std::vector<PlacedScan> scans(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double way = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    Scan& scan = scans[i].scan;
    Pose2& pose = scans[i].map_from_sensor;
    pose = {12.0 + 9.0 * std::cos(way), 12.0 + 9.0 * std::sin(2 * way), std::remainder(3 * way, 2 * std::numbers::pi)};
    scan.beams = {-std::numbers::pi / 2, std::numbers::pi / 359, 0.05, range_max};
    for (std::size_t beam = 0; beam < 360; ++beam) {
      const double angle = pose.theta + scan.beams.angle(beam);
      double range = range_max;
      for (const Wall& wall : walls) {
        range = std::min(range, range_to(wall, pose, std::cos(angle), std::sin(angle)));
      }
      const double noise = 0.02 * (dice.roll() + dice.roll() + dice.roll() - 1.5);
      scan.ranges.push_back(range >= range_max ? range_max : std::max(0.06, range + noise));
    }
  }
  return scans;
}

}  // namespace flirt::bench
