// apps/flirt/map.cpp: `flirt map`, a place map from a log with poses or from a ROS grid map.
#include "flirt/io/feature_params_json.hpp"
#include "flirt/io/flirt_map.hpp"
#include "flirt/io/ros_map.hpp"
#include "flirt/map/grid_place_map.hpp"
#include "flirt/map/place_map.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/feature_flags.hpp"
#include "apps/flirt/posed_log.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace flirt::app {
namespace {

struct MapOptions {
  std::string log;  ///< or a grid map's YAML file
  std::string out;
  std::string poses;  ///< trajectory to take instead of the log's
  std::size_t every{1};
  bool variances{false};
  FeatureFlags features;
  GridPlaceMapParams grid;
  ParamFlags params;

  [[nodiscard]] MapVariances kept_variances() const { return variances ? MapVariances::keep : MapVariances::leave_out; }
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

bool is_grid_map(const MapOptions& options) {
  const std::string extension = std::filesystem::path(options.log).extension().string();
  if (extension == ".pgm" || extension == ".png") {
    throw UsageError(options.log + ": expected the YAML file of a grid map, found an image");
  }
  const bool is_yaml = extension == ".yaml" || extension == ".yml";
  if (is_yaml && options.every != 1) {
    throw UsageError("--every: expected only with a log, found a grid map (see --grid-spacing)");
  }
  if (is_yaml && !options.poses.empty()) { throw UsageError("--poses: expected only with a log, found a grid map"); }
  return is_yaml;
}

double keypoints_per_scan(const PlaceMap& map) {
  return map.size() == 0 ? 0.0 : static_cast<double>(map.feature_count()) / static_cast<double>(map.size());
}

nlohmann::ordered_json map_json(const MapOptions& options, const PlaceMap& map, std::string_view poses) {
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

/// Writes the map and says what is in it.
void finish(const MapOptions& options, const Session& session, const PlaceMap& map, std::string_view poses) {
  value_or_quit(write_place_map(options.out, map));
  write_json(session, map_json(options, map, poses));
  if (!session.talks()) { return; }
  fmt::print("{}: {} scans with {:.1f} keypoints each, {:.1f} MB\n", options.out, map.size(), keypoints_per_scan(map),
             static_cast<double>(map.bytes()) / 1e6);
}

void map_grid(const MapOptions& options, const Session& session) {
  const GridMapImage grid = value_or_quit(read_grid_map(options.log));
  const PlaceMap map =
      value_or_quit(place_map_from_grid(grid.image, grid.metadata, options.grid, options.features.features(),
                                        session.threads, progress_bar(session, "features"), options.kept_variances()),
                    options.log);
  finish(options, session, map, "virtual");
}

void map_log(const MapOptions& options, const Session& session) {
  LoadedLog loaded = read_posed_log(options.log, options.poses, session);
  const PlaceMap map =
      value_or_quit(build_place_map(thinned(std::move(loaded.log), options.every), options.features.features(),
                                    session.threads, progress_bar(session, "features"), options.kept_variances()),
                    options.log);
  finish(options, session, map, to_string(loaded.report.poses));
  if (session.talks() && loaded.report.poses == PoseSource::odometry) {
    fmt::print("the poses of this log are raw odometry: the map is as wrong as they are\n");
  }
}

int run(MapOptions& options, const Session& session) {
  const bool is_grid = is_grid_map(options);
  options.params.resolve(session);
  if (is_grid) {
    map_grid(options, session);
  } else {
    options.params.expect_none("grid", "a grid map");
    map_log(options, session);
  }
  return exit_done;
}

}  // namespace

void add_map(CLI::App& program, Session& session) {
  auto options = std::make_shared<MapOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("LOG", options->log, "log with corrected poses, or the .yaml file of a ROS grid map")
        ->required();
    command.add_option("-o,--output", options->out, "map file to write")->required();
    command.add_option("--poses", options->poses, poses_flag_help);
    command.add_option("--every", options->every, "keep every K-th scan (default 1)")->check(CLI::Range(1, 1000000));
    command.add_flag("--variances", options->variances,
                     "keep the variances of descriptors, for the distance variance-chi-square");
    options->features.add(command, options->params);
    options->params.add(command, "grid", options->grid);
  };
  CLI::App* command =
      add_command(program, session, "map", "Make a place map from a log with poses, or from a ROS grid map.",
                  "flirt map fr079.log.gz -o fr079.flirt (or: flirt map office.yaml -o office.flirt)", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
