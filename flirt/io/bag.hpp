// flirt/io/bag.hpp: recorded messages of a robot, whatever the file that holds them. Internal to flirt/io.
#pragma once

#include "flirt/core/parallel.hpp"
#include "flirt/core/result.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace flirt::bag {

/// How the fields of a message became bytes.
enum class Serialization : std::uint8_t {
  ros1,  ///< ROS 1: little-endian, packed
  cdr,   ///< ROS 2: OMG common data representation, with its header of four bytes
};

struct Message {
  std::string_view topic{};            ///< "/scan"
  std::string_view type{};             ///< "sensor_msgs/LaserScan": package and name, without ROS 2's "/msg/"
  Serialization serialization{};       ///< of `bytes`
  std::span<const std::byte> bytes{};  ///< valid during the call alone
};

/// "sensor_msgs/LaserScan" from "sensor_msgs/msg/LaserScan"; other names as they are.
[[nodiscard]] inline std::string plain_type(std::string_view name) {
  constexpr std::string_view infix = "/msg/";
  std::string type(name);
  if (const std::size_t place = type.find(infix); place != std::string::npos) {
    type.replace(place, infix.size(), "/");
  }
  return type;
}

/// Takes the messages one after the other; an error ends the reading and is passed on.
using Sink = std::function<Result<void>(const Message&)>;

}  // namespace flirt::bag
