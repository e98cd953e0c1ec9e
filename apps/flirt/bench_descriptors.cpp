// apps/flirt/bench_descriptors.cpp: `flirt bench descriptors`, the papers' comparison of features (P2 Fig. 7).
#include "flirt/eval/descriptor_bench.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/svg.hpp"

#include "apps/flirt/bench_locations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>

namespace flirt::app {
namespace {

constexpr std::size_t bootstrap_draw_count = 500;

struct BenchDescriptorsOptions {
  LocationFlags locations;
  std::string out;
  bool rivals{false};
  DescriptorBenchParams bench;
};

constexpr std::array pair_rules{PairRule::all, PairRule::nearest};

std::string name_of(const DescriptorBench& bench, std::size_t entry) {
  const FeatureMethod& method = bench.methods[bench.entries[entry].method];
  const Distance distance = bench.entries[entry].distance;
  const std::string name = method.detector + " + " + method.descriptor;
  return distance == Distance::chi_square ? name : name + ", " + std::string(to_string(distance));
}

/// Average precisions of one entry under one pair of rules: each transform, and their mean.
struct EntryScore {
  std::array<AveragePrecision, transform_count> by_transform;
  AveragePrecision mean;
};

std::vector<EntryScore> scores_of(const DescriptorBench& bench, RegionRule region, PairRule pairs, std::uint64_t seed,
                                  std::size_t threads) {
  const auto draws = bootstrap_draws(bench.locations.size(), bootstrap_draw_count, seed);
  std::vector<EntryScore> scores(bench.entries.size());
  parallel_for(scores.size(), threads, [&](std::size_t e, std::size_t) {
    for (const ScanTransform transform : all_transforms) {
      scores[e].by_transform[static_cast<std::size_t>(transform)] =
          average_precision(bench.at({e, region, pairs, transform}), draws);
    }
    scores[e].mean = mean_of(scores[e].by_transform);
  });
  return scores;
}

std::size_t best_of(const std::vector<EntryScore>& scores) {
  const auto lower = [](const EntryScore& a, const EntryScore& b) { return a.mean.value < b.mean.value; };
  return static_cast<std::size_t>(std::max_element(scores.begin(), scores.end(), lower) - scores.begin());
}

Cells precision_cells(const AveragePrecision& score) {
  return cells_of(score.value, middle_95(score.draws));
}

/// Every entry against the best and against the papers' choice, at the same draws of locations.
Table ranking_table(const std::string& name, const std::string& title, const DescriptorBench& bench,
                    const Session& session) {
  Table table{.name = name, .title = title, .header = {"regions", "pairs", "features"}};
  for (const char* column :
       {"mean", "viewpoint", "noise", "subsampling", "oversampling", "behind_best", "behind_the_papers_choice"}) {
    for (const char* part : {"", "_low", "_high"}) { table.header.push_back(std::string(column) + part); }
  }
  table.header.insert(table.header.end(), {"correspondences", "locations"});
  for (const RegionRule region : region_rules) {
    for (const PairRule pairs : pair_rules) {
      const std::vector<EntryScore> scores = scores_of(bench, region, pairs, session.seed, session.threads);
      const EntryScore& best = scores[best_of(scores)];
      for (std::size_t e = 0; e < scores.size(); ++e) {
        std::size_t correspondences = 0;
        for (const ScanTransform transform : all_transforms) {
          correspondences += total(bench.at({e, region, pairs, transform})).correspondences;
        }
        const auto& own = scores[e].by_transform;
        table.rows.push_back(joined({{to_string(region), to_string(pairs), name_of(bench, e)},
                                     precision_cells(scores[e].mean),
                                     precision_cells(own[0]),
                                     precision_cells(own[1]),
                                     precision_cells(own[2]),
                                     precision_cells(own[3]),
                                     precision_cells(difference(best.mean, scores[e].mean)),
                                     precision_cells(difference(scores[0].mean, scores[e].mean)),
                                     {correspondences, bench.locations.size()}}));
      }
    }
  }
  return table;
}

Table curves_table(const std::string& name, const DescriptorBench& bench) {
  Table table{
      .name = name,
      .title = "Precision over recall",
      .header = {"regions", "pairs", "features", "transform", "threshold", "precision", "recall", "scan_pairs"}};
  for (const RegionRule region : region_rules) {
    for (const PairRule pairs : pair_rules) {
      for (std::size_t e = 0; e < bench.entries.size(); ++e) {
        for (const ScanTransform transform : all_transforms) {
          for (const MatchingPoint& point : matching_curve(total(bench.at({e, region, pairs, transform})))) {
            const double threshold = distance_threshold(bench.entries[e].distance, point.threshold);
            table.rows.push_back({to_string(region), to_string(pairs), name_of(bench, e), to_string(transform),
                                  threshold, point.precision, point.recall,
                                  bench.scans[static_cast<std::size_t>(transform)]});
          }
        }
      }
    }
  }
  return table;
}

/// Colour and marker tell the detector, the dash the descriptor: in grey as well.
svg::SeriesStyle style_of(const FeatureMethod& method) {
  const std::optional<DetectorParams> detector = detector_from_name(method.detector);
  svg::SeriesStyle style = svg::series_style(detector ? detector->index() : 0);
  style.dash = method.descriptor == "shape-context" ? svg::Dash::dashed : svg::Dash::solid;
  return style;
}

/// The curve without points nearer than a twentieth of the recall, so that its markers can be told apart.
svg::Series curve_series(const std::string& legend, const MatchingCounts& counts) {
  svg::Series line{.legend = legend};
  double next = 0;
  for (const MatchingPoint& point : matching_curve(counts)) {
    if (point.recall < next && point.threshold + 1 < threshold_count) { continue; }
    line.x.push_back(point.recall);
    line.y.push_back(point.precision);
    next = point.recall + 0.05;
  }
  return line;
}

/// P2 Fig. 7: a panel per transform.
svg::Figure figure(const std::string& title, const DescriptorBench& bench, RegionRule region, PairRule pairs) {
  svg::Figure figure{.title = title, .columns = 2};
  for (const ScanTransform transform : all_transforms) {
    svg::Chart chart{.title = std::string(to_string(transform)),
                     .x = {.label = "recall", .low = 0.0, .high = 1.0},
                     .y = {.label = "precision", .low = 0.0, .high = 1.0}};
    for (std::size_t e = 0; e < bench.entries.size(); ++e) {
      svg::Series line = curve_series(name_of(bench, e), total(bench.at({e, region, pairs, transform})));
      line.style = style_of(bench.methods[bench.entries[e].method]);
      chart.series.push_back(std::move(line));
    }
    figure.panels.emplace_back(std::move(chart));
  }
  return figure;
}

void print_ranking(const Table& ranking) {
  fmt::print("{}\n", ranking.title);
  for (const auto& row : ranking.rows) {
    fmt::print("  {:<7} {:<8} {:<44} {:.3f} [{:.3f}, {:.3f}]   behind the best by {:.3f} [{:+.3f}, {:+.3f}]\n",
               row[0].get<std::string>(), row[1].get<std::string>(), row[2].get<std::string>(), row[3].get<double>(),
               row[4].get<double>(), row[5].get<double>(), row[18].get<double>(), row[19].get<double>(),
               row[20].get<double>());
  }
}

void write_all(const BenchDescriptorsOptions& options, const ReferenceLocations& reference,
               const DescriptorBench& papers, const DescriptorBench& variants, const Table& ranking,
               const Table& variant_ranking, const nlohmann::ordered_json& json) {
  const std::filesystem::path out = value_or_quit(folder_for_results(options.out));
  HtmlReport page("Which features tell places apart?");
  page.paragraph(
      fmt::format("{} reference locations of {} logs (P2 §IV-C, Fig. 7); pairs of scans: {} viewpoint, {} "
                  "noise, {} subsampling, {} oversampling. A match is right when the regions' overlap error "
                  "is below {}. Intervals: 95 % by drawing the locations again.",
                  papers.locations.size(), reference.logs.size(), papers.scans[0], papers.scans[1], papers.scans[2],
                  papers.scans[3], options.bench.overlap_error));
  for (const RegionRule region : region_rules) {
    for (const PairRule pairs : pair_rules) {
      const std::string title = fmt::format("Matching, {} regions, {} pairs", to_string(region), to_string(pairs));
      const std::string drawing = svg::to_svg(figure(title, papers, region, pairs));
      value_or_quit(write_file_atomically(
          out / fmt::format("precision-recall-{}-{}.svg", to_string(region), to_string(pairs)), drawing));
      page.figure(drawing, pairs == PairRule::all ? "Every pair below the threshold is a match, as in the paper."
                                                  : "Only the nearest descriptor can match.");
    }
  }
  add_table(page, ranking);
  add_table(page, variant_ranking);
  const Table locations = locations_table(reference);
  add_table(page, locations);
  for (const Table& table : {ranking, variant_ranking, locations, curves_table("precision-recall", papers),
                             curves_table("precision-recall-variants", variants)}) {
    write_table(out, table);
  }
  value_or_quit(write_file_atomically(out / "descriptors.json", json_text(json, 1)));
  value_or_quit(write_file_atomically(out / "report.html", page.text()));
}

int run(BenchDescriptorsOptions& options, const Session& session) {
  ParamFlags().resolve(session);  // no key of a file is known here
  options.bench.transforms.seed = session.seed;
  const ReferenceLocations reference = read_locations(options.locations, session);
  const auto bench = [&](const std::vector<FeatureMethod>& methods, const std::string& label) {
    return bench_descriptors(reference.logs, reference.locations, methods, options.bench, session.threads,
                             progress_bar(session, label));
  };
  const DescriptorBench papers = bench(paper_combinations(), "combinations");
  std::vector<FeatureMethod> others = descriptor_variants();
  if (options.rivals) {
    const std::vector<FeatureMethod> rivals = rival_combinations();
    others.insert(others.end(), rivals.begin() + 2, rivals.end());  // ours on our keypoints are there
  }
  const DescriptorBench variants = bench(others, "variants");
  const Table ranking = ranking_table("ranking", "Average precision of the papers' combinations", papers, session);
  const Table variant_ranking =
      ranking_table("variants", "Average precision of other descriptors and distances", variants, session);
  nlohmann::ordered_json json{{"experiment", "descriptors"},
                              {"logs", reference.names},
                              {"locations", reference.locations.size()},
                              {"overlap_error", options.bench.overlap_error},
                              {"common_radius_m", options.bench.common_radius},
                              {"partners", options.bench.transforms.partners},
                              {"ranking", to_json(ranking)},
                              {"variants", to_json(variant_ranking)},
                              {"seed", session.seed}};
  json.update(provenance());
  if (!options.out.empty()) { write_all(options, reference, papers, variants, ranking, variant_ranking, json); }
  write_json(session, json);
  if (session.talks()) {
    print_ranking(ranking);
    print_ranking(variant_ranking);
  }
  return exit_done;
}

}  // namespace

void add_bench_descriptors(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchDescriptorsOptions>();
  const auto add_options = [options](CLI::App& command) {
    options->locations.add(command, options->bench.transforms.partners);
    command.add_flag("--rivals", options->rivals,
                     "BSC and CGH, and FALKO and OC keypoints, among the other descriptors");
    command.add_option("-o,--output", options->out, "folder for report.html, tables (CSV, JSON) and figures (SVG)");
  };
  CLI::App* command =
      add_command(bench, session, "descriptors",
                  "Precision and recall of detectors with descriptors under changes of the scan (P2 "
                  "Fig. 7).",
                  "flirt bench descriptors fr079.log.gz intel.log.gz csail.log.gz -o results", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
