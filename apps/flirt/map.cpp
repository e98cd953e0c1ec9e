// apps/flirt/map.cpp: `flirt map`, a place map from a log with poses or from a grid map.
#include "flirt/io/feature_params_json.hpp"
#include "flirt/io/flirt_map.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/ros_map.hpp"
#include "flirt/map/grid_place_map.hpp"
#include "flirt/map/place_map.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/feature_flags.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace flirt::app {
namespace {

struct Options {
  std::string log;  ///< or a grid map's YAML file
  std::string out;
  std::size_t every{1};
  bool variances{false};
  FeatureFlags features;
  GridPlaceMapParams grid;
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

bool is_grid_map(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  return extension == ".yaml" || extension == ".yml";
}

double keypoints_per_scan(const PlaceMap& map) {
  return map.size() == 0 ? 0.0 : static_cast<double>(map.feature_count()) / static_cast<double>(map.size());
}

nlohmann::ordered_json map_json(const Options& options, const PlaceMap& map, std::string_view poses) {
  nlohmann::ordered_json json{{"log", options.log},
                              {"map", options.out},
                              {"poses", poses},
                              {"every", options.every},
                              {"map_scans", map.size()},
                              {"features", map.feature_count()},
                              {"features_per_scan", keypoints_per_scan(map)},
                              {"bytes", map.bytes()},
                              {"feature_params", json_from_feature_params(map.feature_params())}};
  json.update(provenance());
  return json;
}

PlaceMap map_of_grid(const Options& options) {
  const GridMapImage grid = value_or_quit(read_grid_map(options.log));
  Result<PlaceMap> map = place_map_from_grid(grid.image, grid.metadata, options.grid, options.features.features());
  if (!map) { throw BadInput(options.log + ": " + map.error().message); }
  return *std::move(map);
}

PlaceMap map_of_log(const Options& options, LoadedLog loaded, const Session& session) {
  if (loaded.log.map_from_robot.empty()) {
    throw BadInput(options.log + ": expected a log with poses, found none (flirt slam finds them)");
  }
  Result<PlaceMap> map = build_place_map(thinned(std::move(loaded.log), options.every), options.features.features(),
                                         session.threads, progress_bar(session, "features"),
                                         options.variances ? MapVariances::keep : MapVariances::leave_out);
  if (!map) { throw BadInput(options.log + ": " + map.error().message); }
  return *std::move(map);
}

void finish(const Options& options, const Session& session, const PlaceMap& map, std::string_view poses) {
  value_or_quit(write_place_map(options.out, map));
  write_json(session, map_json(options, map, poses));
  if (!session.talks()) { return; }
  fmt::print("{}: {} scans with {:.1f} keypoints each, {:.1f} MB\n", options.out, map.size(), keypoints_per_scan(map),
             static_cast<double>(map.bytes()) / 1e6);
  if (poses == to_string(PoseSource::odometry)) {
    fmt::print("the poses of this log are raw odometry: the map is as wrong as they are\n");
  }
}

int run(Options& options, const Session& session) {
  options.params.resolve(session.config);
  if (is_grid_map(options.log)) {
    if (options.every != 1 || options.variances) {
      throw UsageError("--every and --variances: expected a log with them, found a grid map");
    }
    finish(options, session, map_of_grid(options), "grid_map");
    return exit_done;
  }
  LoadedLog loaded = value_or_quit(read_log(options.log, {}, progress_bar(session, "reading")));
  const std::string_view poses = to_string(loaded.report.poses);
  finish(options, session, map_of_log(options, std::move(loaded), session), poses);
  return exit_done;
}

}  // namespace

void add_map(CLI::App& program, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(program, session, "map", "Make a place map from a log with poses, or from a ROS grid map (MAP.yaml).",
                  "flirt map fr079.log.gz -o fr079.flirt");
  command->add_option("LOG", options->log, "log with corrected poses, or the YAML file of a ROS grid map")->required();
  command->add_option("-o,--output", options->out, "map file to write")->required();
  command->add_option("--every", options->every, "keep every K-th scan (default 1)")->check(CLI::Range(1, 1000000));
  command->add_flag("--variances", options->variances,
                    "keep the variances of descriptors, for the distance variance-chi-square");
  options->features.add(*command, options->params);
  options->params.add(*command, "grid", options->grid);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
