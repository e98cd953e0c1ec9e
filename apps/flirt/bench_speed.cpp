// apps/flirt/bench_speed.cpp: `flirt bench speed`, how long things take and how that grows.
#include "flirt/io/file.hpp"
#include "flirt/io/svg.hpp"
#include "flirt/report/html.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/speed_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace flirt::app {
namespace {

struct Experiment {
  std::string_view name;
  SpeedSection (*run)(const SpeedOptions&, const Session&);
};
constexpr std::array experiments{Experiment{"stages", speed_stages}, Experiment{"map-size", speed_map_size},
                                 Experiment{"map-area", speed_map_area}};

struct BenchSpeedOptions {
  std::string out;
  std::vector<std::string> sections{"all"};
  SpeedOptions speed;
};

std::string cell_text(const nlohmann::ordered_json& value) {
  return value.is_null()           ? ""
         : value.is_string()       ? value.get<std::string>()
         : value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
                                   : value.dump();
}

std::string csv_of(const nlohmann::ordered_json& rows) {
  std::string csv;
  for (const auto& row : rows) {
    std::string head;
    std::string line;
    for (const auto& [key, value] : row.items()) {
      head += head.empty() ? "" : ",";
      head += key;
      line += line.empty() ? "" : ",";
      line += cell_text(value);
    }
    csv += csv.empty() ? head.append("\n") : "";
    csv += line.append("\n");
  }
  return csv;
}

/// The rows as a table, the same drawn.
void add_section(HtmlReport& page, std::string_view name, const SpeedSection& section) {
  page.heading("Speed: " + std::string(name));
  std::vector<std::string> header;
  for (const auto& [key, value] : section.rows.front().items()) { header.push_back(key); }
  std::vector<std::vector<std::string>> rows;
  for (const auto& row : section.rows) {
    std::vector<std::string>& cells = rows.emplace_back();
    for (const auto& value : row) { cells.push_back(cell_text(value)); }
  }
  page.table(header, rows);
  page.figure(svg::to_svg(section.figure), "CPU time of one thread.");
}

bool is_chosen(const BenchSpeedOptions& options, std::string_view name) {
  return std::ranges::any_of(options.sections,
                             [name](const std::string& section) { return section == "all" || section == name; });
}

int run(const BenchSpeedOptions& options, const Session& session) {
  ParamFlags().resolve(session);  // no key of a file is known here
  nlohmann::ordered_json json;
  HtmlReport page("How long things take, and how that grows");
  for (const Experiment& experiment : experiments) {
    if (!is_chosen(options, experiment.name)) { continue; }
    const SpeedSection section = experiment.run(options.speed, session);
    const std::string csv = csv_of(section.rows);
    json[std::string(experiment.name)] = section.rows;
    add_section(page, experiment.name, section);
    if (!options.out.empty()) {
      const std::filesystem::path out = value_or_quit(folder_for_results(options.out));
      const std::string name = "speed-" + std::string(experiment.name);
      value_or_quit(write_file_atomically(out / (name + ".csv"), csv));
      value_or_quit(write_file_atomically(out / (name + ".svg"), svg::to_svg(section.figure)));
    }
    if (session.talks()) { std::fputs(csv.c_str(), stdout); }
  }
  json["time"] = "CPU time of one thread";
  json["queries"] = options.speed.queries;
  json["seed"] = session.seed;
  json.update(provenance());
  if (!options.out.empty()) {
    const std::filesystem::path out = value_or_quit(folder_for_results(options.out));
    value_or_quit(write_file_atomically(out / "speed.json", json_text(json)));
    value_or_quit(write_file_atomically(out / "report.html", page.text()));
  }
  write_json(session, json);
  return exit_done;
}

}  // namespace

void add_bench_speed(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchSpeedOptions>();
  const auto add_options = [options](CLI::App& command) {
    std::vector<std::string> names{"all"};
    for (const Experiment& experiment : experiments) { names.emplace_back(experiment.name); }
    command.add_option("--sections,--section", options->sections, "experiments to run (default all)")
        ->delimiter(',')
        ->check(CLI::IsMember(names));
    command.add_option("--log", options->speed.log, "log with poses for stages and map-size (default: simulated)");
    command.add_option("--sizes", options->speed.sizes, "map scans of map-size (default 1000,10000,100000)")
        ->delimiter(',')
        ->check(CLI::Range(2, 1000000));
    command.add_option("--areas", options->speed.areas, "m², floors of the buildings that are mapped")
        ->delimiter(',')
        ->check(CLI::Range(200.0, 1e6));
    command.add_option("--queries", options->speed.queries, "scans localized in each map (default 100)")
        ->check(CLI::Range(1, 100000));
    command.add_option("-o,--output", options->out,
                       "folder for speed.json, report.html, and a CSV and an SVG file for each section");
  };
  CLI::App* command =
      add_command(bench, session, "speed", "How long things take, and how that grows.",
                  "flirt bench speed --sections stages,map-size --sizes 1000,10000 -o results", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
