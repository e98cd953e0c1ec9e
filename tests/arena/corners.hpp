// tests/arena/corners.hpp: the exact scans that the rival methods are specified by.
#pragma once

#include "flirt/core/scan.hpp"

#include "tests/support/scenes.hpp"

#include <cmath>

namespace flirt {

/// `count` beams from `first` in steps of half a degree (degrees, sensor frame), up to 30 m.
inline Beams half_degree_beams(double first) {
  return {.angle_min = radians_from_degrees(first), .angle_step = radians_from_degrees(0.5), .range_max = 31};
}

/// Two walls that meet at `apex` with an interior half angle (degrees) about the line towards the sensor.
inline Scene corner(Point2 apex, double half_angle) {
  const double towards = std::atan2(-apex.y, -apex.x);
  const auto end = [&](double side) {
    const double direction = towards + side * radians_from_degrees(half_angle);
    return apex + 100 * Point2{std::cos(direction), std::sin(direction)};
  };
  return {{apex, end(1)}, {apex, end(-1)}};
}

/// The corner with its apex at (3, 0), seen with 361 beams from −90°.
inline Scan corner_scan(double half_angle, double first = -90, std::size_t count = 361) {
  return scan_of(corner({3, 0}, half_angle), {}, half_degree_beams(first), count);
}

inline Scan wall_scan() {
  return scan_of({{{2, -100}, {2, 100}}}, {}, half_degree_beams(-90), 361);
}

}  // namespace flirt
