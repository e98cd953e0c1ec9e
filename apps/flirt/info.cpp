// apps/flirt/info.cpp: `flirt info`, what a log holds.
#include "flirt/core/fields.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/log_summary.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/reading_flags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

namespace flirt::app {
namespace {

struct InfoOptions {
  std::string log;
  ReadingFlags reading{};
};

// --- Text ------------------------------------------------------------------------------------------------------------

void print_line(std::string_view name, const std::string& value) {
  fmt::print("{:<12}{}\n", name, value);
}

std::string counts_text(const LineCounts& counts) {
  std::string text;
  for (const auto& [kind, n] : counts) { text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, kind); }
  return text.empty() ? "none" : text;
}

std::string beams_text(const LogSummary& summary) {
  if (summary.fewest_beams == summary.most_beams) { return fmt::format("{} beams", summary.most_beams); }
  return fmt::format("{} to {} beams", summary.fewest_beams, summary.most_beams);
}

/// One that tells angles and ranges: the first with beams.
const Scan& typical_scan(const ScanLog& log) {
  const auto found = std::ranges::find_if(log.scans, [](const Scan& scan) { return !scan.ranges.empty(); });
  return found == log.scans.end() ? log.scans.front() : *found;
}

std::string angles_text(const Scan& scan) {
  if (scan.ranges.empty()) { return "none"; }
  return fmt::format("{:.3f} to {:.3f} deg in steps of {:.4f} deg{}", degrees_from_radians(scan.beams.angle_min),
                     degrees_from_radians(scan.beams.angle(scan.ranges.size() - 1)),
                     degrees_from_radians(scan.beams.angle_step), is_full_turn(scan) ? " (a full turn)" : "");
}

std::string readings_text(const RangeSummary& ranges) {
  const double all = static_cast<double>(ranges.hits + ranges.no_returns + ranges.invalid);
  const auto percent = [&](std::size_t n) { return all > 0 ? 100.0 * static_cast<double>(n) / all : 0.0; };
  return fmt::format("{} hits ({:.1f} %), {} no return ({:.1f} %), {} invalid", ranges.hits, percent(ranges.hits),
                     ranges.no_returns, percent(ranges.no_returns), ranges.invalid);
}

std::string path_text(const PathSummary& path) {
  if (path.poses == 0) { return "none"; }
  return fmt::format("{} poses, {:.1f} m, x {:.2f} to {:.2f} m, y {:.2f} to {:.2f} m", path.poses, path.length,
                     path.low.x, path.high.x, path.low.y, path.high.y);
}

void print_text(const InfoOptions& options, const LoadedLog& loaded, const LogSummary& summary) {
  const LogReport& report = loaded.report;
  const Scan& scan = typical_scan(loaded.log);
  const Pose2& laser = scan.robot_from_sensor;
  print_line("log", options.log);
  print_line("format",
             fmt::format("{}{}, {} {}s", report.format, report.is_gzip ? " (gzip)" : "", report.lines, report.unit));
  print_line("used", counts_text(report.lines_used));
  print_line("skipped", counts_text(report.lines_skipped));
  print_line("scans", fmt::format("{} x {}", summary.scans, beams_text(summary)));
  print_line("angles", angles_text(scan));
  print_line("readings", readings_text(summary.ranges));
  print_line("hits", fmt::format("{:.2f} to {:.2f} m, median {:.2f} m, 95 % below {:.2f} m", summary.ranges.shortest,
                                 summary.ranges.longest, summary.ranges.median, summary.ranges.percentile_95));
  print_line("range max", fmt::format("{:g} m ({})", scan.beams.range_max, to_string(report.range_max_source)));
  print_line("stamps",
             fmt::format("{:.6f} to {:.6f} s: {:.1f} s, {:.4f} s between scans (median)", summary.stamps.first,
                         summary.stamps.last, summary.stamps.duration, summary.stamps.median_interval));
  print_line("laser", fmt::format("at x {:.4f} m, y {:.4f} m, {:.3f} deg on the robot", laser.x, laser.y,
                                  degrees_from_radians(laser.theta)));
  print_line("poses", fmt::format("{}: {}", to_string(report.poses), path_text(summary.map)));
  print_line("odometry", path_text(summary.odometry));
  const std::vector<std::string> warnings = observations(report);
  print_line("warnings", std::to_string(warnings.size()));
  for (const std::string& warning : warnings) { fmt::print("  {}\n", warning); }
  for (const std::string& message : report.broken_messages) { fmt::print("  {}\n", message); }
}

// --- JSON ------------------------------------------------------------------------------------------------------------

nlohmann::ordered_json path_json(const PathSummary& path) {
  if (path.poses == 0) { return {{"count", 0}}; }
  return {{"count", path.poses},
          {"path", path.length},
          {"low", {path.low.x, path.low.y}},
          {"high", {path.high.x, path.high.y}}};
}

nlohmann::ordered_json angles_json(const Scan& scan) {
  if (scan.ranges.empty()) { return nullptr; }
  return {{"first", scan.beams.angle_min},
          {"last", scan.beams.angle(scan.ranges.size() - 1)},
          {"step", scan.beams.angle_step},
          {"full_turn", is_full_turn(scan)}};
}

nlohmann::ordered_json ranges_json(const RangeSummary& ranges, const Scan& scan, RangeMaxSource source) {
  return {{"hits", ranges.hits},
          {"no_returns", ranges.no_returns},
          {"invalid", ranges.invalid},
          {"shortest", ranges.shortest},
          {"median", ranges.median},
          {"percentile_95", ranges.percentile_95},
          {"longest", ranges.longest},
          {"range_min", scan.beams.range_min},
          {"range_max", scan.beams.range_max},
          {"range_max_source", to_string(source)}};
}

nlohmann::ordered_json stamps_json(const StampSummary& stamps, const LogReport& report) {
  return {{"first", stamps.first},
          {"last", stamps.last},
          {"duration", stamps.duration},
          {"median_interval", stamps.median_interval},
          {"backwards", report.stamps_backwards},
          {"constant", report.stamps_constant},
          {"digits", report.stamp_digits}};
}

nlohmann::ordered_json as_json(const InfoOptions& options, const LoadedLog& loaded, const LogSummary& summary) {
  const LogReport& report = loaded.report;
  const Scan& scan = typical_scan(loaded.log);
  const Pose2& laser = scan.robot_from_sensor;
  nlohmann::ordered_json poses{{"source", to_string(report.poses)},
                               {"odometry_repeats_pose", report.odometry_repeats_pose}};
  poses.update(path_json(summary.map));
  return {{"log", options.log},
          {"format", report.format},
          {"gzip", report.is_gzip},
          {"message", report.message},
          {"lines",
           {{"total", report.lines},
            {"used", report.lines_used},
            {"skipped", report.lines_skipped},
            {"broken", report.broken_lines}}},
          {"scans", summary.scans},
          {"beams", {{"fewest", summary.fewest_beams}, {"most", summary.most_beams}}},
          {"angles", angles_json(scan)},
          {"ranges", ranges_json(summary.ranges, scan, report.range_max_source)},
          {"stamps", stamps_json(summary.stamps, report)},
          {"robot_from_sensor", {laser.x, laser.y, laser.theta}},
          {"poses", poses},
          {"odometry", path_json(summary.odometry)},
          {"warnings", observations(report)},
          {"broken_lines", report.broken_messages},
          {"provenance", provenance()}};
}

int run(const Session& session, const InfoOptions& options) {
  ParamFlags().resolve(session);  // no key of a file is known here
  const LoadedLog loaded =
      value_or_quit(read_log(options.log, options.reading.options(), progress_bar(session, "reading")));
  const LogSummary summary = summarize(loaded.log);
  if (session.talks()) { print_text(options, loaded, summary); }
  write_json(session, as_json(options, loaded, summary));
  return exit_done;
}

}  // namespace

void add_info(CLI::App& program, Session& session) {
  auto options = std::make_shared<InfoOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("LOG", options->log, "log: CARMEN, plain or gzip, or a recording of ROS")->required();
    options->reading.add_to(command);
  };
  CLI::App* command =
      add_command(program, session, "info", "What a log holds: scans, angles, ranges, stamps, poses, oddities.",
                  "flirt info run.log.gz --json info.json", add_options);
  session.on(command, [&session, options] { return run(session, *options); });
}

}  // namespace flirt::app
