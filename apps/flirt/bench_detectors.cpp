// apps/flirt/bench_detectors.cpp: `flirt bench detectors`, the papers' comparison of detectors (P2 Fig. 6).
#include "flirt/eval/detector_bench.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/svg.hpp"

#include "apps/flirt/bench_locations.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

namespace flirt::app {
namespace {

struct BenchDetectorsOptions {
  LocationFlags locations;
  std::string out;
  bool rivals{false};
  DetectorBenchParams bench;
};

/// Which detections of the scales are kept.
struct Selection {
  std::string name;
  DetectorBench bench;
};

std::string rule_text(RegionRule rule, double common_radius) {
  return rule == RegionRule::native ? "support regions" : fmt::format("all regions {:.2g} m", common_radius);
}

Table curves_table(const std::vector<Selection>& selections, std::uint64_t seed) {
  Table table{.name = "repeatability",
              .title = "Repeatability under every condition",
              .header = {"selection", "regions", "detector", "transform", "level", "repeatability", "repeatability_low",
                         "repeatability_high", "locations", "scan_pairs", "keypoints", "present", "corresponding"}};
  for (const auto& [name, bench] : selections) {
    for (const RegionRule rule : region_rules) {
      for (std::size_t v = 0; v < bench.variants.size(); ++v) {
        for (std::size_t c = 0; c < bench.conditions.size(); ++c) {
          const Mean mean = bootstrap_mean(location_scores(bench, v, rule, c), seed);
          const RepeatabilityCounts counts = total(bench, v, rule, c);
          table.rows.push_back(
              joined({{name, to_string(rule), bench.variants[v].name, to_string(bench.conditions[c].transform),
                       bench.conditions[c].level},
                      cells_of(mean.value, mean.interval),
                      {mean.cases, counts.scans, counts.keypoints, counts.present, counts.corresponding}}));
        }
      }
    }
  }
  return table;
}

/// Of the reference scans, each counted as often as it was compared.
double keypoints_per_scan(const DetectorBench& bench, std::size_t variant, ScanTransform transform) {
  RepeatabilityCounts sum;
  for (std::size_t c = 0; c < bench.conditions.size(); ++c) {
    if (bench.conditions[c].transform == transform) { sum += total(bench, variant, RegionRule::common, c); }
  }
  return sum.scans == 0 ? 0.0 : static_cast<double>(sum.keypoints) / sum.scans;
}

/// Mean over the levels of each transform, and by how much curvature is better at the same locations.
Table summary_table(const std::vector<Selection>& selections, std::uint64_t seed) {
  Table table{.name = "summary",
              .title = "Mean over the levels; curvature's lead at the same locations",
              .header = {"selection", "regions", "transform", "detector", "repeatability", "repeatability_low",
                         "repeatability_high", "curvature_leads_by", "curvature_leads_by_low",
                         "curvature_leads_by_high", "locations", "keypoints_a_scan"}};
  for (const auto& [name, bench] : selections) {
    for (const RegionRule rule : region_rules) {
      for (const ScanTransform transform : all_transforms) {
        const std::vector<double> curvature = location_scores(bench, 0, rule, transform);
        for (std::size_t v = 0; v < bench.variants.size(); ++v) {
          const std::vector<double> scores = location_scores(bench, v, rule, transform);
          const Mean mean = bootstrap_mean(scores, seed);
          const Mean lead = bootstrap_difference(curvature, scores, seed);
          table.rows.push_back(joined({{name, to_string(rule), to_string(transform), bench.variants[v].name},
                                       cells_of(mean.value, mean.interval),
                                       cells_of(lead.value, lead.interval),
                                       {mean.cases, keypoints_per_scan(bench, v, transform)}}));
        }
      }
    }
  }
  return table;
}

/// P2 Fig. 6: a panel per transform.
svg::Figure figure(const Selection& selection, RegionRule rule, const BenchDetectorsOptions& options,
                   std::uint64_t seed) {
  const DetectorBench& bench = selection.bench;
  svg::Figure figure{
      .title = fmt::format("Repeatability, {}, {}", selection.name, rule_text(rule, options.bench.common_radius)),
      .columns = 2};
  for (const ScanTransform transform : all_transforms) {
    svg::Chart chart{.title = std::string(to_string(transform)),
                     .x = {.label = level_label(transform)},
                     .y = {.label = "repeatability", .low = 0.0, .high = 1.0}};
    for (std::size_t v = 0; v < bench.variants.size(); ++v) {
      svg::Series line{.legend = bench.variants[v].name, .style = svg::series_style(v)};
      for (std::size_t c = 0; c < bench.conditions.size(); ++c) {
        if (bench.conditions[c].transform != transform) { continue; }
        const Mean mean = bootstrap_mean(location_scores(bench, v, rule, c), seed);
        if (mean.cases == 0) { continue; }
        line.x.push_back(bench.conditions[c].level);
        line.y.push_back(mean.value);
        line.low.push_back(mean.interval.low);
        line.high.push_back(mean.interval.high);
      }
      chart.series.push_back(std::move(line));
    }
    figure.panels.emplace_back(std::move(chart));
  }
  return figure;
}

nlohmann::ordered_json bench_json(const BenchDetectorsOptions& options, const Session& session,
                                  const ReferenceLocations& reference, const Table& curves, const Table& summary) {
  nlohmann::ordered_json json{{"experiment", "detectors"},
                              {"logs", reference.names},
                              {"locations", reference.locations.size()},
                              {"overlap_error", options.bench.repeatability.overlap_error},
                              {"presence_m", options.bench.repeatability.presence},
                              {"common_radius_m", options.bench.common_radius},
                              {"partners", options.bench.transforms.partners},
                              {"repeatability", to_json(curves)},
                              {"summary", to_json(summary)},
                              {"seed", session.seed}};
  json.update(provenance());
  return json;
}

void print(const ReferenceLocations& reference, const Table& summary) {
  fmt::print("{} locations of {} logs; mean over the levels [95 % by locations]\n", reference.locations.size(),
             reference.logs.size());
  for (const auto& row : summary.rows) {
    fmt::print("  {:<11} {:<7} {:<13} {:<16} {:.3f} [{:.3f}, {:.3f}]   curvature leads by {:+.3f} [{:+.3f}, {:+.3f}]\n",
               row[0].get<std::string>(), row[1].get<std::string>(), row[2].get<std::string>(),
               row[3].get<std::string>(), row[4].get<double>(), row[5].get<double>(), row[6].get<double>(),
               row[7].get<double>(), row[8].get<double>(), row[9].get<double>());
  }
}

/// What was run, and how to read it.
std::string introduction(const BenchDetectorsOptions& options, const ReferenceLocations& reference) {
  return fmt::format(
      "{} reference locations of {} logs (P2 §IV-B, Fig. 6). Two interest points correspond when their regions' "
      "overlap "
      "error is below {}; a place is present when its modified Hausdorff distance is below {} m. Shaded: 95 % "
      "bootstrap "
      "intervals over locations. “As printed”: every detection of every scale counts. “Default”: detections at a jump "
      "of "
      "the range move to the nearer beam, and those within 0.2 m of one of a finer scale are dropped. “Chance”: the "
      "points of curvature (of range) with their regions, but at random hits.",
      reference.locations.size(), reference.logs.size(), options.bench.repeatability.overlap_error,
      options.bench.repeatability.presence);
}

void write_all(const BenchDetectorsOptions& options, const Session& session, const ReferenceLocations& reference,
               const std::vector<Selection>& selections, const std::vector<Table>& tables) {
  const std::filesystem::path out = value_or_quit(folder_for_results(options.out));
  HtmlReport page("Which detector finds the same places again?");
  page.paragraph(introduction(options, reference));
  for (const Selection& selection : selections) {
    for (const RegionRule rule : region_rules) {
      const std::string drawing = svg::to_svg(figure(selection, rule, options, session.seed));
      const std::string name = selection.name == "default" ? "default" : "as-printed";
      value_or_quit(
          write_file_atomically(out / fmt::format("repeatability-{}-{}.svg", name, to_string(rule)), drawing));
      page.figure(drawing, selection.name + ", " + rule_text(rule, options.bench.common_radius));
    }
  }
  for (const Table& table : tables) {
    add_table(page, table);
    write_table(out, table);
  }
  value_or_quit(write_file_atomically(out / "report.html", page.text()));
}

int run(BenchDetectorsOptions& options, const Session& session) {
  ParamFlags().resolve(session);  // no key of a file is known here
  options.bench.transforms.seed = session.seed;
  const ReferenceLocations reference = read_locations(options.locations, session);
  const auto bench = [&](const std::vector<DetectorVariant>& variants, const std::string& label) {
    return Selection{label, bench_detectors(reference.logs, reference.locations, variants, options.bench,
                                            session.threads, progress_bar(session, label))};
  };
  const std::vector<Selection> selections{
      bench(detectors_as_printed(), "as printed"),
      bench(options.rivals ? detectors_with_rivals() : default_detectors(), "default")};
  const Table curves = curves_table(selections, session.seed);
  const Table summary = summary_table(selections, session.seed);
  const nlohmann::ordered_json json = bench_json(options, session, reference, curves, summary);
  if (!options.out.empty()) {
    write_all(options, session, reference, selections, {summary, curves, locations_table(reference)});
    value_or_quit(write_file_atomically(std::filesystem::path(options.out) / "detectors.json", json_text(json, 1)));
  }
  write_json(session, json);
  if (session.talks()) { print(reference, summary); }
  return exit_done;
}

}  // namespace

void add_bench_detectors(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchDetectorsOptions>();
  const auto add_options = [options](CLI::App& command) {
    options->locations.add(command, options->bench.transforms.partners);
    command.add_option("--common-radius", options->bench.common_radius, "m, of the common regions (default 0.5)")
        ->check(CLI::Range(0.01, 10.0));
    command.add_flag("--rivals", options->rivals, "FALKO and OC as well, among the defaults");
    command.add_option("-o,--output", options->out, "folder for report.html, tables (CSV, JSON) and figures (SVG)");
  };
  CLI::App* command =
      add_command(bench, session, "detectors", "Repeatability of the detectors under changes of the scan (P2 Fig. 6).",
                  "flirt bench detectors fr079.log.gz intel.log.gz csail.log.gz -o results", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
