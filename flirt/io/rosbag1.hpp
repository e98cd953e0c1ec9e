// flirt/io/rosbag1.hpp: recordings of ROS 1, bag format 2.0. Internal to flirt/io.
#pragma once

#include "flirt/io/bag.hpp"

#include <cstddef>
#include <span>
#include <string>

namespace flirt::bag {

[[nodiscard]] bool is_rosbag1(std::span<const std::byte> bytes);

/// Hands out the messages in the order of the file, which is read from front to back without its index: a bag that was
/// never closed can be read. Chunks plain, bz2 or lz4. Records of unknown kinds are skipped. `name` stands in
/// complaints, with the byte of the record or chunk. Errors: data cut short (after all that is whole was handed out) or
/// damaged, messages of unknown connections, what the sink returns. O(bytes).
/// Format: http://wiki.ros.org/Bags/Format/2.0
[[nodiscard]] Result<void> read_rosbag1(const std::string& name, std::span<const std::byte> bytes, const Sink& sink,
                                        const Progress& progress);

}  // namespace flirt::bag
