// flirt/io/format.hpp: what a file of poses or scans is, and its trajectory whatever it is.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/core/stamped_pose.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

struct ScanLog;

enum class FileFormat : std::uint8_t {
  carmen,
  ros,  ///< a recording, which is read and never written
  tum,
  g2o,
  toro,
};
constexpr auto enum_names(FileFormat /*tag*/) {
  using enum FileFormat;
  return std::array<std::pair<FileFormat, std::string_view>, 5>{
      {{carmen, "carmen"}, {ros, "ros"}, {tum, "tum"}, {g2o, "g2o"}, {toro, "toro"}}};
}

/// By content: the first line that settles it. A log among whose scans there are VERTEX2 lines is a log.
/// Errors: no such file, none of these formats.
[[nodiscard]] Result<FileFormat> format_of(const std::filesystem::path& path);

/// By the end of the name: .log, .clf, .carmen; .bag, .mcap, .db3; .tum; .g2o; .graph, .toro. Nothing for others.
[[nodiscard]] std::optional<FileFormat> format_by_name(const std::filesystem::path& path);

/// Stamps of the scans and the poses that the log states. Needs a log with poses.
[[nodiscard]] std::vector<StampedPose> trajectory_of(const ScanLog& log);

/// The trajectory of a TUM file or of a log with poses. Errors: those of their readers; a log without poses; a graph,
/// which has no stamps.
[[nodiscard]] Result<std::vector<StampedPose>> read_trajectory(const std::filesystem::path& path);

}  // namespace flirt
