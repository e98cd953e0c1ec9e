// tests/arena/point_sets.hpp: small sets of points and motions of them.
#pragma once

#include "flirt/core/pose2.hpp"

#include <numbers>
#include <span>
#include <vector>

namespace flirt {

/// A quarter turn to the left, then (10, 5).
inline const Pose2 quarter_turn{10, 5, std::numbers::pi / 2};

inline std::vector<Point2> moved(std::span<const Point2> points, const Pose2& motion) {
  std::vector<Point2> result;
  for (const Point2 point : points) { result.push_back(motion * point); }
  return result;
}

}  // namespace flirt
