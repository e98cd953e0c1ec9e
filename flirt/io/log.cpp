#include "flirt/io/log.hpp"

#include "flirt/core/fields.hpp"
#include "flirt/io/carmen.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/recording.hpp"
#include "flirt/io/ros_log.hpp"
#include "flirt/io/text.hpp"

#include <utility>

namespace flirt {
namespace {

constexpr std::size_t lines_to_look_at = 10000;

/// A complaint when the lines are of no log that can be read: looks for one of a known kind.
Result<void> require_known_format(LineReader& lines) {
  std::string first;
  for (std::size_t i = 0; i < lines_to_look_at; ++i) {
    const auto line = lines.next();
    if (!line) { return tl::unexpected(line.error()); }
    if (!*line) { break; }
    if (is_carmen_line((*line)->text)) { return {}; }
    if (first.empty()) { first = (*line)->text.substr(0, 60); }
  }
  const std::string found = first.empty() ? "an empty file" : "none, beginning with " + in_quotes(first);
  return fail(lines.name() +
              ": expected a CARMEN log or a recording of ROS (.bag, .mcap, .db3 or the folder of one), found " + found);
}

std::string counted(std::size_t n, std::string_view what) {
  return std::to_string(n) + ' ' + std::string(what) + (n == 1 ? "" : "s");
}

}  // namespace

std::vector<std::string> observations(const LogReport& report) {
  std::vector<std::string> sentences;
  if (report.broken_lines > 0) {
    sentences.push_back(counted(report.broken_lines, "broken " + std::string(report.unit)) + " skipped");
  }
  if (report.odometry_repeats_pose) {
    sentences.emplace_back("the odometry fields repeat the corrected poses: there is no odometry");
  }
  if (report.poses == PoseSource::odometry) { sentences.emplace_back("the poses are odometry, not corrected"); }
  if (report.poses == PoseSource::none) { sentences.emplace_back("the log has no poses"); }
  if (report.is_mounting_unknown) {
    sentences.emplace_back("the recording does not say where the scanner sits on the robot: taken for its origin");
  }
  if (report.stamps_constant) { sentences.emplace_back("all scans have the same stamp"); }
  if (report.stamps_backwards > 0) {
    sentences.push_back("stamps run backwards " + counted(report.stamps_backwards, "time") +
                        ": the order in the file is kept");
  }
  if (report.stamps_rounded) {
    sentences.push_back("stamps are written with " + std::to_string(report.stamp_digits) +
                        " digits at most: they are rounded");
  }
  if (report.range_max_source == RangeMaxSource::detected) {
    sentences.emplace_back("readings pile up at one value, which was taken for \"no return\"");
  }
  return sentences;
}

Result<LoadedLog> read_log(const std::filesystem::path& path, const ReadOptions& options, const Progress& progress) {
  if (options.range_max && !(*options.range_max > 0)) {
    return fail("the longest range: expected more than 0 m, found " + std::to_string(*options.range_max));
  }
  if (bag::is_recording(path)) { return read_ros_log(path, options, progress); }
  auto lines = LineReader::open(path);
  if (!lines) { return tl::unexpected(lines.error()); }
  lines->mark();
  if (auto good = require_known_format(*lines); !good) { return tl::unexpected(good.error()); }
  lines->rewind();
  return read_carmen(*lines, options, progress);
}

}  // namespace flirt
