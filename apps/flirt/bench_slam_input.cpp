#include "apps/flirt/bench_slam_input.hpp"

#include "flirt/io/format.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/relations.hpp"
#include "flirt/sim/odometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <utility>

namespace flirt::app {
namespace {

struct Wanted {
  std::string name;
  std::string file;
  std::map<std::string, std::string> options;
};

Wanted parse(const std::string& text) {
  const auto complain = [&](const std::string& found) {
    throw UsageError(
        "--log: expected NAME=FILE[,truth=FILE][,relations=FILE][,odometry=own|synthetic|none][,bound=M], "
        "found " +
        found);
  };
  Wanted wanted;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == part.size()) { complain("'" + part + "'"); }
    const std::string key = part.substr(0, equals);
    const std::string value = part.substr(equals + 1);
    if (begin == 0) {
      wanted.name = key;
      wanted.file = value;
    } else if (key == "truth" || key == "relations" || key == "odometry" || key == "bound") {
      wanted.options[key] = value;
    } else {
      complain("'" + key + "'");
    }
    begin = end + 1;
  }
  // Names become those of files and folders.
  if (wanted.name.find_first_of("/\\") != std::string::npos) { complain("a name with a slash: '" + wanted.name + "'"); }
  return wanted;
}

double parse_bound(const std::string& text) {
  double bound = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bound);
  if (error != std::errc{} || end != text.data() + text.size() || !(bound > 0)) {
    throw UsageError("--log: bound: expected metres > 0, found '" + text + "'");
  }
  return bound;
}

/// The true pose of each scan; empty when one has none.
std::vector<Pose2> true_poses(const ScanLog& log, const std::vector<StampedPose>& truth) {
  std::vector<Pose2> poses;
  for (const std::optional<Pose2>& pose : poses_of_scans(log, truth)) {
    if (!pose) { return {}; }
    poses.push_back(*pose);
  }
  return poses;
}

bool carries_odometry(const ScanLog& log) {
  return std::ranges::any_of(log.scans, [](const Scan& scan) { return scan.odom_from_robot.has_value(); });
}

void set_odometry(SlamInput& input, const std::string& wanted, std::uint64_t seed) {
  if (wanted == "own" && !carries_odometry(input.log)) {
    throw BadInput(input.file + ": expected odometry, found none of its own (odometry=synthetic makes some)");
  }
  input.odometry = wanted;
  if (wanted == "none") {
    for (Scan& scan : input.log.scans) { scan.odom_from_robot.reset(); }
  }
  if (wanted != "synthetic") { return; }
  if (input.corrected.empty()) {
    throw BadInput(input.file + ": expected a true pose for each scan to make odometry of, found scans without");
  }
  const std::vector<Pose2> odometry = drifting_odometry(input.corrected, {}, seed);
  for (std::size_t i = 0; i < odometry.size(); ++i) { input.log.scans[i].odom_from_robot = odometry[i]; }
}

}  // namespace

SlamInput read_slam_input(const std::string& text, const Session& session) {
  const Wanted wanted = parse(text);
  const auto option = [&](const std::string& key) {
    const auto found = wanted.options.find(key);
    return found == wanted.options.end() ? std::string{} : found->second;
  };
  const std::string odometry = option("odometry");
  if (!odometry.empty() && odometry != "own" && odometry != "synthetic" && odometry != "none") {
    throw UsageError("--log: odometry: expected own, synthetic or none, found '" + odometry + "'");
  }
  SlamInput input{.name = wanted.name, .file = wanted.file};
  if (!option("bound").empty()) { input.bound = parse_bound(option("bound")); }
  LoadedLog loaded = value_or_quit(read_log(wanted.file, {}, progress_bar(session, "reading " + wanted.name)));
  const PoseSource poses = loaded.report.poses;
  input.log = std::move(loaded.log);
  if (!option("truth").empty()) {
    input.truth = value_or_quit(read_trajectory(option("truth")));
    input.corrected = true_poses(input.log, input.truth);
  } else if (poses == PoseSource::corrected || poses == PoseSource::corrected_and_odometry) {
    input.truth = trajectory_of(input.log);
    input.corrected = input.log.map_from_robot;
  }
  input.log.map_from_robot.clear();
  if (!option("relations").empty()) { input.relations = value_or_quit(read_relations(option("relations"))); }
  set_odometry(input, odometry.empty() ? (carries_odometry(input.log) ? "own" : "none") : odometry, session.seed);
  return input;
}

void thin(SlamInput& input, std::size_t every) {
  const auto keep = [&](auto& values) {
    for (std::size_t i = 0; i * every < values.size(); ++i) { std::swap(values[i], values[i * every]); }
    values.resize((values.size() + every - 1) / every);
  };
  if (every == 1) { return; }
  keep(input.log.scans);
  keep(input.corrected);
}

}  // namespace flirt::app
