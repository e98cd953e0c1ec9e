// flirt/io/ros_messages.hpp: the messages of ROS 1 and ROS 2 that a log of scans is made of. Internal to flirt/io.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/io/bag.hpp"

#include <Eigen/Geometry>

#include <string>
#include <string_view>
#include <vector>

namespace flirt::ros {

inline constexpr std::string_view laser_scan_type = "sensor_msgs/LaserScan";
inline constexpr std::string_view odometry_type = "nav_msgs/Odometry";
[[nodiscard]] bool is_transform_type(std::string_view type);  ///< tf2_msgs/TFMessage, or tf/tfMessage of old

/// sensor_msgs/LaserScan. Names of frames are without a leading '/', which old recordings have.
struct LaserScan {
  double stamp{0};  ///< s
  std::string frame{};
  Beams beams{};
  std::vector<double> ranges{};  ///< m
};

/// geometry_msgs/TransformStamped, and what nav_msgs/Odometry says of a pose.
struct Transform {
  double stamp{0};  ///< s
  std::string parent{};
  std::string child{};
  Eigen::Isometry3d parent_from_child{Eigen::Isometry3d::Identity()};
};

/// Errors, of all three: bytes missing or not such a message; numbers that are no angles, or no pose.
[[nodiscard]] Result<LaserScan> laser_scan_of(const bag::Message& message);
[[nodiscard]] Result<Transform> odometry_of(const bag::Message& message);
[[nodiscard]] Result<std::vector<Transform>> transforms_of(const bag::Message& message);

}  // namespace flirt::ros
