// flirt/io/recording.hpp: one call that reads messages of ROS, whatever holds them. Internal to flirt/io.
#pragma once

#include "flirt/io/bag.hpp"

#include <filesystem>
#include <string>

namespace flirt::bag {

/// Whether the path is a folder with a metadata.yaml, or a regular file that begins as a ROS 1 bag, MCAP or sqlite3
/// does (or whose name says that it is such a file, compressed as a whole). Opens nothing but regular files.
[[nodiscard]] bool is_recording(const std::filesystem::path& path);

/// Hands out all messages and returns what the recording is: "ROS 1 bag", "MCAP" or "ROS 2 bag (sqlite3)". Errors name
/// the file and, where there is one, the byte; those of the sink are passed on. See rosbag1.hpp, mcap.hpp, rosbag2.hpp.
[[nodiscard]] Result<std::string> read_recording(const std::filesystem::path& path, const Sink& sink,
                                                 const Progress& progress);

}  // namespace flirt::bag
