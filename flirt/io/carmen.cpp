#include "flirt/io/carmen.hpp"

#include "flirt/io/carmen_assembly.hpp"
#include "flirt/io/carmen_lines.hpp"
#include "flirt/io/log_oddities.hpp"
#include "flirt/io/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace flirt {
namespace {

using carmen::Gathered;
using carmen::Layout;

constexpr std::size_t most_kinds = 200;        // that are counted by name
constexpr std::size_t longest_kind = 32;       // characters
constexpr std::size_t lines_per_report = 256;  // between two calls of `progress`

/// The name under which a line is counted.
std::string_view counted_kind(std::string_view kind) {
  if (kind.starts_with('#')) { return "#"; }
  const bool is_word = kind.size() <= longest_kind && std::all_of(kind.begin(), kind.end(), [](char c) {
                         return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
                       });
  return is_word ? kind : "(unreadable)";
}

void count(LineCounts& counts, std::string_view kind) {
  auto place = counts.find(kind);
  if (place == counts.end()) {
    place = counts.try_emplace(std::string(counts.size() < most_kinds ? kind : "(unreadable)"), 0).first;
  }
  ++place->second;
}

/// What became of a line.
enum class Use : std::uint8_t { used, skipped };

Result<Use> take_scan(Gathered& gathered, std::string_view kind, Layout layout, std::string_view fields) {
  if (gathered.kind.empty()) { gathered.kind = kind; }
  if (gathered.kind != kind) { return Use::skipped; }
  auto scan = carmen::parse_scan(fields, layout);
  if (!scan) { return tl::unexpected(std::move(scan).error()); }
  gathered.scans.push_back(*std::move(scan));
  gathered.odometry_before.push_back(gathered.odometry.size());
  gathered.true_pose.push_back(gathered.last_true_pose);
  return Use::used;
}

/// ODOM lines are only needed for scan lines without poses.
Result<Use> take_odometry(Gathered& gathered, std::string_view fields) {
  if (!gathered.kind.empty() && carmen::layout_of(gathered.kind) != Layout::rawlaser) { return Use::skipped; }
  const auto pose = carmen::parse_odometry(fields);
  if (!pose) { return tl::unexpected(pose.error()); }
  gathered.odometry.push_back(*pose);
  return Use::used;
}

Result<Use> take_true_pose(Gathered& gathered, std::string_view fields) {
  const auto pose = carmen::parse_true_pose(fields);
  if (!pose) { return tl::unexpected(pose.error()); }
  gathered.last_true_pose = pose->pose;
  return Use::used;
}

Result<Use> take_parameter(Gathered& gathered, std::string_view fields) {
  Words words(fields);
  const std::string_view name = words.next();
  const std::array<std::pair<std::string_view, std::optional<double>*>, 4> known{
      {{"robot_frontlaser_offset", &gathered.front_offset},
       {"robot_rearlaser_offset", &gathered.rear_offset},
       {"robot_front_laser_max", &gathered.front_range_max},
       {"robot_rear_laser_max", &gathered.rear_range_max}}};
  for (const auto& [known_name, value] : known) {
    if (name != known_name) { continue; }
    const std::string_view word = words.next();
    *value = number_from<double>(word);
    if (!*value || !(std::abs(**value) <= 1000)) {  // m
      return fail("expected a number within 1000 for " + std::string(name) + ", found " + in_quotes(word));
    }
    return Use::used;
  }
  return Use::skipped;
}

Result<Use> take(Gathered& gathered, std::string_view kind, std::string_view fields) {
  if (const auto layout = carmen::layout_of(kind)) { return take_scan(gathered, kind, *layout, fields); }
  if (kind == "ODOM") { return take_odometry(gathered, fields); }
  if (kind == "TRUEPOS") { return take_true_pose(gathered, fields); }
  if (kind == "PARAM") { return take_parameter(gathered, fields); }
  if (kind == "VERTEX2" || kind == "NEFF") { gathered.is_corrected = true; }
  return Use::skipped;
}

Result<void> take_line(Gathered& gathered, LogReport& report, const ReadOptions& options, const Line& line,
                       const std::string& name) {
  Words words(line.text);
  const std::string_view kind = words.next();
  if (kind.empty()) { return {}; }
  const auto use = take(gathered, kind, words.rest());
  if (!use) {
    const std::string cut = line.end == LineEnd::end_of_file ? " (the last line, which has no end)" : "";
    const std::string place = name + ":" + std::to_string(line.number) + ": ";
    return reject(report, options, place + std::string(kind) + ": " + use.error().message + cut);
  }
  count(*use == Use::used ? report.lines_used : report.lines_skipped, counted_kind(kind));
  return {};
}

/// ODOM lines that came before the first scan line were kept in vain when its kind has poses of its own.
void count_unused_odometry(const Gathered& gathered, LogReport& report) {
  const auto place = report.lines_used.find("ODOM");
  if (place == report.lines_used.end() || carmen::layout_of(gathered.kind) == Layout::rawlaser) { return; }
  report.lines_skipped["ODOM"] += place->second;
  report.lines_used.erase(place);
}

Error no_scans(const std::string& name, const ReadOptions& options, const LogReport& report) {
  std::string message = name + ": expected ";
  message +=
      options.message.empty() ? std::string("scan lines (FLASER, ROBOTLASER1, RAWLASER1)") : options.message + " lines";
  message += ", found none";
  std::string_view separator = "; the log holds ";
  for (const auto* counts : {&report.lines_used, &report.lines_skipped}) {
    for (const auto& [kind, n] : *counts) {
      message.append(separator).append(kind).append(" (").append(std::to_string(n)).append(")");
      separator = ", ";
    }
  }
  return {message};
}

}  // namespace

bool is_carmen_line(std::string_view line) {
  constexpr std::array<std::string_view, 12> others{"ODOM",    "PARAM",           "NEFF",   "SYNC",
                                                    "TRUEPOS", "REMISSIONFLASER", "LASER3", "VERTEX2",
                                                    "EDGE2",   "LASER4",          "MARKER", "GPS"};
  const std::string_view kind = Words(line).next();
  return carmen::layout_of(kind).has_value() || std::find(others.begin(), others.end(), kind) != others.end();
}

Result<LoadedLog> read_carmen(LineReader& lines, const ReadOptions& options, const Progress& progress) {
  LogReport report{.format = "CARMEN", .is_gzip = lines.is_gzip()};
  Gathered gathered{.kind = options.message};
  while (true) {
    const auto line = lines.next();
    if (!line) {  // the file itself is broken: what came before it stands
      if (auto good = reject(report, options, line.error().message); !good) { return tl::unexpected(good.error()); }
      break;
    }
    if (!*line) { break; }
    ++report.lines;
    if (auto good = take_line(gathered, report, options, **line, lines.name()); !good) {
      return tl::unexpected(good.error());
    }
    if (progress && report.lines % lines_per_report == 0) { progress(lines.share_read()); }
  }
  if (gathered.scans.empty()) { return tl::unexpected(no_scans(lines.name(), options, report)); }
  report.message = gathered.kind;
  count_unused_odometry(gathered, report);
  ScanLog log = carmen::assemble(std::move(gathered), options.range_max, report);
  if (progress) { progress(1.0); }
  return LoadedLog{std::move(log), std::move(report)};
}

}  // namespace flirt
