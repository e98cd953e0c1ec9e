#include "flirt/io/format.hpp"

#include "flirt/core/scan.hpp"
#include "flirt/io/carmen.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/recording.hpp"
#include "flirt/io/text.hpp"
#include "flirt/io/tum.hpp"

#include <string>
#include <system_error>

namespace flirt {
namespace {

bool is_of(std::string_view kind, std::initializer_list<std::string_view> kinds) {
  for (const std::string_view one : kinds) {
    if (kind == one) { return true; }
  }
  return false;
}

}  // namespace

Result<FileFormat> format_of(const std::filesystem::path& path) {
  if (bag::is_recording(path)) { return FileFormat::ros; }
  std::error_code error;
  if (const auto status = std::filesystem::status(path, error); std::filesystem::exists(status) &&
                                                                !std::filesystem::is_regular_file(status) &&
                                                                !std::filesystem::is_directory(status)) {
    return fail(path.string() + ": expected a regular file, found a pipe or a device");  // readers open it again
  }
  auto lines = LineReader::open(path);
  if (!lines) { return tl::unexpected(lines.error()); }
  bool has_graph_lines = false;
  std::string first;
  while (true) {
    const auto line = lines->next();
    if (!line) { return tl::unexpected(line.error()); }
    if (!*line) { break; }
    const std::string_view kind = Words((*line)->text).next();
    if (kind.empty() || kind.starts_with('#')) { continue; }
    if (is_of(kind, {"VERTEX_SE2", "EDGE_SE2", "FIX"})) { return FileFormat::g2o; }
    if (is_of(kind, {"VERTEX2", "EDGE2"})) {
      has_graph_lines = true;
    } else if (is_carmen_line((*line)->text)) {
      return FileFormat::carmen;
    } else if (!has_graph_lines && first.empty() && number_from<double>(kind)) {
      return FileFormat::tum;
    }
    if (first.empty()) { first = kind; }
  }
  if (has_graph_lines) { return FileFormat::toro; }
  return fail(path.string() + ": expected a log (CARMEN, ROS), a TUM trajectory, or a graph (g2o, TORO), found " +
              (first.empty() ? std::string("an empty file") : "none of them, beginning with " + in_quotes(first)));
}

std::optional<FileFormat> format_by_name(const std::filesystem::path& path) {
  const std::string end = path.extension().string();
  if (is_of(end, {".log", ".clf", ".carmen"})) { return FileFormat::carmen; }
  if (is_of(end, {".bag", ".mcap", ".db3"})) { return FileFormat::ros; }
  if (end == ".tum") { return FileFormat::tum; }
  if (end == ".g2o") { return FileFormat::g2o; }
  if (is_of(end, {".graph", ".toro"})) { return FileFormat::toro; }
  return std::nullopt;
}

std::vector<StampedPose> trajectory_of(const ScanLog& log) {
  std::vector<StampedPose> trajectory;
  trajectory.reserve(log.map_from_robot.size());
  for (std::size_t i = 0; i < log.map_from_robot.size(); ++i) {
    trajectory.push_back({log.scans[i].stamp, log.map_from_robot[i]});
  }
  return trajectory;
}

Result<std::vector<StampedPose>> read_trajectory(const std::filesystem::path& path) {
  const auto format = format_of(path);
  if (!format) { return tl::unexpected(format.error()); }
  if (*format == FileFormat::tum) { return read_tum(path); }
  if (*format != FileFormat::carmen && *format != FileFormat::ros) {
    return fail(path.string() + ": expected a TUM trajectory or a log with poses, found a graph, which has no stamps");
  }
  const auto loaded = read_log(path);
  if (!loaded) { return tl::unexpected(loaded.error()); }
  if (loaded->log.map_from_robot.empty()) { return fail(path.string() + ": expected a log with poses, found none"); }
  return trajectory_of(loaded->log);
}

}  // namespace flirt
