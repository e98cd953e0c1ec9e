// apps/flirt/bench_slam.cpp: `flirt bench slam`, every way to map beside every other, on logs and in simulation.
#include "flirt/io/file.hpp"
#include "flirt/io/tum.hpp"
#include "flirt/report/html.hpp"

#include "apps/flirt/bench_slam_dynamic.hpp"
#include "apps/flirt/bench_slam_run.hpp"
#include "apps/flirt/bench_slam_tables.hpp"
#include "apps/flirt/command.hpp"
#include "apps/flirt/map_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace flirt::app {
namespace {

struct BenchSlamOptions {
  std::vector<std::string> logs;
  std::string out;
  std::vector<std::string> methods;
  std::size_t every{1};
  std::size_t starts{0};
  bool dynamic{false};
  std::vector<std::string> places{dynamic_places()};  ///< of --dynamic
  std::uint32_t window{20};
  std::size_t long_scans{0};
  SlamMethods params;
  ParamFlags flags;
};

/// All that a run of the bench found.
struct Results {
  std::vector<SlamTable> tables;
  std::vector<JitteredStarts> starts;
  std::vector<DynamicRun> dynamic;
  std::vector<LongRun> long_runs;  ///< one or none
};

/// A file's name tells what is in it: NAME-METHOD.tum, NAME-METHOD-no-odometry.tum.
std::string name_of(const SlamInput& input, const SlamRow& row) {
  const bool without = row.mapped && row.odometry == "none";
  return input.name + "-" + row.method + (without ? "-no-odometry" : "");
}

void write_trajectory(const std::filesystem::path& folder, const SlamInput& input, const SlamRow& row) {
  std::vector<StampedPose> poses;
  poses.reserve(row.map_from_robot.size());
  for (std::size_t i = 0; i < row.map_from_robot.size(); ++i) {
    poses.push_back({input.log.scans[i].stamp, row.map_from_robot[i]});
  }
  value_or_quit(write_tum(folder / (name_of(input, row) + ".tum"), poses));
}

SlamTable run_log(const BenchSlamOptions& options, SlamInput input, const std::filesystem::path& folder,
                  const Session& session) {
  SlamTable table{.input = std::move(input), .rows = {}};
  table.rows = rows_of_log(table.input, session);
  std::vector<OdometryUse> uses{OdometryUse::ignore};
  if (table.input.has_odometry()) { uses.insert(uses.begin(), OdometryUse::use); }
  for (const OdometryUse use : uses) {
    for (const std::string& method : options.methods) {
      table.rows.push_back(run_method(table.input, method, use, options.params, session));
      write_trajectory(folder, table.input, table.rows.back());
    }
  }
  return table;
}

std::vector<DynamicRun> run_crowds(const BenchSlamOptions& options, const Session& session) {
  if (!options.dynamic) { return {}; }
  SlamMethods params = options.params;
  params.slam.window = options.window;
  return run_dynamic(options.places, options.methods, params, session);
}

void print_section(const Session& session, const std::string& title, const TextTable& table) {
  if (!session.talks() || table.rows.empty()) { return; }
  fmt::print("{}\n{}\n", title, plain_text(table));
  std::fflush(stdout);
}

std::string log_title(const SlamInput& input) {
  return fmt::format("{}: {} scans, odometry {}", input.name, input.log.scans.size(), input.odometry);
}

constexpr const char* paper_title = "Table 2 of the navigation paper: relations, printed there and found here";
constexpr const char* starts_title = "Jittered starts, no odometry";
constexpr const char* dynamic_title = "Among people: no odometry, no closures, a sliding window";

Results run_all(const BenchSlamOptions& options, const std::filesystem::path& folder, const Session& session) {
  Results results;
  std::vector<SlamInput> inputs;
  inputs.reserve(options.logs.size());
  for (const std::string& text : options.logs) {
    SlamInput input = read_slam_input(text, session);
    if (std::ranges::find(inputs, input.name, &SlamInput::name) != inputs.end()) {  // names are those of files
      throw UsageError("--log: expected each name once, found '" + input.name + "' again");
    }
    inputs.push_back(std::move(input));
  }
  for (SlamInput& input : inputs) {
    thin(input, options.every);
    results.tables.push_back(run_log(options, std::move(input), folder, session));
    const SlamTable& table = results.tables.back();
    print_section(session, log_title(table.input), runs_table(table));
    if (options.starts == 0) { continue; }
    if (table.input.truth.empty()) {
      if (session.talks()) { fmt::print("{}: no jittered starts, which need a truth\n\n", table.input.name); }
      continue;
    }
    results.starts.push_back(run_starts(table.input, options.methods.front(), options.starts, options.params, session));
  }
  print_section(session, paper_title, paper_table(results.tables));
  print_section(session, starts_title, starts_table(results.starts));
  results.dynamic = run_crowds(options, session);
  print_section(session, dynamic_title, dynamic_table(results.dynamic));
  if (options.long_scans > 0) {
    results.long_runs.push_back(run_long(options.long_scans, options.params.slam, session));
    print_section(session, "A long run", long_table(results.long_runs.back()));
  }
  return results;
}

void add_table(HtmlReport& html, const std::string& title, const TextTable& table) {
  if (table.rows.empty()) { return; }
  html.heading(title);
  html.table(table.header, table.rows);
}

struct Picture {
  std::string name;  ///< of its file, without .svg
  std::string svg;
  std::string caption;
};

Picture picture_of(const SlamInput& input, const SlamRow& row) {
  const MapOverlay overlay{.way = row.map_from_robot, .closures = row.closure_lines};
  const std::string name = name_of(input, row);
  return {name, map_picture(map_of(input.log, row.map_from_robot, input.file), overlay), name};
}

/// The whole map, and where it ends: there the error of the whole way shows.
std::vector<Picture> pictures_of(const DynamicRun& run) {
  const std::string name = run.place + "-" + run.method;
  const GridMapImage map = map_of(run.log, run.map_from_robot, run.place);
  MapOverlay overlay{.way = run.map_from_robot, .true_way = run.log.map_from_robot};
  Picture whole{
      name, map_picture(map, overlay),
      fmt::format("{} by {}: {:.2f} m off at the end of {:.0f} m.", run.place, run.method, run.end_distance, run.way)};
  const Point2 end = run.log.map_from_robot.back().translation();
  overlay.bounds = svg::Bounds{end - Point2{9, 6}, end + Point2{9, 6}};
  return {
      std::move(whole),
      {name + "-end", map_picture(map, overlay), fmt::format("{} by {}: the end of the way.", run.place, run.method)}};
}

/// The page; each of its pictures is also a file of its own.
std::string report(const Results& results, const std::filesystem::path& folder) {
  HtmlReport html("flirt bench slam");
  html.paragraph(
      "ATE: root mean square after alignment. Relations: component by component, mean ± deviation, of those with both "
      "stamps. Point-line and cells: how sharp the map is, without any truth. Wrong: more than 0.5 m or 10° off.");
  for (const SlamTable& table : results.tables) { add_table(html, log_title(table.input), runs_table(table)); }
  add_table(html, paper_title, paper_table(results.tables));
  add_table(html, starts_title, starts_table(results.starts));
  add_table(html, dynamic_title, dynamic_table(results.dynamic));
  for (const LongRun& run : results.long_runs) { add_table(html, "A long run", long_table(run)); }
  const auto add_picture = [&](const Picture& picture) {
    html.figure(picture.svg, picture.caption);
    value_or_quit(write_file_atomically(folder / (picture.name + ".svg"), picture.svg));
  };
  for (const SlamTable& table : results.tables) {
    html.heading("Maps of " + table.input.name);
    for (const SlamRow& row : table.rows) { add_picture(picture_of(table.input, row)); }
  }
  if (!results.dynamic.empty()) { html.heading("Maps among people"); }
  for (const DynamicRun& run : results.dynamic) {
    for (const Picture& picture : pictures_of(run)) { add_picture(picture); }
  }
  return html.text();
}

nlohmann::ordered_json json_of(const BenchSlamOptions& options, const Results& results, const Session& session) {
  nlohmann::ordered_json json{{"logs", runs_json(results.tables)},
                              {"starts", starts_json(results.starts)},
                              {"dynamic", dynamic_json(results.dynamic)},
                              {"long_run", nullptr},
                              {"every", options.every},
                              {"window", options.window},
                              {"params", options.flags.json()},
                              {"seed", session.seed}};
  for (const LongRun& run : results.long_runs) { json["long_run"] = long_json(run); }
  json.update(provenance());
  return json;
}

int run(BenchSlamOptions& options, const Session& session) {
  options.flags.resolve(session);
  if (options.logs.empty() && !options.dynamic && options.long_scans == 0) {
    throw UsageError("bench slam: expected --log, --dynamic or --long, found none of them");
  }
  const std::filesystem::path folder = value_or_quit(folder_for_results(options.out));
  const Results results = run_all(options, folder, session);
  const nlohmann::ordered_json json = json_of(options, results, session);
  value_or_quit(write_file_atomically(folder / "runs.csv", runs_csv(results.tables)));
  value_or_quit(write_file_atomically(folder / "summary.json", json_text(json)));
  value_or_quit(write_file_atomically(folder / "report.html", report(results, folder)));
  write_json(session, json);
  return exit_done;
}

}  // namespace

void add_bench_slam(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchSlamOptions>();
  options->methods = slam_methods();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("--log", options->logs,
                       "NAME=FILE[,truth=FILE][,relations=FILE][,odometry=own|synthetic|none][,bound=M]; repeatable");
    command.add_option("-o,--output", options->out, "folder for the results")->required();
    command
        .add_option("--methods", options->methods,
                    "front ends and rbpf, the first one also for --starts (default: all)")
        ->delimiter(',')
        ->check(CLI::IsMember(slam_methods()));
    command.add_option("--every", options->every, "use every K-th scan (default 1)")->check(CLI::Range(1, 1000000));
    command.add_option("--starts", options->starts, "runs without odometry from as many jittered first poses")
        ->check(CLI::Range(0, 100000));
    command.add_flag("--dynamic", options->dynamic, "incremental mapping of a simulated station among people");
    command.add_option("--places", options->places, "of --dynamic: tunnel, station (default: both)")
        ->delimiter(',')
        ->check(CLI::IsMember(dynamic_places()));
    command.add_option("--window", options->window, "scans of the sliding window of --dynamic (default 20)")
        ->check(CLI::Range(1U, 1000000U));
    command.add_option("--long", options->long_scans, "scans of a simulated run: latency and memory")
        ->check(CLI::Range(0, 10000000));
    options->flags.add(command, "slam", options->params.slam);
    options->flags.add(command, "rbpf", options->params.rbpf);
  };
  CLI::App* command = add_command(
      bench, session, "slam", "Every way to map beside every other: errors, sharpness, closures, time, memory.",
      "flirt bench slam --log intel=intel-910-merged.log.gz,relations=intel.relations --dynamic -o slam-bench",
      add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
