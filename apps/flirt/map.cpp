// apps/flirt/map.cpp: `flirt map`, a place map from a log with poses.
#include "flirt/io/feature_params_json.hpp"
#include "flirt/io/flirt_map.hpp"
#include "flirt/io/log.hpp"
#include "flirt/map/place_map.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/feature_flags.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

namespace flirt::app {
namespace {

struct Options {
  std::string log;
  std::string out;
  std::size_t every{1};
  bool variances{false};
  FeatureFlags features;
  ParamFlags params;
};

/// Every K-th scan of a log.
ScanLog thinned(ScanLog log, std::size_t every) {
  if (every == 1) { return log; }
  ScanLog kept;
  for (std::size_t i = 0; i < log.scans.size(); i += every) {
    kept.scans.push_back(std::move(log.scans[i]));
    kept.map_from_robot.push_back(log.map_from_robot[i]);
  }
  return kept;
}

void refuse_grid_maps(const std::string& log) {
  const std::string extension = std::filesystem::path(log).extension().string();
  if (extension == ".yaml" || extension == ".pgm") {
    throw UsageError(log + ": expected a log of scans; maps from ROS grid maps are not supported by this version");
  }
}

double keypoints_per_scan(const PlaceMap& map) {
  return map.size() == 0 ? 0.0 : static_cast<double>(map.feature_count()) / static_cast<double>(map.size());
}

nlohmann::ordered_json map_json(const Options& options, const PlaceMap& map, const LogReport& report) {
  nlohmann::ordered_json json{{"log", options.log},
                              {"map", options.out},
                              {"poses", to_string(report.poses)},
                              {"every", options.every},
                              {"map_scans", map.size()},
                              {"features", map.feature_count()},
                              {"features_per_scan", keypoints_per_scan(map)},
                              {"bytes", map.bytes()},
                              {"feature_params", json_from_feature_params(map.feature_params())}};
  json.update(provenance());
  return json;
}

int run(Options& options, const Session& session) {
  refuse_grid_maps(options.log);
  options.params.resolve(session.config);
  LoadedLog loaded = value_or_quit(read_log(options.log, {}, progress_bar(session, "reading")));
  if (loaded.log.map_from_robot.empty()) {
    throw BadInput(options.log + ": expected a log with poses, found none (flirt slam finds them)");
  }
  const Result<PlaceMap> map = build_place_map(
      thinned(std::move(loaded.log), options.every), options.features.features(), session.threads,
      progress_bar(session, "features"), options.variances ? MapVariances::keep : MapVariances::leave_out);
  if (!map) { throw BadInput(options.log + ": " + map.error().message); }
  value_or_quit(write_place_map(options.out, *map));
  write_json(session, map_json(options, *map, loaded.report));
  if (session.talks()) {
    fmt::print("{}: {} scans with {:.1f} keypoints each, {:.1f} MB\n", options.out, map->size(),
               keypoints_per_scan(*map), static_cast<double>(map->bytes()) / 1e6);
    if (loaded.report.poses == PoseSource::odometry) {
      fmt::print("the poses of this log are raw odometry: the map is as wrong as they are\n");
    }
  }
  return exit_done;
}

}  // namespace

void add_map(CLI::App& program, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(program, session, "map", "Make a place map from a log with poses.",
                                  "flirt map fr079.log.gz -o fr079.flirt");
  command->add_option("LOG", options->log, "log with corrected poses")->required();
  command->add_option("-o,--output", options->out, "map file to write")->required();
  command->add_option("--every", options->every, "keep every K-th scan (default 1)")->check(CLI::Range(1, 1000000));
  command->add_flag("--variances", options->variances,
                    "keep the variances of descriptors, for the distance variance-chi-square");
  options->features.add(*command, options->params);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
