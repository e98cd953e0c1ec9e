// tests/support/scenes.hpp: small exact worlds of walls, and what a scanner sees in them.
#pragma once

#include "flirt/core/scan.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

namespace flirt {

/// A straight wall, seen from both sides; m, map frame.
struct Wall {
  Point2 begin{};
  Point2 end{};
};
using Scene = std::vector<Wall>;

/// The walls along a closed polygon.
[[nodiscard]] inline Scene polygon(std::span<const Point2> corners) {
  Scene scene;
  for (std::size_t i = 0; i < corners.size(); ++i) { scene.push_back({corners[i], corners[(i + 1) % corners.size()]}); }
  return scene;
}

/// The walls of a rectangle with its centre at `map_from_box`.
[[nodiscard]] inline Scene box(const Pose2& map_from_box, double length, double width) {
  std::vector<Point2> corners{
      {-length / 2, -width / 2}, {length / 2, -width / 2}, {length / 2, width / 2}, {-length / 2, width / 2}};
  for (Point2& corner : corners) { corner = map_from_box * corner; }
  return polygon(corners);
}

/// All walls of `scene` moved by `map_from_scene`.
[[nodiscard]] inline Scene moved(Scene scene, const Pose2& map_from_scene) {
  for (Wall& wall : scene) { wall = {map_from_scene * wall.begin, map_from_scene * wall.end}; }
  return scene;
}

[[nodiscard]] inline Scene joined(Scene scene, const Scene& more) {
  scene.insert(scene.end(), more.begin(), more.end());
  return scene;
}

/// Distance along a ray to the nearest wall, m; infinite when there is none. Every wall is tried.
[[nodiscard]] inline double cast_ray(const Scene& scene, Point2 origin, double angle) {
  const Point2 direction{std::cos(angle), std::sin(angle)};
  double nearest = std::numeric_limits<double>::infinity();
  for (const Wall& wall : scene) {
    const Point2 along = wall.end - wall.begin;
    const double across = cross(direction, along);
    if (std::abs(across) < 1e-12) { continue; }
    const double range = cross(wall.begin - origin, along) / across;
    const double share = cross(wall.begin - origin, direction) / across;
    if (range > 0 && share >= 0 && share <= 1 && range < nearest) { nearest = range; }
  }
  return nearest;
}

/// What a scanner with `count` beams sees from a pose, without noise. Beams that leave the scene have no return.
[[nodiscard]] inline Scan scan_of(const Scene& scene, const Pose2& map_from_sensor, const Beams& beams,
                                  std::size_t count) {
  Scan scan{.beams = beams};
  for (std::size_t i = 0; i < count; ++i) {
    scan.ranges.push_back(cast_ray(scene, map_from_sensor.translation(), map_from_sensor.theta + beams.angle(i)));
  }
  return scan;
}

/// A full turn in half degrees, up to 30 m.
inline constexpr std::size_t turn_beam_count = 720;
[[nodiscard]] inline Beams turn_beams() {
  return {.angle_min = -std::numbers::pi,
          .angle_step = 2 * std::numbers::pi / turn_beam_count,
          .range_min = 0.05,
          .range_max = 30};
}

/// A room of 10 m × 8 m around the origin with niches, boxes and no symmetry.
[[nodiscard]] inline Scene furnished_room() {
  const std::vector<Point2> outline{{-5, -4},   {1, -4},  {1, -3.2}, {2.5, -3.2}, {2.5, -4},   {5, -4},  {5, 0.5},
                                    {4.2, 0.5}, {4.2, 2}, {5, 2},    {5, 4},      {-1, 4},     {-1, 3},  {-2.2, 3},
                                    {-2.2, 4},  {-5, 4},  {-5, 1.4}, {-4.4, 1.4}, {-4.4, 0.2}, {-5, 0.2}};
  Scene scene = polygon(outline);
  scene = joined(std::move(scene), box({2.2, 1.8, 0.3}, 1.2, 0.6));
  scene = joined(std::move(scene), box({-2.6, -1.7, -0.5}, 0.7, 0.7));
  scene = joined(std::move(scene), box({3.4, -1.4, 1.1}, 0.5, 0.9));
  scene = joined(std::move(scene), box({-3.3, 2.4, 0.8}, 0.4, 0.8));
  return scene;
}

/// Poses on a circle around the origin, all turned differently.
[[nodiscard]] inline std::vector<Pose2> poses_around(double radius, std::size_t count) {
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    poses.push_back({radius * std::cos(angle), radius * std::sin(angle), wrap_angle(2.4 * static_cast<double>(i))});
  }
  return poses;
}

/// A log of exact scans from these poses, which it states.
[[nodiscard]] inline ScanLog log_of(const Scene& scene, std::span<const Pose2> map_from_sensor) {
  ScanLog log;
  for (const Pose2& pose : map_from_sensor) {
    log.scans.push_back(scan_of(scene, pose, turn_beams(), turn_beam_count));
    log.map_from_robot.push_back(pose);
  }
  return log;
}

}  // namespace flirt
