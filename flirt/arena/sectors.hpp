// flirt/arena/sectors.hpp: directions as numbered sectors of a full turn.
#pragma once

#include "flirt/core/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace flirt {

/// The sector of an angle (rad) among `sectors`, the first one beginning at 0.
[[nodiscard]] inline std::uint32_t sector_of(double angle, std::uint32_t sectors) {
  constexpr double turn = 2 * std::numbers::pi;
  const double wrapped = angle - turn * std::floor(angle / turn);
  return static_cast<std::uint32_t>(wrapped * sectors / turn) % sectors;
}

/// From sector to sector, the shorter way round.
[[nodiscard]] inline std::uint32_t sector_distance(std::uint32_t a, std::uint32_t b, std::uint32_t sectors) {
  const std::uint32_t apart = a < b ? b - a : a - b;
  return std::min(apart, sectors - apart);
}

[[nodiscard]] inline double direction_of(Point2 from_origin) {
  return std::atan2(from_origin.y, from_origin.x);
}

}  // namespace flirt
