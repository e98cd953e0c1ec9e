// flirt/io/rosbag2.hpp: recordings of ROS 2, the folder and its sqlite3 files. Internal to flirt/io.
#pragma once

#include "flirt/io/bag.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace flirt::bag {

[[nodiscard]] bool is_sqlite(std::span<const std::byte> bytes);

/// Hands out the messages of a .db3 file that are serialized as "cdr", by their stamps, those of equal stamps in the
/// order in which they were stored. Opens the file to read only. Errors: a file that sqlite cannot read or that has not
/// the tables of a recording, damage, what the sink returns. O(n), O(n log n) when the file has no index of stamps.
[[nodiscard]] Result<void> read_sqlite_bag(const std::filesystem::path& path, const Sink& sink,
                                           const Progress& progress);

/// The .db3 or .mcap files of a recording in the order that its metadata.yaml lists. For a file that is listed as
/// compressed as a whole (x.db3.zstd) the one beside it that is not. Errors: no metadata.yaml, no files listed, a file
/// missing or only there compressed, messages compressed one by one.
[[nodiscard]] Result<std::vector<std::filesystem::path>> files_of_recording(const std::filesystem::path& folder);

}  // namespace flirt::bag
