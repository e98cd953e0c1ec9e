// flirt/match/columns.cpp: keypoints to columns.
#include "flirt/match/columns.hpp"

#include <cmath>

namespace flirt {
namespace {

constexpr double farthest_keypoint = 1e6;  ///< m, beyond any sensor

}  // namespace

bool is_usable(const Pose2& sensor_from_keypoint) {
  return is_finite(sensor_from_keypoint) && std::abs(sensor_from_keypoint.x) < farthest_keypoint &&
         std::abs(sensor_from_keypoint.y) < farthest_keypoint;
}

KeypointTable table_of(std::span<const Keypoint> keypoints) {
  KeypointTable table;
  table.x.reserve(keypoints.size());
  table.y.reserve(keypoints.size());
  table.theta.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) {
    const Pose2& pose = keypoint.sensor_from_keypoint;
    const bool usable = is_usable(pose);
    table.x.push_back(usable ? static_cast<float>(pose.x) : out_of_sight);
    table.y.push_back(usable ? static_cast<float>(pose.y) : out_of_sight);
    table.theta.push_back(usable ? static_cast<float>(pose.theta) : 0.0F);
  }
  return table;
}

}  // namespace flirt
