// apps/flirt/localization_page.cpp: results of `flirt bench localization` for people.
#include "flirt/io/svg.hpp"
#include "flirt/report/html.hpp"

#include "apps/flirt/localization_outputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <utility>

namespace flirt::app {
namespace {

/// P1 Fig. 5: precision and recall over the least number of inliers.
svg::Figure strategies_figure(const LocalizationBench& bench) {
  svg::Chart precision{.title = "Precision", .x = {.label = "least inliers"}, .y = {.low = 0.0, .high = 1.0}};
  svg::Chart recall{.title = "Recall", .x = {.label = "least inliers"}, .y = {.low = 0.0, .high = 1.0}};
  const auto series = [](const StrategyCurve& curve, const std::vector<Rate>& rates, std::size_t i) {
    svg::Series line{.legend = std::string(to_string(curve.strategy)), .style = svg::series_style(i)};
    for (std::size_t k = 0; k < rates.size(); ++k) {
      const Interval interval = rates[k].wilson();
      line.x.push_back(curve.n_min[k]);
      line.y.push_back(rates[k].value());
      line.low.push_back(interval.low);
      line.high.push_back(interval.high);
    }
    return line;
  };
  for (std::size_t i = 0; i < bench.strategies.size(); ++i) {
    precision.series.push_back(series(bench.strategies[i], bench.strategies[i].precision, i));
    recall.series.push_back(series(bench.strategies[i], bench.strategies[i].recall, i));
  }
  return {.panels = {precision, recall}};
}

svg::Figure revisit_figure(const RevisitSummary& summary) {
  svg::Chart chart{.title = "Precision over recall",
                   .x = {.label = "recall of the answerable queries", .low = 0.0, .high = 1.0},
                   .y = {.label = "precision", .low = 0.0, .high = 1.0}};
  svg::Series line{.style = {.marker = svg::Marker::none}};
  for (const PrecisionRecallPoint& point : summary.curve) {
    line.x.push_back(point.recall);
    line.y.push_back(point.precision);
  }
  chart.series.push_back(line);
  return {.panels = {chart}};
}

/// Where the answers are right and wrong: true places of the queries.
svg::Figure places_figure(const LocalizationBench& bench, const ScanLog& log) {
  svg::Points right{.colour = svg::sky_blue, .radius = 2, .legend = "right"};
  svg::Points wrong{.colour = svg::vermilion, .radius = 3, .legend = "wrong or no answer"};
  svg::Points distractor{.colour = svg::grey, .radius = 1.5, .legend = "not answerable"};
  for (const LocalizationAnswer& answer : bench.answers) {
    if (answer.strategy == to_string(PickBy::closest) || answer.strategy == to_string(PickBy::corresp)) { continue; }
    auto& group = answer.correct ? right : (answer.answerable ? wrong : distractor);
    group.at.push_back(log.map_from_sensor(answer.query).translation());
  }
  svg::Plan plan{.title = bench.revisit ? "Where queries were answered" : "Where queries were answered, residual"};
  plan.layers = {distractor, right, wrong};
  return {.panels = {plan}, .panel_width = 800};
}

std::vector<std::vector<std::string>> strategy_rows(const LocalizationBench& bench) {
  std::vector<std::vector<std::string>> rows;
  rows.reserve(bench.strategies.size());
  for (const StrategyCurve& curve : bench.strategies) {
    rows.push_back({std::string(to_string(curve.strategy)), with_interval(curve.p_gl()),
                    interval_text(curve.recall_bootstrap), fmt::format("{:.3f}", curve.precision_at_least().value()),
                    fmt::format("{:.3f}", curve.p_cl())});
  }
  return rows;
}

/// Of the covariances of right answers.
std::string coverage_text(const Coverage& nees) {
  return fmt::format("{:.3f} {:.3f} {:.3f}", nees.within_50.value(), nees.within_90.value(), nees.within_95.value());
}

std::vector<std::vector<std::string>> distractor_rows(const LocalizationRun& run) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&rows](const std::string& name, const DistractorSummary& summary) {
    rows.push_back({name, fmt::format("{} of {}", summary.unique.hits, summary.unique.total),
                    with_interval(summary.unique), fmt::format("{}", fmt::join(summary.confidences, " "))});
  };
  for (const DistractorRun& other : run.distractors) {
    add(std::filesystem::path(other.log).filename().string(), summarise_distractors(other.answers));
  }
  if (run.distractors.size() > 1) { add("all", all_distractors(run)); }
  return rows;
}

std::vector<std::vector<std::string>> ablation_rows(std::span<const LocalizationVariantRow> ablation) {
  std::vector<std::vector<std::string>> rows;
  for (const LocalizationVariantRow& row : ablation) {
    rows.push_back(
        {std::string(row.name), fmt::format("{:.3f}", row.success.value()), fmt::format("{:.3f}", row.recall_at_99),
         fmt::format("{:.3f}", row.unique_found), fmt::format("{:.1f}", row.query_median_us / 1000),
         fmt::format("{}:{}", row.from_full.only_first, row.from_full.only_second),
         fmt::format("{:.2g}", row.from_full.p_value()),
         fmt::format("[{:+.3f}, {:+.3f}]", row.difference.low, row.difference.high), std::string(row.meaning)});
  }
  return rows;
}

std::vector<std::vector<std::string>> revisit_rows(const RevisitSummary& summary) {
  return {{"success at 0.5 m, 10°", with_interval(summary.success)},
          {"the same, by blocks of trajectory", interval_text(summary.success_bootstrap)},
          {"success at 0.25 m, 5°", with_interval(summary.precise_success)},
          {"recall at precision 0.95", fmt::format("{:.3f}", recall_at_precision(summary.curve, 0.95))},
          {"recall at precision 0.99", fmt::format("{:.3f}", recall_at_precision(summary.curve, 0.99))},
          {"recall at precision 1.00", fmt::format("{:.3f}", recall_at_precision(summary.curve, 1.0))},
          {"average precision", fmt::format("{:.3f}", average_precision(summary.curve))},
          {"right of those called unique", with_interval(summary.unique_right)},
          {"called unique and right", with_interval(summary.unique_found)},
          {"truth in the 50, 90, 95 % regions", coverage_text(summary.nees)}};
}

std::vector<std::vector<std::string>> time_rows(const LocalizationBench& bench) {
  const LocalizationTimes& times = bench.times;
  std::vector<std::vector<std::string>> rows;
  for (const auto& [stage, us] : {std::pair{"detect a scan, median", times.detect_median},
                                  {"describe its keypoints, median", times.describe_median},
                                  {"one query against the map, median", times.per_query_median},
                                  {"one query against the map, 95th percentile", times.per_query_p95},
                                  {"  keypoints against all map scans, a pair, mean", times.per_pair},
                                  {"  coarse candidates, median", times.search_median},
                                  {"  candidates ranked by their beams, median", times.rank_median},
                                  {"  refinement, score, verdict, median", times.refine_median},
                                  {"neighbours taken out of the map (protocol only)", times.prepare_median}}) {
    if (us > 0) { rows.push_back({stage, fmt::format("{:.1f}", us)}); }  // 0: it did not run
  }
  return rows;
}

std::vector<std::vector<std::string>> reliability_rows(const RevisitSummary& summary) {
  std::vector<std::vector<std::string>> rows;
  for (const ReliabilityBin& bin : summary.reliability) {
    if (bin.right.total == 0) { continue; }
    rows.push_back({fmt::format("{:.2f} to {:.2f}", bin.low, std::min(1.0, bin.high)),
                    fmt::format("{:.3f}", bin.mean_confidence), with_interval(bin.right),
                    std::to_string(bin.right.total)});
  }
  return rows;
}

const std::vector<std::string> strategy_header{"strategy", "p_GL: correct of all [Wilson 95 %]", "by blocks",
                                               "p_GL as precision", "p_CL: recall at precision 0.95"};

const std::vector<std::string> distractor_header{"scans of", "called unique", "rate [Wilson 95 %]",
                                                 "answers by tenths of confidence"};
const std::vector<std::string> ablation_header{"variant",       "success",
                                               "recall at .99", "unique, right",
                                               "ms a query",    "only full : only it",
                                               "McNemar p",     "difference by blocks",
                                               "what"};

}  // namespace

std::string localization_text(const LocalizationRun& run) {
  const LocalizationBench& bench = run.bench;
  std::string text = fmt::format("{}: {} queries ({} answerable), map of {} scans, {:.1f} keypoints a scan\n", run.log,
                                 bench.queries, bench.answerable, bench.map_scans, bench.features_per_scan);
  for (const auto& row : strategy_rows(bench)) {
    text +=
        fmt::format("  {:<9} p_GL {}  blocks {}  as precision {}  p_CL {}\n", row[0], row[1], row[2], row[3], row[4]);
  }
  if (bench.revisit) {
    for (const auto& row : revisit_rows(*bench.revisit)) { text += fmt::format("  {:<34} {}\n", row[0], row[1]); }
  }
  for (const auto& row : distractor_rows(run)) {
    text += fmt::format("  scans of {}: {} called unique, {}; by tenths of confidence {}\n", row[0], row[1], row[2],
                        row[3]);
  }
  for (const auto& row : time_rows(bench)) { text += fmt::format("  {:<47} {:>9} µs\n", row[0], row[1]); }
  return text;
}

std::string ablation_text(const LocalizationRun& run) {
  std::string text = fmt::format("{}: {} answerable queries\n", run.log,
                                 run.ablation.empty() ? 0 : run.ablation.front().success.total);
  std::vector<std::vector<std::string>> rows{ablation_header};
  for (auto& row : ablation_rows(run.ablation)) { rows.push_back(std::move(row)); }
  for (const auto& row : rows) {
    text += fmt::format("  {:<18} {:>7} {:>13} {:>13} {:>10} {:>19} {:>9}  {:<20}  {}\n", row[0], row[1], row[2],
                        row[3], row[4], row[5], row[6], row[7], row[8]);
  }
  return text;
}

std::string localization_curves(const LocalizationRun& run) {
  return svg::to_svg(run.bench.revisit ? revisit_figure(*run.bench.revisit) : strategies_figure(run.bench));
}

std::string localization_page(const LocalizationRun& run, const ScanLog& log) {
  const LocalizationBench& bench = run.bench;
  const std::string name = std::filesystem::path(run.log).filename().string();
  HtmlReport page("Localization of single scans: " + name);
  page.paragraph(bench.revisit
                     ? "Every scan within 10 m of travel around the query leaves the map: the robot must recognise a "
                       "place from an earlier visit. Answerable: some remaining scan sees half of what the query sees."
                     : "Only the query itself leaves the map; the scans before and after it stay. n is the least "
                       "number of inliers of a match.");
  page.paragraph(fmt::format("{} queries, {} answerable, a map of {} scans, {:.1f} keypoints a scan.", bench.queries,
                             bench.answerable, bench.map_scans, bench.features_per_scan));
  if (bench.revisit) {
    page.table({"measure", "value [Wilson 95 %]"}, revisit_rows(*bench.revisit));
    page.figure(svg::to_svg(revisit_figure(*bench.revisit)), "Every accepted wrong pose counts, whoever asked.");
    page.heading("Is the confidence a probability?");
    page.table({"confidence", "mean", "right [Wilson 95 %]", "answers"}, reliability_rows(*bench.revisit));
  } else {
    page.table(strategy_header, strategy_rows(bench));
    page.figure(svg::to_svg(strategies_figure(bench)), "Shaded: Wilson 95 % intervals.");
  }
  page.figure(svg::to_svg(places_figure(bench, log)), "True places of the queries.");
  if (!run.distractors.empty()) {
    page.heading("Scans of other buildings");
    page.table(distractor_header, distractor_rows(run));
  }
  if (!run.ablation.empty()) {
    page.heading("What each ingredient brings");
    page.table(ablation_header, ablation_rows(run.ablation));
  }
  page.heading("Time, one thread each");
  page.table({"step", "µs"}, time_rows(bench));
  page.heading("How to repeat it");
  const auto origin = provenance();
  page.paragraph(fmt::format("flirt bench localization {} --protocol {} --every {}; commit {}, {}.", name, run.protocol,
                             run.every, origin["commit"].get<std::string>(), origin["cpu"].get<std::string>()));
  return page.text();
}

}  // namespace flirt::app
