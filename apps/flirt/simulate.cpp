// apps/flirt/simulate.cpp: `flirt simulate`, a log with exact truth from a floor plan.
#include "flirt/sim/simulate.hpp"

#include "flirt/io/carmen.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/floor_plan.hpp"
#include "flirt/io/svg.hpp"
#include "flirt/io/tum.hpp"
#include "flirt/sim/corridors.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/station.hpp"
#include "flirt/sim/warehouse.hpp"

#include "apps/flirt/command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <concepts>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

namespace flirt::app {
namespace {

enum class LogPoses : std::uint8_t { odometry, truth, both };
constexpr auto enum_names(LogPoses) {
  using enum LogPoses;
  return std::array<std::pair<LogPoses, std::string_view>, 3>{
      {{odometry, "odometry"}, {truth, "truth"}, {both, "both"}}};
}

struct OutputParams {
  LogPoses poses{LogPoses::odometry};
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, OutputParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.poses, Field{"poses", "", "that the log states: what a robot's log would, or the truth"});
}

struct SimulateOptions {
  std::string out;
  std::string truth;
  std::string plan{"office"};
  std::optional<double> resolution;
  std::optional<std::uint32_t> people;
  std::optional<std::uint32_t> rounds;
  std::string svg;
  std::optional<std::size_t> svg_scan;
  OfficeParams office;
  CorridorParams corridors;
  TunnelParams tunnel;
  StationParams station;
  WarehouseParams warehouse;
  SimulateParams simulate;
  OutputParams output;
  ParamFlags params;
};

constexpr std::array<std::string_view, 5> made_up_plans{"office", "corridors", "tunnel", "station", "warehouse"};

World world_of(const SimulateOptions& options) {
  for (const std::string_view plan : made_up_plans) {
    if (options.plan != plan) { options.params.expect_none(plan, "--plan " + std::string(plan)); }
  }
  const bool made_up = std::ranges::find(made_up_plans, options.plan) != made_up_plans.end();
  if (made_up && options.resolution) { throw UsageError("--resolution: expected only with an image as --plan"); }
  if (options.plan == "office") { return make_office(options.office); }
  if (options.plan == "corridors") { return make_corridors(options.corridors); }
  if (options.plan == "tunnel") { return make_tunnel(options.tunnel); }
  if (options.plan == "station") { return make_station(options.station); }
  if (options.plan == "warehouse") { return make_warehouse(options.warehouse); }
  return {value_or_quit(read_floor_plan(options.plan, options.resolution)), {}, {}};
}

/// The log as it is written: the truth stands in it only when asked for.
ScanLog log_to_write(const Simulation& simulation, LogPoses poses) {
  ScanLog log = simulation.log;
  if (poses == LogPoses::odometry) { log.map_from_robot.clear(); }
  if (poses == LogPoses::truth) {
    for (Scan& scan : log.scans) { scan.odom_from_robot.reset(); }
  }
  return log;
}

std::vector<StampedPose> truth_of(const ScanLog& log) {
  std::vector<StampedPose> trajectory;
  trajectory.reserve(log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    trajectory.push_back({log.scans[i].stamp, log.map_from_robot[i]});
  }
  return trajectory;
}

GreyImage grey_image(const PixelPlan& image) {
  GreyImage grey{image.columns, image.rows, {}};
  for (std::size_t row = image.rows; row-- > 0;) {
    for (std::size_t column = 0; column < image.columns; ++column) {
      const CellState state = image.pixels[row * image.columns + column];
      grey.pixels.push_back(state == CellState::occupied ? 0 : state == CellState::free ? 255 : 205);
    }
  }
  return grey;
}

void add_plan(const FloorPlan& plan, svg::Plan& figure) {
  if (!plan.image.pixels.empty()) {
    figure.layers.emplace_back(
        svg::Raster{grey_image(plan.image), plan.image.map_from_image, plan.image.resolution, 1.0});
  }
  svg::Polylines solid{.colour = svg::black, .width = 0.8};
  svg::Polylines glass{.colour = svg::purple, .width = 3, .legend = "glass"};
  for (const PlanSegment& segment : plan.segments) {
    (segment.material == Material::glass ? glass : solid).lines.push_back({segment.begin, segment.end});
  }
  svg::Circles discs{.colour = svg::black, .width = 0.8};
  for (const PlanDisc& disc : plan.discs) { discs.circles.push_back({disc.center, disc.radius}); }
  figure.layers.emplace_back(std::move(solid));
  if (!glass.lines.empty()) { figure.layers.emplace_back(std::move(glass)); }
  figure.layers.emplace_back(std::move(discs));
}

/// Plan and way of each round; with --svg-scan one scan within its surroundings.
svg::Figure picture(const SimulateOptions& options, const Simulation& simulation) {
  svg::Plan figure;
  add_plan(simulation.plan, figure);
  const ScanLog& log = simulation.log;
  for (std::size_t round = 0; round < simulation.round_begin.size(); ++round) {
    const std::size_t end =
        round + 1 < simulation.round_begin.size() ? simulation.round_begin[round + 1] : log.scans.size();
    svg::Polylines way{.lines = {{}}, .colour = svg::series_style(round).colour, .width = 1};
    way.legend = fmt::format("round {}", round + 1);
    for (std::size_t i = simulation.round_begin[round]; i < end; ++i) {
      way.lines[0].push_back(log.map_from_robot[i].translation());
    }
    figure.layers.emplace_back(std::move(way));
  }
  if (options.svg_scan) {
    const std::size_t i = *options.svg_scan;
    if (i >= log.scans.size()) {
      throw UsageError(fmt::format("--svg-scan: expected less than {} scans, found {}", log.scans.size(), i));
    }
    svg::Points points{.colour = svg::vermilion, .radius = 2, .legend = fmt::format("scan {}", i)};
    for (const BeamPoint& hit : hit_points(log.scans[i])) { points.at.push_back(log.map_from_sensor(i) * hit.point); }
    figure.layers.emplace_back(std::move(points));
    figure.layers.emplace_back(svg::Robots{.map_from_robot = {log.map_from_robot[i]}});
    const Point2 center = log.map_from_robot[i].translation();
    figure.bounds = svg::Bounds{center - Point2{12, 9}, center + Point2{12, 9}};
  }
  return {.panels = {figure}, .panel_width = 1200};
}

/// Before the work: can all files be written, and is each a file of its own?
void check_outputs(const SimulateOptions& options) {
  std::vector<std::filesystem::path> seen;
  for (const std::string& file : {options.out, options.truth, options.svg}) {
    if (file.empty()) { continue; }
    value_or_quit(require_writable(file));
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (exists(status) && !is_regular_file(status)) { continue; }  // a device takes all
    seen.push_back(std::filesystem::weakly_canonical(file, error));
    if (std::ranges::count(seen, seen.back()) > 1) {
      throw UsageError(file + ": expected a file of its own for the log, the truth and the picture, found one for two");
    }
  }
}

int run(const Session& session, SimulateOptions& options) {
  options.params.resolve(session);
  if (options.truth.empty()) { options.truth = options.out + ".truth.tum"; }
  check_outputs(options);
  options.simulate.seed = session.seed;
  options.simulate.threads = session.threads;
  if (options.people) { options.simulate.people.count = *options.people; }
  if (options.rounds) { options.simulate.drive.rounds = *options.rounds; }
  const World world = world_of(options);
  const Progress bar = progress_bar(session, "simulate");
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> measuring_since;
  const Result<Simulation> simulated = simulate(world, options.simulate, [&](double done) {
    if (!measuring_since) { measuring_since = Clock::now(); }
    if (bar) { bar(done); }
  });
  if (!simulated) { throw BadInput(options.plan + ": " + simulated.error().message); }
  const Simulation& simulation = *simulated;
  const std::size_t scans = simulation.log.scans.size();
  const double seconds = std::chrono::duration<double>(Clock::now() - measuring_since.value_or(Clock::now())).count();
  const double scans_per_second = seconds > 0 ? static_cast<double>(scans) / seconds : 0.0;

  const std::string drawing = options.svg.empty() ? "" : svg::to_svg(picture(options, simulation));
  value_or_quit(write_carmen(options.out, log_to_write(simulation, options.output.poses)));
  value_or_quit(write_tum(options.truth, truth_of(simulation.log)));
  if (!options.svg.empty()) { value_or_quit(write_file_atomically(options.svg, drawing)); }
  if (session.talks()) {
    std::puts(fmt::format("{}: {} scans of {} beams in {} rounds, {:.0f} scans/s\n{}: the true poses", options.out,
                          scans, options.simulate.lidar.beams, simulation.round_begin.size(), scans_per_second,
                          options.truth)
                  .c_str());
  }
  nlohmann::ordered_json json{{"log", options.out},
                              {"truth", options.truth},
                              {"plan", options.plan},
                              {"scans", scans},
                              {"beams", options.simulate.lidar.beams},
                              {"round_begin", simulation.round_begin},
                              {"scans_per_second", scans_per_second},
                              {"params", options.params.json()},
                              {"seed", session.seed}};
  json.update(provenance());
  write_json(session, json);
  return exit_done;
}

}  // namespace

void add_simulate(CLI::App& program, Session& session) {
  auto options = std::make_shared<SimulateOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("-o,--output", options->out, "CARMEN log to write")->required();
    command.add_option("--truth", options->truth, "file for the true poses, TUM format (default: LOG.truth.tum)");
    command
        .add_option(
            "--plan", options->plan,
            "office, corridors, tunnel, station or warehouse (made up), or FILE.txt of segments x1,y1,x2,y2, or a grid "
            "map's FILE.yaml, or an image")
        ->capture_default_str();
    command.add_option("--resolution", options->resolution, "m per pixel of an image without YAML")
        ->check(CLI::Range(1e-6, 1000.0));
    CLI::Option* people =
        command.add_option("--people", options->people, "the same as --people-count")->check(CLI::Range(0U, 100000U));
    CLI::Option* rounds =
        command.add_option("--rounds", options->rounds, "the same as --drive-rounds")->check(CLI::Range(1U, 1000U));
    CLI::Option* svg = command.add_option("--svg", options->svg, "picture of the plan and the way");
    command.add_option("--svg-scan", options->svg_scan, "draw this scan, and the plan around it")->needs(svg);
    options->params.add(command, "office", options->office);
    options->params.add(command, "corridors", options->corridors);
    options->params.add(command, "tunnel", options->tunnel);
    options->params.add(command, "station", options->station);
    options->params.add(command, "warehouse", options->warehouse);
    options->params.add(command, "lidar", options->simulate.lidar);
    options->params.add(command, "drive", options->simulate.drive);
    options->params.add(command, "odometry", options->simulate.odometry);
    options->params.add(command, "people", options->simulate.people);
    options->params.add(command, "log", options->output);
    people->excludes(command.get_option("--people-count"));
    rounds->excludes(command.get_option("--drive-rounds"));
  };
  CLI::App* command =
      add_command(program, session, "simulate", "A log with exact truth from a floor plan.",
                  "flirt simulate -o office.log --office-area 5000 --people 20 --svg office.svg", add_options);
  session.on(command, [&session, options] { return run(session, *options); });
}

}  // namespace flirt::app
