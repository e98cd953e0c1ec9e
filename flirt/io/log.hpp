// flirt/io/log.hpp: one call that reads a log of scans, whatever its format, and tells what it found.
#pragma once

#include "flirt/core/parallel.hpp"
#include "flirt/core/result.hpp"
#include "flirt/core/scan.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// What to do with a line or message of a known kind that cannot be read.
enum class BrokenLines : std::uint8_t {
  strict,   ///< an error with its number
  lenient,  ///< skipped and counted
};

struct ReadOptions {
  BrokenLines broken_lines{BrokenLines::strict};
  std::optional<double>
      range_max{};        ///< m, > 0; readings of this length or more are no return; else found from the log
  std::string message{};  ///< scans to read: a kind of lines, as "RAWLASER1", or a topic; empty: the first that appears
};

/// What the poses of a log are.
enum class PoseSource : std::uint8_t {
  none,                    ///< it has none
  odometry,                ///< the robot's dead reckoning: in ScanLog::map_from_robot as in Scan::odom_from_robot
  corrected,               ///< corrected by SLAM, or true; no odometry
  corrected_and_odometry,  ///< both, in their two places
};
[[nodiscard]] constexpr auto enum_names(PoseSource) {
  return std::array{std::pair{PoseSource::none, std::string_view("none")},
                    std::pair{PoseSource::odometry, std::string_view("odometry")},
                    std::pair{PoseSource::corrected, std::string_view("corrected")},
                    std::pair{PoseSource::corrected_and_odometry, std::string_view("corrected_and_odometry")}};
}

/// How the longest valid range was found.
enum class RangeMaxSource : std::uint8_t {
  option,    ///< ReadOptions::range_max
  declared,  ///< the log says so, in its scan lines or its parameters
  assumed,   ///< the log does not say: 50 m
  detected,  ///< readings pile up at one value below what was declared or assumed: that value is "no return"
};
[[nodiscard]] constexpr auto enum_names(RangeMaxSource) {
  return std::array{std::pair{RangeMaxSource::option, std::string_view("option")},
                    std::pair{RangeMaxSource::declared, std::string_view("declared")},
                    std::pair{RangeMaxSource::assumed, std::string_view("assumed")},
                    std::pair{RangeMaxSource::detected, std::string_view("detected")}};
}

/// Lines by their kind: the first word, "#" for comments, "(unreadable)" for what is no word. Of a recording messages
/// by their topic.
using LineCounts = std::map<std::string, std::size_t, std::less<>>;

/// What was read, what was skipped, and what is odd about the log.
struct LogReport {
  std::string format{};           ///< "CARMEN"
  std::string message{};          ///< kind of the scan lines, or topic of the scans, that were read
  std::string_view unit{"line"};  ///< what the counts below count: "line" or "message"
  bool is_gzip{false};
  std::size_t lines{0};
  LineCounts lines_used{};
  LineCounts lines_skipped{};
  std::size_t broken_lines{0};                 ///< skipped because they cannot be read (lenient)
  std::vector<std::string> broken_messages{};  ///< of the first few of them
  PoseSource poses{PoseSource::none};
  bool is_mounting_unknown{false};    ///< the recording does not say where the scanner sits: at the robot's origin
  bool odometry_repeats_pose{false};  ///< the log's odometry fields repeat its corrected poses: they were not used
  RangeMaxSource range_max_source{RangeMaxSource::assumed};
  std::size_t stamps_backwards{0};  ///< scans stamped earlier than the scan before
  bool stamps_constant{false};      ///< all scans (two or more) have the same stamp
  int stamp_digits{0};              ///< most significant digits of any stamp as written; 0: not known
  bool stamps_rounded{false};       ///< so few that tenths of seconds, and often more, got lost in writing
};

/// What a user should know about the log before trusting it, one sentence each; empty when all is well.
[[nodiscard]] std::vector<std::string> observations(const LogReport& report);

struct LoadedLog {
  ScanLog log{};
  LogReport report{};
};

/// Reads a log; the format is told from the content. Formats: CARMEN, plain or gzip (see flirt/io/carmen.hpp), and
/// recordings of ROS (see flirt/io/ros_log.hpp). Errors name the file and, where there is one, the line or message.
/// O(bytes); memory is that of the scans.
[[nodiscard]] Result<LoadedLog> read_log(const std::filesystem::path& path, const ReadOptions& options = {},
                                         const Progress& progress = {});

}  // namespace flirt
