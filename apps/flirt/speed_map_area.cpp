// apps/flirt/speed_map_area.cpp: localization of single scans in simulated offices from a floor to a whole campus.
#include "flirt/core/rng.hpp"
#include "flirt/eval/cpu_time.hpp"
#include "flirt/eval/statistics.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/sim/free_space.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/ray_caster.hpp"
#include "flirt/sim/simulate.hpp"

#include "apps/flirt/speed_section.hpp"

#include <array>
#include <numbers>
#include <string>
#include <utility>

namespace flirt::app {
namespace {

constexpr std::array methods{LocalizeMethod::dense, LocalizeMethod::features, LocalizeMethod::automatic};

struct Question {
  Scan scan;
  Pose2 map_from_sensor;
};

struct Building {
  World world;
  SimulateParams simulate;
  ScanLog log;
};

/// One drive through the building, a scan each metre: what a mapping run leaves after thinning.
Building building_of(double area, const Session& session) {
  Building building{.world = make_office({.area = area, .seed = session.seed + 1}), .simulate = {}, .log = {}};
  building.simulate.drive.rounds = 1;
  building.simulate.drive.scan_distance = 1.0;
  building.simulate.drive.scan_turn = 1.0;
  building.simulate.seed = session.seed;
  building.simulate.threads = session.threads;
  building.log = value_or_quit(simulate(building.world, building.simulate)).log;
  return building;
}

/// Scans from within half a metre of a mapped pose, in any direction: each can be answered.
std::vector<Question> questions_of(const Building& building, std::size_t count, const Session& session) {
  const RayCaster caster(building.world.plan);
  const FreeSpace space(building.world.plan, building.simulate.drive.robot_radius);
  const Lidar lidar(building.simulate.lidar);
  std::vector<Question> questions;
  for (Rng rng(session.seed, 99); questions.size() < count;) {
    const std::size_t near = rng.below(static_cast<std::uint32_t>(building.log.scans.size()));
    const Pose2 mapped = building.log.map_from_robot[near];
    const Pose2 map_from_robot{mapped.x + rng.uniform(-0.35, 0.35), mapped.y + rng.uniform(-0.35, 0.35),
                               rng.uniform(-std::numbers::pi, std::numbers::pi)};
    if (!space.contains(map_from_robot.translation())) { continue; }
    Question question{building.log.scans[near], map_from_robot * lidar.robot_from_sensor()};
    question.scan.ranges = lidar.measure(caster, {}, question.map_from_sensor, rng);
    questions.push_back(std::move(question));
  }
  return questions;
}

double seen_area(const EvidenceGrid& grid) {
  std::size_t seen = 0;
  grid.for_each_tile([&](CellIndex, std::span<const EvidenceCell> cells) {
    for (const EvidenceCell& cell : cells) { seen += cell.seen() ? 1 : 0; }
  });
  return static_cast<double>(seen) * grid.params().cell_size * grid.params().cell_size;
}

/// What building takes: columns that all methods share.
nlohmann::ordered_json map_columns(double area, const PlaceMap& map) {
  constexpr double megabyte = 1e6;
  double start = process_cpu_us();
  const MapFields fields = map_fields(map.evidence());
  const double fields_us = process_cpu_us() - start;
  start = process_cpu_us();
  const Landmarks landmarks(map, {});
  const double landmarks_us = process_cpu_us() - start;
  return {{"floor_m2", area},
          {"seen_m2", seen_area(map.evidence())},
          {"map_scans", map.size()},
          {"evidence_mb", static_cast<double>(map.evidence().bytes()) / megabyte},
          {"fields_mb", static_cast<double>(fields.bytes()) / megabyte},
          {"landmarks_mb", static_cast<double>(landmarks.bytes()) / megabyte},
          {"landmarks", landmarks.size()},
          {"fields_s", fields_us * 1e-6},
          {"landmarks_s", landmarks_us * 1e-6}};
}

void add_answers(nlohmann::ordered_json& row, const PlaceMap& map, std::span<const Question> questions,
                 LocalizeMethod method) {
  Localizer localizer(map, {.method = method});
  (void)localizer.localize(questions.front().scan);  // makes fields and landmarks
  std::vector<double> times_ms;
  Rate right;
  Rate unique_right;
  for (const Question& question : questions) {
    const double start = process_cpu_us();
    const LocalizationResult result = localizer.localize(question.scan);
    times_ms.push_back((process_cpu_us() - start) * 1e-3);
    const PoseHypothesis* const best = result.best();
    const bool is_right =
        best != nullptr && distance(best->map_from_sensor, question.map_from_sensor) <= 0.5 &&
        heading_difference(best->map_from_sensor, question.map_from_sensor) <= radians_from_degrees(10);
    const bool is_unique = result.verdict == Verdict::unique;
    right = {right.hits + (is_right ? 1 : 0), right.total + 1};
    unique_right = {unique_right.hits + (is_right && is_unique ? 1 : 0), unique_right.total + (is_unique ? 1 : 0)};
  }
  row["method"] = std::string(to_string(method));
  row["query_ms_median"] = quantile(times_ms, 0.5);
  row["query_ms_p95"] = quantile(times_ms, 0.95);
  row["success"] = right.value();
  row["unique"] = static_cast<double>(unique_right.total) / static_cast<double>(questions.size());
  row["unique_right"] = unique_right.value();
}

svg::Figure growth_with_area(const nlohmann::ordered_json& rows) {
  svg::Chart time{.title = "Time of a query",
                  .x = {.label = "seen area (m²)", .scale = svg::AxisScale::logarithmic},
                  .y = {.label = "median (ms)", .scale = svg::AxisScale::logarithmic}};
  svg::Chart success{.title = "Right answers",
                     .x = {.label = "seen area (m²)", .scale = svg::AxisScale::logarithmic},
                     .y = {.label = "share", .low = 0.0, .high = 1.0}};
  for (std::size_t i = 0; i < methods.size(); ++i) {
    svg::Series times{.legend = std::string(to_string(methods[i])), .style = svg::series_style(i)};
    svg::Series shares = times;
    for (const auto& row : rows) {
      if (row["method"] != times.legend) { continue; }
      times.x.push_back(row["seen_m2"]);
      times.y.push_back(row["query_ms_median"]);
      shares.x.push_back(row["seen_m2"]);
      shares.y.push_back(row["success"]);
    }
    time.series.push_back(times);
    success.series.push_back(shares);
  }
  return {.panels = {time, success}};
}

}  // namespace

SpeedSection speed_map_area(const SpeedOptions& options, const Session& session) {
  SpeedSection section;
  for (const double area : options.areas) {
    const Building building = building_of(area, session);
    const PlaceMap map = value_or_quit(build_place_map(building.log, {}, session.threads));
    const std::vector<Question> questions = questions_of(building, options.queries, session);
    const nlohmann::ordered_json columns = map_columns(area, map);
    for (const LocalizeMethod method : methods) {
      nlohmann::ordered_json row = columns;
      add_answers(row, map, questions, method);
      section.rows.push_back(row);
    }
  }
  section.figure = growth_with_area(section.rows);
  return section;
}

}  // namespace flirt::app
