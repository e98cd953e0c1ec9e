#include "flirt/map/seen_motion.hpp"

#include "flirt/registration/dense_search.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {
namespace {

constexpr std::uint32_t most_candidates = 400;  // of whole blocks of places, most of them farther away
constexpr std::uint32_t most_refined = 12;

}  // namespace

std::optional<Pose2> seen_motion(const MapFields& fields, const ScanPoints& points, const Pose2& map_from_robot,
                                 const Pose2& robot_from_sensor, const MotionReach& reach, const SearchParams& params) {
  SearchParams near = params;
  near.dense.near_distance = reach.distance;
  near.dense.near_heading = reach.turn;
  near.dense.candidates = most_candidates;
  near.refined = most_refined;
  const Pose2 before = map_from_robot * robot_from_sensor;
  const auto is_near = [&](const Pose2& pose) {
    return distance(pose, before) <= reach.distance && heading_difference(pose, before) <= reach.turn;
  };
  std::vector<CoarsePose> coarse = dense_search_near(fields, points, std::span(&before, 1), near.dense);
  std::erase_if(coarse, [&](const CoarsePose& pose) { return !is_near(pose.map_from_sensor); });
  std::vector<ScoredPose> poses = judge(fields, points, finalists(fields, points, coarse, near), near);
  std::erase_if(poses, [&](const ScoredPose& pose) { return !is_near(pose.map_from_sensor); });
  if (poses.empty()) { return std::nullopt; }
  const ScoredPose& best =
      *std::ranges::max_element(poses, {}, [](const ScoredPose& pose) { return pose.score.preference; });
  return inverse(map_from_robot) * best.map_from_sensor * inverse(robot_from_sensor);
}

}  // namespace flirt
