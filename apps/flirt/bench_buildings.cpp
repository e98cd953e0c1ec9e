// apps/flirt/bench_buildings.cpp: `flirt bench buildings`, single scans found in buildings with exact truth.
#include "flirt/eval/buildings.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/floor_plan.hpp"
#include "flirt/io/ros_map.hpp"
#include "flirt/map/grid_place_map.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/sim/free_space.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/localize_flags.hpp"
#include "apps/flirt/localize_report.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace flirt::app {
namespace {

struct BenchBuildingsOptions {
  std::vector<std::string> maps;  ///< YAML files of grid maps; none: offices
  std::vector<std::uint64_t> office_seeds{1};
  std::vector<double> fields_of_view{180, 270, 360};  ///< degrees
  std::vector<double> people{0, 10, 20, 30};          ///< per cent of the beams
  std::vector<double> changed{0};                     ///< per cent of the offices' furniture and doors
  std::size_t queries{100};
  std::string out;
  OfficeParams office{.area = 1200};
  LidarParams lidar;
  LocalizeFlags localize;
  ParamFlags params;
};

/// What a building looks like when it is asked, and places to ask from.
struct Visit {
  double changed{0};  ///< share of the furniture and doors
  FloorPlan plan;
  std::vector<Pose2> map_from_sensor;
};

/// A building, its map by one lidar, and visits.
struct Building {
  std::string name;
  PlaceMap map;
  std::vector<Visit> visits;
};

struct Row {
  std::string building;
  double field_of_view{0};
  double changed{0};
  BuildingBench bench;
};

/// Two rounds through an office.
Simulation drive_through(const OfficeParams& office, const LidarParams& lidar, const Session& session) {
  const SimulateParams params{
      .lidar = lidar, .drive = {.place_share = 1}, .seed = session.seed + office.seed, .threads = session.threads};
  return value_or_quit(simulate(make_office(office), params));
}

/// Scans of the second round, evenly picked, from within a metre of places of the first round of `mapping`.
std::vector<Pose2> places_to_ask(const Simulation& simulation, const Simulation& mapping, std::size_t most) {
  constexpr double near = 1;  // m; opened doors lead to rooms that the map does not know
  const auto was_mapped = [&](const Pose2& pose) {
    const auto begin = mapping.log.map_from_robot.begin();
    return std::any_of(begin, begin + static_cast<std::ptrdiff_t>(mapping.round_begin[1]),
                       [&](const Pose2& other) { return distance(pose, other) < near; });
  };
  std::vector<std::size_t> known;
  for (std::size_t i = simulation.round_begin[1]; i < simulation.log.scans.size(); ++i) {
    if (&simulation == &mapping || was_mapped(simulation.log.map_from_robot[i])) { known.push_back(i); }
  }
  std::vector<Pose2> places;
  const std::size_t count = std::min(most, known.size());
  places.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    places.push_back(simulation.log.map_from_sensor(known[k * known.size() / count]));
  }
  return places;
}

/// The first round makes the map, places of the second are asked; of what has changed since another drive's second.
Building office_of(const BenchBuildingsOptions& options, const LidarParams& lidar, std::uint64_t seed,
                   const Session& session) {
  OfficeParams office = options.office;
  office.seed = seed;
  office.changed = 0;
  const Simulation mapping = drive_through(office, lidar, session);
  ScanLog first;
  const auto second = static_cast<std::ptrdiff_t>(mapping.round_begin[1]);
  first.scans.assign(mapping.log.scans.begin(), mapping.log.scans.begin() + second);
  first.map_from_robot.assign(mapping.log.map_from_robot.begin(), mapping.log.map_from_robot.begin() + second);
  Building building{fmt::format("office {}", seed), value_or_quit(build_place_map(first, {}, session.threads)), {}};
  for (const double per_cent : options.changed) {
    if (per_cent == 0) {
      building.visits.push_back({0, mapping.plan, places_to_ask(mapping, mapping, options.queries)});
      continue;
    }
    office.changed = per_cent / 100;
    const Simulation later = drive_through(office, lidar, session);
    building.visits.push_back({office.changed, later.plan, places_to_ask(later, mapping, options.queries)});
  }
  return building;
}

/// Asked from all over its free space, in any direction.
Building grid_map_of(const BenchBuildingsOptions& options, const std::string& path, const Session& session) {
  constexpr double robot_radius = 0.3;  // m
  constexpr double spacing = 0.5;       // m
  const GridMapImage grid = value_or_quit(read_grid_map(path));
  Visit visit{0, plan_from_image(grid.image, grid.metadata), {}};
  const FreeSpace space(visit.plan, robot_radius);
  Rng rng(session.seed);
  for (const Point2& place : space.spread(spacing, session.seed)) {
    if (visit.map_from_sensor.size() == options.queries) { break; }
    visit.map_from_sensor.push_back({place.x, place.y, rng.uniform(-std::numbers::pi, std::numbers::pi)});
  }
  return {std::filesystem::path(path).stem().string(),
          value_or_quit(place_map_from_grid(grid.image, grid.metadata, {}, {}, session.threads), path),
          {std::move(visit)}};
}

void run_building(const BenchBuildingsOptions& options, const Building& building, const LidarParams& lidar,
                  const Session& session, std::vector<Row>& rows) {
  const double field_of_view = degrees_from_radians(lidar.field_of_view);
  for (const Visit& visit : building.visits) {
    for (const double people : options.people) {
      const BuildingBenchParams params{
          .people = people / 100, .localize = options.localize.localize(), .seed = session.seed};
      const std::string label = fmt::format("{}, {:.0f}°", building.name, field_of_view);
      rows.push_back({building.name, field_of_view, visit.changed,
                      bench_building(visit.plan, building.map, lidar, visit.map_from_sensor, params, session.threads,
                                     progress_bar(session, label))});
    }
  }
}

/// Scans that one place alone explains and that were not found, to look at.
void write_failures(const std::filesystem::path& out, const Building& building, const std::vector<Row>& rows,
                    std::size_t first_row) {
  constexpr std::size_t most = 4;
  const std::vector<Point2> points = map_points(building.map);
  for (std::size_t i = first_row; i < rows.size(); ++i) {
    std::size_t written = 0;
    for (const BuildingAnswer& answer : rows[i].bench.answers) {
      if (!answer.is_unique || answer.is_right || written == most) { continue; }
      const std::string name = fmt::format("failure-{}-{}.svg", i, written++);
      const std::string title = fmt::format(
          "{}, {:.0f}°, {:.0f} % changed, {:.0f} % people: {}, confidence {:.2f}", building.name, rows[i].field_of_view,
          100 * rows[i].changed, 100 * rows[i].bench.people, to_string(answer.result.reason), answer.result.confidence);
      value_or_quit(write_file_atomically(out / name, localization_picture(points, answer.query.scan, answer.result,
                                                                           answer.query.map_from_sensor, title)));
    }
  }
}

nlohmann::ordered_json rate_json(const Rate& rate) {
  const Interval wilson = rate.wilson();
  return {{"right", rate.hits}, {"of", rate.total}, {"rate", rate.value()}, {"wilson", {wilson.low, wilson.high}}};
}

nlohmann::ordered_json buildings_json(const BenchBuildingsOptions& options, const std::vector<Row>& rows,
                                      const Session& session) {
  nlohmann::ordered_json json{{"buildings", nlohmann::ordered_json::array()}};
  for (const Row& row : rows) {
    json["buildings"].push_back({{"building", row.building},
                                 {"field_of_view_deg", row.field_of_view},
                                 {"changed", row.changed},
                                 {"people", row.bench.people},
                                 {"success", rate_json(row.bench.success)},
                                 {"twins", rate_json(row.bench.twins_right)},
                                 {"called_unique", rate_json(row.bench.called_unique)},
                                 {"unique_right", rate_json(row.bench.unique_right)}});
  }
  json["params"] = options.params.json();
  json["seed"] = session.seed;
  json.update(provenance());
  return json;
}

std::string rate_text(const Rate& rate) {
  const Interval wilson = rate.wilson();
  return fmt::format("{:>4}/{:<4} {:.3f} [{:.3f}, {:.3f}]", rate.hits, rate.total, rate.value(), wilson.low,
                     wilson.high);
}

void add(Rate& sum, const Rate& rate) {
  sum.hits += rate.hits;
  sum.total += rate.total;
}

void print(const std::vector<Row>& rows) {
  fmt::print("{:<22} {:>5} {:>7} {:>7}  {:<33} {:<33} {:<33} {}\n", "building", "view", "changed", "people",
             "success where unique", "right where twins exist", "called unique where unique",
             "right of those called unique");
  BuildingBench all;
  for (const Row& row : rows) {
    fmt::print("{:<22} {:>4.0f}° {:>6.0f}% {:>6.1f}%  {:<33} {:<33} {:<33} {}\n", row.building, row.field_of_view,
               100 * row.changed, 100 * row.bench.people, rate_text(row.bench.success),
               rate_text(row.bench.twins_right), rate_text(row.bench.called_unique), rate_text(row.bench.unique_right));
    add(all.success, row.bench.success);
    add(all.twins_right, row.bench.twins_right);
    add(all.called_unique, row.bench.called_unique);
    add(all.unique_right, row.bench.unique_right);
  }
  fmt::print("{:<22} {:>5} {:>7} {:>7}  {:<33} {:<33} {:<33} {}\n", "all", "", "", "", rate_text(all.success),
             rate_text(all.twins_right), rate_text(all.called_unique), rate_text(all.unique_right));
}

int run(BenchBuildingsOptions& options, const Session& session) {
  options.params.resolve(session, {"ransac"});
  if (!options.maps.empty() && options.changed != std::vector<double>{0}) {
    throw UsageError("--changed: expected only with made-up offices");
  }
  std::filesystem::path out;
  if (!options.out.empty()) { out = value_or_quit(folder_for_results(options.out)); }
  std::vector<Row> rows;
  const auto ask = [&](const Building& building, const LidarParams& lidar) {
    const std::size_t first_row = rows.size();
    run_building(options, building, lidar, session, rows);
    if (!out.empty()) { write_failures(out, building, rows, first_row); }
  };
  std::vector<LidarParams> lidars;
  for (const double degrees : options.fields_of_view) {
    lidars.push_back(options.lidar);
    lidars.back().field_of_view = std::min(radians_from_degrees(degrees), 2 * std::numbers::pi);
  }
  for (const std::string& path : options.maps) {
    const Building building = grid_map_of(options, path, session);
    for (const LidarParams& lidar : lidars) { ask(building, lidar); }
  }
  if (options.maps.empty()) {
    for (const std::uint64_t seed : options.office_seeds) {
      for (const LidarParams& lidar : lidars) { ask(office_of(options, lidar, seed, session), lidar); }
    }
  }
  const nlohmann::ordered_json json = buildings_json(options, rows, session);
  if (!out.empty()) { value_or_quit(write_file_atomically(out / "buildings.json", json_text(json))); }
  write_json(session, json);
  if (session.talks()) { print(rows); }
  return exit_done;
}

}  // namespace

void add_bench_buildings(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchBuildingsOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("MAPS", options->maps, "YAML files of grid maps (default: made-up offices)");
    command.add_option("--office-seeds", options->office_seeds, "offices to make up (default 1)")->delimiter(',');
    command.add_option("--fields-of-view", options->fields_of_view, "of the scanners, degrees (default 180,270,360)")
        ->delimiter(',')
        ->check(CLI::Range(10.0, 360.0));
    command.add_option("--people", options->people, "per cent of the beams that end on people (default 0,10,20,30)")
        ->delimiter(',')
        ->check(CLI::Range(0.0, 90.0));
    command
        .add_option("--changed", options->changed,
                    "per cent of an office's furniture and doors moved since the map was made (default 0)")
        ->delimiter(',')
        ->check(CLI::Range(0.0, 100.0));
    command.add_option("--queries", options->queries, "scans asked in each row (default 100)")
        ->check(CLI::Range(1, 1000000));
    command.add_option("-o,--output", options->out, "folder for buildings.json and pictures of what was not found");
    options->params.add(command, "office", options->office, {"seed", "changed"});
    options->params.add(command, "lidar", options->lidar, {"field_of_view"});
    options->localize.add(command, options->params);
  };
  CLI::App* command = add_command(bench, session, "buildings",
                                  "Find single scans in buildings with exact truth, with people in the way.",
                                  "flirt bench buildings --office-seeds 1,2 --people 0,30 -o results", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
