// apps/flirt/bench_localization.cpp: `flirt bench localization`, single scans found in the map of the rest of their
// log.
#include "flirt/eval/localization.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/svg.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/report/html.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/feature_flags.hpp"
#include "apps/flirt/localize_flags.hpp"
#include "apps/flirt/tracking_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace flirt::app {
namespace {

struct Options {
  std::string log;
  std::string out;
  std::string protocol{"paper"};
  FeatureFlags features;
  LocalizeFlags localize;
  LocalizationBenchParams bench;
  ParamFlags params;
};

std::string with_interval(const Rate& rate) {
  const Interval interval = rate.wilson();
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", rate.value(), interval.low, interval.high);
}

std::string interval_text(Interval interval) {
  return fmt::format("[{:.3f}, {:.3f}]", interval.low, interval.high);
}

nlohmann::ordered_json pair_of(Interval interval) {
  return {interval.low, interval.high};
}

nlohmann::ordered_json strategy_json(const StrategyCurve& curve) {
  nlohmann::ordered_json json{{"p_gl", curve.p_gl().value()},
                              {"p_gl_wilson", pair_of(curve.p_gl().wilson())},
                              {"p_gl_bootstrap", pair_of(curve.recall_bootstrap)},
                              {"p_gl_as_precision", curve.precision_at_least().value()},
                              {"p_cl", curve.p_cl()},
                              {"precision", nlohmann::ordered_json::array()},
                              {"recall", nlohmann::ordered_json::array()},
                              {"n_min", curve.n_min}};
  for (std::size_t k = 0; k < curve.n_min.size(); ++k) {
    json["precision"].push_back(curve.precision[k].value());
    json["recall"].push_back(curve.recall[k].value());
  }
  return json;
}

nlohmann::ordered_json reliability_json(const RevisitSummary& summary) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const ReliabilityBin& bin : summary.reliability) {
    json.push_back({{"from", bin.low},
                    {"to", std::min(1.0, bin.high)},
                    {"mean_confidence", bin.mean_confidence},
                    {"answers", bin.right.total},
                    {"right", bin.right.value()}});
  }
  return json;
}

nlohmann::ordered_json revisit_json(const RevisitSummary& summary) {
  return {{"recall_at_95", recall_at_precision(summary.curve, 0.95)},
          {"recall_at_99", recall_at_precision(summary.curve, 0.99)},
          {"recall_at_100", recall_at_precision(summary.curve, 1.0)},
          {"average_precision", average_precision(summary.curve)},
          {"unique_right", summary.unique_right.value()},
          {"unique_found", summary.unique_found.value()},
          {"reliability", reliability_json(summary)},
          {"success", summary.success.value()},
          {"success_wilson", pair_of(summary.success.wilson())},
          {"success_bootstrap", pair_of(summary.success_bootstrap)},
          {"success_025m_5deg", summary.precise_success.value()},
          {"success_025m_5deg_wilson", pair_of(summary.precise_success.wilson())}};
}

nlohmann::ordered_json bench_json(const Options& options, const Session& session, const LocalizationBench& bench) {
  nlohmann::ordered_json json{{"log", options.log},
                              {"protocol", options.protocol},
                              {"queries", bench.queries},
                              {"answerable", bench.answerable},
                              {"features_per_scan", bench.features_per_scan}};
  for (const StrategyCurve& curve : bench.strategies) {
    json["strategies"][std::string(to_string(curve.strategy))] = strategy_json(curve);
  }
  if (bench.revisit) { json["revisit"] = revisit_json(*bench.revisit); }
  json["time_us"] = {{"detect", bench.times.detect_median},
                     {"describe", bench.times.describe_median},
                     {"per_query_median", bench.times.per_query_median},
                     {"per_query_p95", bench.times.per_query_p95},
                     {"per_pair", bench.times.per_pair},
                     {"search", bench.times.search_median},
                     {"rank", bench.times.rank_median},
                     {"refine", bench.times.refine_median},
                     {"prepare", bench.times.prepare_median}};
  json["map_scans"] = bench.map_scans;
  json["every"] = options.bench.every;
  if (options.bench.join > 1) { json["join"] = options.bench.join; }
  json["method"] = bench.revisit ? options.localize.method() : "papers";
  json["params"] = options.params.json();
  json["seed"] = session.seed;
  json.update(provenance());
  return json;
}

std::string queries_csv(const LocalizationBench& bench) {
  std::string csv = "query,strategy,answerable,reference,x,y,theta,confidence,inliers,residual,verdict,correct\n";
  for (const LocalizationAnswer& answer : bench.answers) {
    csv += fmt::format("{},{},{},", answer.query, answer.strategy, answer.answerable ? 1 : 0);
    if (answer.answered) {
      const Pose2& pose = answer.map_from_sensor;
      csv += fmt::format("{},{:.6f},{:.6f},{:.6f},{:.6g},{},{:.6g},", answer.reference, pose.x, pose.y, pose.theta,
                         answer.confidence, answer.inliers, answer.residual);
    } else {
      csv += ",,,,,,,";
    }
    csv += fmt::format("{},{}\n", answer.verdict, answer.correct ? 1 : 0);
  }
  return csv;
}

/// What the confidence was computed from, one line per query: to fit it, or to ask why.
std::string evidence_csv(const LocalizationBench& bench) {
  std::string csv =
      "query,answerable,correct,precise,verdict,reason,confidence,points,margin,score,likelihood,free,unknown,through,"
      "near,residual\n";
  for (const LocalizationAnswer& answer : bench.answers) {
    const EvidenceScore& score = answer.evidence;
    csv += fmt::format("{},{},{},{},{},{},{:.6g},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.5f}\n",
                       answer.query, answer.answerable ? 1 : 0, answer.correct ? 1 : 0, answer.precise ? 1 : 0,
                       answer.verdict, answer.reason, answer.confidence, answer.points, answer.margin, score.total,
                       score.likelihood, score.free, score.unknown, score.through, score.near, score.residual);
  }
  return csv;
}

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

std::vector<std::vector<std::string>> revisit_rows(const RevisitSummary& summary) {
  return {{"success at 0.5 m, 10°", with_interval(summary.success)},
          {"the same, by blocks of trajectory", interval_text(summary.success_bootstrap)},
          {"success at 0.25 m, 5°", with_interval(summary.precise_success)},
          {"recall at precision 0.95", fmt::format("{:.3f}", recall_at_precision(summary.curve, 0.95))},
          {"recall at precision 0.99", fmt::format("{:.3f}", recall_at_precision(summary.curve, 0.99))},
          {"recall at precision 1.00", fmt::format("{:.3f}", recall_at_precision(summary.curve, 1.0))},
          {"average precision", fmt::format("{:.3f}", average_precision(summary.curve))},
          {"right of those called unique", with_interval(summary.unique_right)},
          {"called unique and right", with_interval(summary.unique_found)}};
}

std::vector<std::vector<std::string>> time_rows(const LocalizationBench& bench) {
  const auto us = [](double value) { return fmt::format("{:.1f}", value); };
  return {{"detect a scan, median", us(bench.times.detect_median)},
          {"describe its keypoints, median", us(bench.times.describe_median)},
          {"one query against the map, median", us(bench.times.per_query_median)},
          {"one query against the map, 95th percentile", us(bench.times.per_query_p95)},
          {"  keypoints against all map scans, a pair, mean", us(bench.times.per_pair)},
          {"  coarse candidates, median", us(bench.times.search_median)},
          {"  candidates ranked by their beams, median", us(bench.times.rank_median)},
          {"  refinement, score, verdict, median", us(bench.times.refine_median)},
          {"neighbours taken out of the map (protocol only)", us(bench.times.prepare_median)}};
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

void print(const Options& options, const LocalizationBench& bench) {
  fmt::print("{}: {} queries ({} answerable), map of {} scans, {:.1f} keypoints a scan\n", options.log, bench.queries,
             bench.answerable, bench.map_scans, bench.features_per_scan);
  for (const auto& row : strategy_rows(bench)) {
    fmt::print("  {:<9} p_GL {}  blocks {}  as precision {}  p_CL {}\n", row[0], row[1], row[2], row[3], row[4]);
  }
  if (bench.revisit) {
    for (const auto& row : revisit_rows(*bench.revisit)) { fmt::print("  {:<34} {}\n", row[0], row[1]); }
  }
  for (const auto& row : time_rows(bench)) { fmt::print("  {:<47} {:>9} µs\n", row[0], row[1]); }
}

std::string report(const Options& options, const LocalizationBench& bench, const ScanLog& log) {
  const std::string name = std::filesystem::path(options.log).filename().string();
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
  page.heading("Time, one thread each");
  page.table({"step", "µs"}, time_rows(bench));
  page.heading("How to repeat it");
  const auto origin = provenance();
  page.paragraph(fmt::format("flirt bench localization {} --protocol {} --every {}; commit {}, {}.", name,
                             options.protocol, options.bench.every, origin["commit"].get<std::string>(),
                             origin["cpu"].get<std::string>()));
  return page.text();
}

int run(Options& options, const Session& session) {
  options.params.resolve(session.config);
  options.bench.seed = session.seed;
  options.bench.localize = options.localize.localize(session.seed);
  options.bench.protocol = options.protocol == "revisit" ? LocalizationProtocol::revisit : LocalizationProtocol::paper;
  LoadedLog loaded = value_or_quit(read_log(options.log, {}, progress_bar(session, "reading")));
  if (loaded.log.map_from_robot.empty()) {
    throw BadInput(options.log + ": expected a log with poses (they are the truth), found none");
  }
  if (options.bench.join > 1) {
    if (options.protocol != "revisit" || options.bench.localize.method == LocalizeMethod::papers) {
      throw UsageError("--join: expected --protocol revisit and a --method other than papers with it");
    }
    loaded.log = log_to_track(options.log, session);
  }
  const PlaceMap map = value_or_quit(
      build_place_map(loaded.log, options.features.features(), session.threads, progress_bar(session, "features")));
  const LocalizationBench bench =
      bench_localization(loaded.log, map, options.bench, session.threads, progress_bar(session, "localizing"));
  const nlohmann::ordered_json json = bench_json(options, session, bench);
  if (!options.out.empty()) {
    const std::filesystem::path out = value_or_quit(folder_for_results(options.out));
    value_or_quit(write_file_atomically(out / "queries.csv", queries_csv(bench)));
    if (bench.revisit) { value_or_quit(write_file_atomically(out / "evidence.csv", evidence_csv(bench))); }
    value_or_quit(write_file_atomically(out / "localization.json", json.dump(2) + "\n"));
    const svg::Figure curves = bench.revisit ? revisit_figure(*bench.revisit) : strategies_figure(bench);
    value_or_quit(write_file_atomically(out / "localization.svg", svg::to_svg(curves)));
    value_or_quit(write_file_atomically(out / "report.html", report(options, bench, loaded.log)));
  }
  write_json(session, json);
  if (session.talks()) { print(options, bench); }
  return exit_done;
}

}  // namespace

void add_bench_localization(CLI::App& bench, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(bench, session, "localization", "Find single scans of a log in the map of its other scans.",
                  "flirt bench localization fr079.log.gz --protocol revisit --every 3 -o results");
  command->add_option("LOG", options->log, "log with corrected poses")->required();
  command
      ->add_option("--protocol", options->protocol,
                   "paper: only the query leaves the map; revisit: 10 m of travel around it (default paper)")
      ->check(CLI::IsMember({"paper", "revisit"}));
  command->add_option("--every", options->bench.every, "query every K-th scan (default 1)")
      ->check(CLI::Range(1, 1000000));
  command
      ->add_option("--join", options->bench.join,
                   "revisit: ask for each scan together with those before it, N in all, by odometry (default 1)")
      ->check(CLI::Range(1, 1000));
  command->add_option("-o,--output", options->out,
                      "folder for localization.json, queries.csv, evidence.csv, localization.svg and report.html");
  options->features.add(*command, options->params);
  options->localize.add(*command, options->params);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
