// tests/registration/rooms.hpp: exact scans of walls given as line segments, and the evidence they make.
#pragma once

#include "flirt/core/rng.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/grid/evidence_grid.hpp"

#include <limits>
#include <numbers>
#include <vector>

namespace flirt::rooms {

struct Wall {
  Point2 a;
  Point2 b;
};

/// Corners joined in order, closed.
inline std::vector<Wall> outline(const std::vector<Point2>& corners) {
  std::vector<Wall> walls;
  for (std::size_t i = 0; i < corners.size(); ++i) { walls.push_back({corners[i], corners[(i + 1) % corners.size()]}); }
  return walls;
}

inline std::vector<Wall> moved(std::vector<Wall> walls, const Pose2& map_from_room) {
  for (Wall& wall : walls) { wall = {map_from_room * wall.a, map_from_room * wall.b}; }
  return walls;
}

/// A room 8 m × 5 m with a niche and a free-standing box: no symmetry.
inline std::vector<Wall> asymmetric_room() {
  std::vector<Wall> walls = outline({{0, 0}, {8, 0}, {8, 5}, {5.5, 5}, {5.5, 6.5}, {4, 6.5}, {4, 5}, {0, 5}});
  for (const Wall& wall : outline({{1.5, 1.2}, {2.7, 1.2}, {2.7, 1.9}, {1.5, 1.9}})) { walls.push_back(wall); }
  return walls;
}

inline double range_to(const std::vector<Wall>& walls, Point2 from, double angle) {
  const Point2 direction{std::cos(angle), std::sin(angle)};
  double nearest = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls) {
    const Point2 along = wall.b - wall.a;
    const double determinant = cross(direction, along);
    if (determinant == 0) { continue; }
    const double range = cross(wall.a - from, along) / determinant;
    const double on_wall = cross(wall.a - from, direction) / determinant;
    if (range > 0 && on_wall >= 0 && on_wall <= 1) { nearest = std::min(nearest, range); }
  }
  return nearest;
}

/// `field_of_view` rad about the heading; noise of standard deviation `sigma` on each range when `rng` is given.
inline Scan scan_of(const std::vector<Wall>& walls, const Pose2& pose, double field_of_view, Rng* rng = nullptr,
                    double sigma = 0.02) {
  const double step = radians_from_degrees(1);
  Scan scan{.beams = {-field_of_view / 2, step, 0.05, 50}};
  const auto beams = static_cast<std::size_t>(std::lround(field_of_view / step));
  for (std::size_t i = 0; i < beams; ++i) {
    const double range = range_to(walls, pose.translation(), pose.theta + scan.beams.angle(i));
    scan.ranges.push_back(rng != nullptr ? range + rng->normal(0, sigma) : range);
  }
  return scan;
}

inline EvidenceGrid evidence_of(const std::vector<Wall>& walls, const std::vector<Pose2>& poses) {
  Rng rng(5);
  EvidenceGrid grid;
  for (const Pose2& pose : poses) { grid.add(scan_of(walls, pose, 2 * std::numbers::pi, &rng, 0.01), pose); }
  return grid;
}

inline std::vector<Pose2> walk(const Pose2& map_from_room) {
  std::vector<Pose2> poses;
  for (int i = 0; i < 12; ++i) {
    poses.push_back(map_from_room * Pose2{1 + 0.5 * i, 2.6 + 0.3 * (i % 3), 0.7 * i});
    poses.push_back(map_from_room * Pose2{1 + 0.5 * i, 0.6, 0.3 * i});
  }
  return poses;
}

}  // namespace flirt::rooms
