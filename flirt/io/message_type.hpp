// flirt/io/message_type.hpp: one name for a message type in ROS 1 and ROS 2. Internal to flirt/io.
#pragma once

#include <string>
#include <string_view>

namespace flirt::bag {

/// "sensor_msgs/LaserScan" from "sensor_msgs/msg/LaserScan"; other names as they are.
[[nodiscard]] inline std::string plain_type(std::string_view name) {
  constexpr std::string_view infix = "/msg/";
  std::string type(name);
  if (const std::size_t place = type.find(infix); place != std::string::npos) {
    type.replace(place, infix.size(), "/");
  }
  return type;
}

}  // namespace flirt::bag
