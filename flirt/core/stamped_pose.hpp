// flirt/core/stamped_pose.hpp: where the robot was at a moment; a list of them is a trajectory.
#pragma once

#include "flirt/core/pose2.hpp"

namespace flirt {

struct StampedPose {
  double stamp{0};  ///< s
  Pose2 map_from_robot{};
  friend bool operator==(const StampedPose&, const StampedPose&) = default;
};

}  // namespace flirt
