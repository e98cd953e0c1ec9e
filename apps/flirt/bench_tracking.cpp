// apps/flirt/bench_tracking.cpp: `flirt bench tracking`, lost robots that drive until they know where they are.
#include "flirt/eval/tracking.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/log.hpp"
#include "flirt/map/place_map.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/feature_flags.hpp"
#include "apps/flirt/localize_flags.hpp"
#include "apps/flirt/tracking_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace flirt::app {
namespace {

struct BenchTrackingOptions {
  std::string log;
  std::string drives_log;
  std::vector<std::string> foreign;
  std::string out;
  std::string only;
  std::vector<std::string> kinds;
  FeatureFlags features;
  LocalizeFlags localize;
  TrackingBenchParams bench;
  ParamFlags params;
};

/// How a filter starts, and what makes it sure.
struct Method {
  TrackInitialisation initialisation;
  TrackCriterion criterion;
};
constexpr std::array methods{Method{TrackInitialisation::hypotheses, TrackCriterion::verdict},
                             Method{TrackInitialisation::uniform, TrackCriterion::verdict},
                             Method{TrackInitialisation::uniform, TrackCriterion::spread}};

nlohmann::ordered_json number_or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json rate_json(const Rate& rate) {
  const Interval interval = rate.wilson();
  return {
      {"hits", rate.hits}, {"total", rate.total}, {"rate", rate.value()}, {"wilson", {interval.low, interval.high}}};
}

nlohmann::ordered_json summary_json(const TrackingSummary& summary) {
  return {{"drives", summary.drives},
          {"kind", to_string(summary.kind)},
          {"initialisation", to_string(summary.initialisation)},
          {"criterion", to_string(summary.criterion)},
          {"localized", rate_json(summary.localized)},
          {"scans_median", number_or_null(summary.scans_median)},
          {"scans_95", number_or_null(summary.scans_95)},
          {"metres_median", number_or_null(summary.metres_median)},
          {"metres_95", number_or_null(summary.metres_95)},
          {"wrong_convergences", summary.convergences},
          {"wrong_drives", rate_json(summary.wrong_drives)},
          {"wrong_scans", rate_json(summary.wrong_scans)},
          {"right_scans", rate_json(summary.right_scans)},
          {"cpu_us_per_scan", summary.cpu_us_median}};
}

std::string drives_csv(const std::vector<DriveOutcome>& outcomes, const TrackingBenchParams& params) {
  std::string csv =
      "drive,kind,initialisation,criterion,begin,end,scans,scans_until,metres_until,sure,wrong,wrong_convergences,"
      "cpu_us_per_scan\n";
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    const DriveOutcome& outcome = outcomes[k];
    const ScanInterval scans = outcome.drive.parts.back().scans;
    for (const TrackCriterion criterion : {TrackCriterion::verdict, TrackCriterion::spread}) {
      const DriveResult result = judge_drive(outcome, criterion, params);
      const std::string until =
          result.scans_until ? fmt::format("{},{:.3f}", *result.scans_until, result.metres_until) : ",";
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{:.1f}\n", k, to_string(outcome.drive.kind),
                         to_string(outcome.initialisation), to_string(criterion), scans.begin, scans.end,
                         outcome.answers.size(), until, result.sure, result.wrong, result.convergences, outcome.cpu_us);
    }
  }
  return csv;
}

/// What each verdict was made from, one line per scan: to fit it, or to ask why.
std::string steps_csv(const std::vector<DriveOutcome>& outcomes) {
  std::string csv =
      "drive,kind,initialisation,scan,way,verdict,reason,confidence,belief,share,points,score,likelihood,free,unknown,"
      "through,effective,clusters,searched,search_confidence,injected,x,y,theta,agrees\n";
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    for (const TrackedAnswer& answer : outcomes[k].answers) {
      const TrackStep& step = answer.step;
      const EvidenceScore& score = step.evidence;
      csv += fmt::format(
          "{},{},{},{},{:.3f},{},{},{:.5f},{:.5f},{:.4f},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.1f},{},{},{:.5f},{},"
          "{:.4f},{:.4f},{:.5f},{}\n",
          k, to_string(outcomes[k].drive.kind), to_string(outcomes[k].initialisation), answer.scan, answer.way,
          to_string(step.verdict), to_string(step.reason), step.confidence, step.belief, step.share, step.points,
          score.total, score.likelihood, score.free, score.unknown, score.through, step.effective, step.clusters.size(),
          step.searched ? 1 : 0, step.search_confidence, step.injected ? 1 : 0, step.map_from_robot.x,
          step.map_from_robot.y, step.map_from_robot.theta, answer.agrees ? 1 : 0);
    }
  }
  return csv;
}

std::string number_or_never(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : std::string("never");
}

std::string percent(const Rate& rate) {
  return fmt::format("{:.1f}", 100 * rate.value());
}

void print(const std::vector<TrackingSummary>& summaries) {
  constexpr auto row = "{:<9} {:<10} {:<8} {:>6} {:>9} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>7} {:>7}\n";
  fmt::print(row, "drives", "particles", "sure by", "number", "localized", "scans", "95 %", "m", "95 %", "wrong",
             "drives", "scans%", "right%", "ms/scan");
  for (const TrackingSummary& summary : summaries) {
    fmt::print(row, to_string(summary.kind), to_string(summary.initialisation), to_string(summary.criterion),
               summary.drives, summary.localized.hits, number_or_never(summary.scans_median, 0),
               number_or_never(summary.scans_95, 0), number_or_never(summary.metres_median, 1),
               number_or_never(summary.metres_95, 1), summary.convergences, summary.wrong_drives.hits,
               percent(summary.wrong_scans), percent(summary.right_scans),
               fmt::format("{:.1f}", summary.cpu_us_median / 1e3));
  }
}

/// Drives of one log, of the kinds asked for, by each way to start.
void add_outcomes(const PlaceMap& map, const ScanLog& log, std::vector<TrackedDrive> drives,
                  const BenchTrackingOptions& options, const Session& session, std::vector<DriveOutcome>& outcomes) {
  if (!options.kinds.empty()) {
    std::erase_if(drives, [&](const TrackedDrive& drive) {
      return std::ranges::find(options.kinds, to_string(drive.kind)) == options.kinds.end();
    });
  }
  for (const TrackInitialisation initialisation : {TrackInitialisation::hypotheses, TrackInitialisation::uniform}) {
    if (!options.only.empty() && options.only != to_string(initialisation)) { continue; }
    const std::vector<DriveOutcome> tracked =
        track_drives(map, log, drives, initialisation, options.bench, session.threads,
                     progress_bar(session, "tracking, " + std::string(to_string(initialisation))));
    outcomes.insert(outcomes.end(), tracked.begin(), tracked.end());
  }
}

std::vector<DriveOutcome> all_outcomes(const BenchTrackingOptions& options, const Session& session, const ScanLog& log,
                                       const PlaceMap& map) {
  std::vector<DriveOutcome> outcomes;
  if (options.drives_log.empty()) {
    add_outcomes(map, log, drives_in_own_map(log, options.bench, session.threads, progress_bar(session, "drives")),
                 options, session, outcomes);
  } else {
    const ScanLog other = log_to_track(options.drives_log, session);
    add_outcomes(map, other, drives_in_other_map(other, DriveKind::known, options.bench), options, session, outcomes);
  }
  for (const std::string& foreign : options.foreign) {
    const ScanLog other = log_to_track(foreign, session);
    add_outcomes(map, other, drives_in_other_map(other, DriveKind::foreign, options.bench), options, session, outcomes);
  }
  return outcomes;
}

int run(BenchTrackingOptions& options, const Session& session) {
  options.params.resolve(session, {"ransac"});
  options.bench.seed = session.seed;
  options.bench.tracker.localize = options.localize.localize();
  if (options.bench.tracker.localize.method == LocalizeMethod::papers) {
    throw UsageError("--method: expected auto, dense or features, found papers");
  }
  const ScanLog log = log_to_track(options.log, session);
  const PlaceMap map = value_or_quit(
      build_place_map(log, options.features.features(), session.threads, progress_bar(session, "features")),
      options.log);
  const std::vector<DriveOutcome> outcomes = all_outcomes(options, session, log, map);
  std::vector<TrackingSummary> summaries;
  for (const auto& [kind, name] : enum_names(DriveKind{})) {
    for (const Method& method : methods) {
      const TrackingSummary summary = summarise(outcomes, kind, method.initialisation, method.criterion, options.bench);
      if (summary.drives > 0) { summaries.push_back(summary); }
    }
  }
  nlohmann::ordered_json json{{"log", options.log},
                              {"drives_log", options.drives_log},
                              {"foreign", options.foreign},
                              {"length", options.bench.length},
                              {"summaries", nlohmann::ordered_json::array()}};
  for (const TrackingSummary& summary : summaries) { json["summaries"].push_back(summary_json(summary)); }
  json["map_scans"] = map.size();
  json["params"] = options.params.json();
  json["seed"] = session.seed;
  json.update(provenance());
  if (!options.out.empty()) {
    const std::filesystem::path out = value_or_quit(folder_for_results(options.out));
    value_or_quit(write_file_atomically(out / "tracking.json", json_text(json)));
    value_or_quit(write_file_atomically(out / "drives.csv", drives_csv(outcomes, options.bench)));
    value_or_quit(write_file_atomically(out / "steps.csv", steps_csv(outcomes)));
  }
  write_json(session, json);
  if (session.talks()) { print(summaries); }
  return exit_done;
}

}  // namespace

void add_bench_tracking(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchTrackingOptions>();
  const auto add_options = [options](CLI::App& command) {
    command
        .add_option("LOG", options->log, "log with corrected poses, of the map and, without --drives-log, the drives")
        ->required();
    command.add_option("--drives-log", options->drives_log, "log with poses in the map's frame: its drives instead");
    command.add_option("--foreign", options->foreign, "logs of other buildings, each with poses: nothing may be found");
    command.add_option("--drives", options->bench.drives, "drives of each kind, at most (default 40)")
        ->check(CLI::Range(1, 1000000));
    command.add_option("--length", options->bench.length, "m of each drive (default 20)")->check(CLI::Range(0.1, 1e6));
    command.add_option("--only", options->only, "hypotheses or uniform: the other way to start is left out")
        ->check(CLI::IsMember({"hypotheses", "uniform"}));
    command
        .add_option("--kinds", options->kinds, "drives to track, of known, unmapped, kidnapped, foreign (default all)")
        ->check(CLI::IsMember({"known", "unmapped", "kidnapped", "foreign"}));
    command.add_option("-o,--output", options->out, "folder for tracking.json, drives.csv and steps.csv");
    options->features.add(command, options->params);
    options->localize.add(command, options->params);
    options->params.add(command, "track", options->bench.tracker);
    options->params.add(command, "uniform", options->bench.tracker.uniform);
  };
  CLI::App* command = add_command(bench, session, "tracking",
                                  "Drives from unknown starts: scans until localized, and wrong convergences.",
                                  "flirt bench tracking aces.log.gz --foreign fr101.log.gz -o results", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
