// apps/flirt/detect.cpp: `flirt detect`, keypoints and descriptors of the scans of a log.
#include "flirt/core/stopwatch.hpp"
#include "flirt/features/extract.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/log.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/detect_figure.hpp"
#include "apps/flirt/feature_flags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace flirt::app {
namespace {

struct DetectOptions {
  std::string log;
  std::optional<std::size_t> scan;  ///< else all
  std::string svg;
  std::optional<std::size_t> keypoint;  ///< whose descriptor is drawn; else the one with most returns around it
  FeatureFlags features;
  ParamFlags params;
};

/// Features of one scan and what they cost.
struct ScanFeatures {
  std::size_t scan{0};
  Features features{};
  double detect_us{0};
  double describe_us{0};
};

/// One per thread, so that memory is kept from scan to scan.
struct Worker {
  Detector detector;
  Describer describer;

  explicit Worker(const FeatureParams& params) : detector(params.detector), describer(params.descriptor) {}

  ScanFeatures extract(const ScanLog& log, std::size_t i) {
    ScanFeatures result{.scan = i};
    Stopwatch stopwatch;
    const std::span<const Keypoint> keypoints = detector.detect(log.scans[i]);
    result.detect_us = stopwatch.lap_us();
    result.features.keypoints.assign(keypoints.begin(), keypoints.end());
    result.features.descriptors = describer.describe(log.scans[i], result.features.keypoints);
    result.describe_us = stopwatch.lap_us();
    return result;
  }
};

std::vector<ScanFeatures> extract_all(const DetectOptions& options, const Session& session, const ScanLog& log,
                                      const FeatureParams& params) {
  const std::size_t first = options.scan.value_or(0);
  std::vector<ScanFeatures> results(options.scan ? 1 : log.scans.size());
  std::vector<Worker> workers;
  workers.reserve(thread_count(session.threads));
  for (std::size_t i = 0; i < thread_count(session.threads); ++i) { workers.emplace_back(params); }
  parallel_for(
      results.size(), session.threads,
      [&](std::size_t i, std::size_t thread) { results[i] = workers[thread].extract(log, first + i); },
      progress_bar(session, "detecting"));
  return results;
}

// --- JSON lines ------------------------------------------------------------------------------------------------------

/// The shortest decimal number that reads back as the same float.
double shortest(float value) {
  return std::strtod(fmt::format("{}", value).c_str(), nullptr);
}

nlohmann::ordered_json keypoint_json(const Keypoint& keypoint, std::span<const float> row) {
  nlohmann::ordered_json descriptor = nlohmann::ordered_json::array();
  for (const float entry : row) { descriptor.push_back(shortest(entry)); }
  return {{"x", keypoint.sensor_from_keypoint.x},
          {"y", keypoint.sensor_from_keypoint.y},
          {"theta", keypoint.sensor_from_keypoint.theta},
          {"scale", shortest(keypoint.scale)},
          {"support_radius", shortest(keypoint.support_radius)},
          {"response", shortest(keypoint.response)},
          {"beam", keypoint.beam},
          {"level", keypoint.level},
          {"descriptor", std::move(descriptor)}};
}

std::string json_line(const ScanFeatures& result, const Scan& scan, const FeatureParams& params) {
  nlohmann::ordered_json line{{"scan", result.scan},
                              {"stamp", scan.stamp},
                              {"beams", scan.ranges.size()},
                              {"detector", detector_name(params.detector)},
                              {"descriptor", descriptor_name(params.descriptor)},
                              {"keypoints", nlohmann::ordered_json::array()}};
  for (std::size_t k = 0; k < result.features.keypoints.size(); ++k) {
    line["keypoints"].push_back(keypoint_json(result.features.keypoints[k], result.features.descriptors.row(k)));
  }
  return json_text(line, -1);
}

void write_json_lines(const Session& session, const std::vector<ScanFeatures>& results, const ScanLog& log,
                      const FeatureParams& params) {
  if (session.json.empty()) { return; }
  std::vector<std::string> lines(results.size());
  parallel_for(results.size(), session.threads, [&](std::size_t i, std::size_t /*thread*/) {
    lines[i] = json_line(results[i], log.scans[results[i].scan], params);
  });
  std::string text;
  for (const std::string& line : lines) { text += line; }
  write_json_text(session, text);
}

// --- Text ------------------------------------------------------------------------------------------------------------

double median(std::vector<double> values) {
  if (values.empty()) { return 0.0; }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void print_keypoints(const ScanFeatures& result) {
  fmt::print("{:>8} {:>5} {:>8} {:>8} {:>9} {:>7} {:>8} {:>9}\n", "keypoint", "beam", "x m", "y m", "theta deg",
             "scale", "radius m", "response");
  for (std::size_t k = 0; k < result.features.keypoints.size(); ++k) {
    const Keypoint& keypoint = result.features.keypoints[k];
    const Pose2& pose = keypoint.sensor_from_keypoint;
    fmt::print("{:>8} {:>5} {:>8.3f} {:>8.3f} {:>9.2f} {:>7.3f} {:>8.3f} {:>9.4f}\n", k, keypoint.beam, pose.x, pose.y,
               degrees_from_radians(pose.theta), keypoint.scale, keypoint.support_radius, keypoint.response);
  }
}

void print_levels(const std::vector<ScanFeatures>& results) {
  std::vector<std::size_t> levels;
  for (const ScanFeatures& result : results) {
    for (const Keypoint& keypoint : result.features.keypoints) {
      levels.resize(std::max<std::size_t>(levels.size(), keypoint.level + 1U));
      ++levels[keypoint.level];
    }
  }
  fmt::print("per scan, by level from the finest:");
  for (const std::size_t keypoints : levels) {
    fmt::print(" {:.2f}", static_cast<double>(keypoints) / static_cast<double>(results.size()));
  }
  fmt::print("\n");
}

void print_summary(const std::vector<ScanFeatures>& results, const FeatureParams& params) {
  std::vector<double> counts;
  std::vector<double> detect_us;
  std::vector<double> describe_us;
  double keypoints = 0;
  double all_describe_us = 0;
  for (const ScanFeatures& result : results) {
    counts.push_back(static_cast<double>(result.features.keypoints.size()));
    detect_us.push_back(result.detect_us);
    describe_us.push_back(result.describe_us);
    keypoints += counts.back();
    all_describe_us += result.describe_us;
  }
  fmt::print("{}, {}: {} scans, {:.0f} keypoints, {:.1f} per scan (median {:.0f}, {:.0f} to {:.0f})\n",
             detector_name(params.detector), descriptor_name(params.descriptor), results.size(), keypoints,
             keypoints / static_cast<double>(results.size()), median(counts),
             *std::min_element(counts.begin(), counts.end()), *std::max_element(counts.begin(), counts.end()));
  print_levels(results);
  fmt::print("median time per scan: detect {:.0f} us, describe {:.0f} us; describe per keypoint {:.2f} us\n",
             median(detect_us), median(describe_us), keypoints > 0 ? all_describe_us / keypoints : 0.0);
}

// --- The command -----------------------------------------------------------------------------------------------------

void write_figure(const DetectOptions& options, const ScanLog& log, const FeatureParams& params) {
  const std::size_t index = options.scan.value_or(0);
  const Scan& scan = log.scans[index];
  FeatureTrace trace;
  const Features features = extract(scan, params, &trace);
  if (options.keypoint && *options.keypoint >= features.keypoints.size()) {
    throw UsageError(fmt::format("--keypoint: expected one of the {} keypoints of scan {}, counted from 0, found {}",
                                 features.keypoints.size(), index, *options.keypoint));
  }
  const std::size_t keypoint = options.keypoint.value_or(busiest_keypoint(trace.descriptor, features.keypoints.size()));
  const std::string title = fmt::format("Scan {} of {}", index, std::filesystem::path(options.log).filename().string());
  const svg::Figure figure = detect_figure({scan, params, features, trace, title, keypoint});
  value_or_quit(write_file_atomically(options.svg, svg::to_svg(figure)));
}

int run(const Session& session, const DetectOptions& options) {
  options.params.resolve(session);
  const FeatureParams params = options.features.features();
  const ScanLog log = value_or_quit(read_log(options.log, {}, progress_bar(session, "reading"))).log;
  if (log.scans.empty()) { throw BadInput(options.log + ": expected scans, found none"); }
  if (options.scan.value_or(0) >= log.scans.size()) {
    throw UsageError(
        fmt::format("--scan: expected a scan of the log, 0 to {}, found {}", log.scans.size() - 1, *options.scan));
  }
  const std::vector<ScanFeatures> results = extract_all(options, session, log, params);
  if (!options.svg.empty()) { write_figure(options, log, params); }
  if (session.talks()) {
    if (options.scan) { print_keypoints(results.front()); }
    print_summary(results, params);
  }
  write_json_lines(session, results, log, params);
  return exit_done;
}

}  // namespace

void add_detect(CLI::App& program, Session& session) {
  auto options = std::make_shared<DetectOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("LOG", options->log, "log file")->required();
    command.add_option("--scan", options->scan, "index of one scan in the log (default: all)");
    CLI::Option* svg = command.add_option("--svg", options->svg, "figure of that scan, or of the first");
    command
        .add_option("--keypoint", options->keypoint,
                    "index of the keypoint whose descriptor is drawn (default: the one with most returns around)")
        ->needs(svg);
    options->features.add(command, options->params);
  };
  CLI::App* command =
      add_command(program, session, "detect", "Keypoints and descriptors of the scans of a log.",
                  "flirt detect run.log.gz --scan 120 --svg scan120.svg --json scan120.jsonl", add_options);
  session.on(command, [&session, options] { return run(session, *options); });
}

}  // namespace flirt::app
