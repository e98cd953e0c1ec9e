#include "flirt/sim/odometry.hpp"

#include "flirt/core/rng.hpp"

namespace flirt {
namespace {

Pose2 as_read(const Pose2& before_from_after, const OdometryParams& params, Rng& rng) {
  const double way = norm(before_from_after.translation());
  const double turn = std::abs(before_from_after.theta);
  const double way_error = params.translation_bias * way + params.translation_noise * std::sqrt(way) * rng.normal();
  const double turn_error = params.rotation_bias * before_from_after.theta +
                            params.rotation_noise * std::sqrt(turn) * rng.normal() + params.heading_bias * way +
                            params.heading_noise * std::sqrt(way) * rng.normal();
  const double stretch = way > 0 ? 1 + way_error / way : 1.0;
  // Half of the turning error acts before the way, half after it, as if it grew along the way.
  const Pose2 half_turn{0, 0, turn_error / 2};
  const Pose2 stretched{stretch * before_from_after.x, stretch * before_from_after.y, before_from_after.theta};
  return half_turn * stretched * half_turn;
}

}  // namespace

std::vector<Pose2> drifting_odometry(std::span<const Pose2> map_from_robot, const OdometryParams& params,
                                     std::uint64_t seed) {
  std::vector<Pose2> odom_from_robot;
  odom_from_robot.reserve(map_from_robot.size());
  Rng rng(seed);
  for (std::size_t i = 0; i < map_from_robot.size(); ++i) {
    odom_from_robot.push_back(i == 0 ? map_from_robot[0]
                                     : odom_from_robot.back() *
                                           as_read(inverse(map_from_robot[i - 1]) * map_from_robot[i], params, rng));
  }
  return odom_from_robot;
}

}  // namespace flirt
