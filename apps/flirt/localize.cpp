// apps/flirt/localize.cpp: `flirt localize`, the poses of single scans in a map, without a first guess.
#include "flirt/map/localize.hpp"

#include "flirt/core/parallel.hpp"
#include "flirt/io/feature_params_json.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/flirt_map.hpp"
#include "flirt/io/log.hpp"
#include "flirt/registration/join_scans.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/localize_flags.hpp"
#include "apps/flirt/localize_json.hpp"
#include "apps/flirt/localize_report.hpp"
#include "apps/flirt/localize_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace flirt::app {
namespace {

struct LocalizeOptions {
  std::string map;
  std::string log;
  std::optional<std::size_t> scan;
  std::size_t every{1};
  std::size_t hypotheses{10};
  std::size_t join{1};
  std::string svg;
  std::string out;
  bool summary_only{false};
  bool samples{false};
  bool track{false};
  TrackerParams tracker;
  LocalizeFlags flags;
  LocalizeParams localize;
  ParamFlags params;
};

/// What is kept of a query; solution sets of thousands of matches are not.
struct Answer {
  LocalizedScan outcome;
  std::size_t places{0};
  std::string line;
  nlohmann::ordered_json json;
};

std::vector<std::size_t> queries(const LocalizeOptions& options, std::size_t scans) {
  if (options.scan) {
    if (*options.scan < scans) { return {*options.scan}; }
    throw UsageError(fmt::format("--scan: expected one of the {} scans of the log, found {}", scans, *options.scan));
  }
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < scans; i += options.every) { all.push_back(i); }
  return all;
}

std::optional<Pose2> pose_in_log(const ScanLog& log, std::size_t scan) {
  return log.map_from_robot.empty() ? std::nullopt : std::optional(log.map_from_sensor(scan));
}

void check_options(const LocalizeOptions& options, const PlaceMap& map) {
  if (options.track && options.localize.method == LocalizeMethod::papers) {
    throw UsageError("--track: expected --method auto, dense or features with it, found papers");
  }
  if (options.join > 1 && options.localize.method == LocalizeMethod::papers) {
    throw UsageError("--join: expected --method auto, dense or features with it, found papers");
  }
  if (!options.svg.empty() && !options.scan) { throw UsageError("--svg: expected --scan with it, to show one scan"); }
  if (options.samples && options.localize.method != LocalizeMethod::papers) {
    throw UsageError("--samples: expected --method papers with it, whose matches are the samples");
  }
  if (options.localize.papers.match.distance == Distance::variance_chi_square && !map.has_variances()) {
    throw UsageError("--match-distance variance-chi-square: expected a map with variances (flirt map --variances)");
  }
}

/// The scan alone, or with --join together with those before it.
LocalizationResult localize_scan(Localizer& localizer, const LocalizeOptions& options, const ScanLog& log,
                                 std::size_t scan, LocalizeTimes* times = nullptr) {
  if (options.join == 1) { return localizer.localize(log.scans[scan], {}, times); }
  const std::size_t count = std::min(options.join, scan + 1);
  const ScanPoints joined =
      join_scans(std::span(log.scans).subspan(scan + 1 - count, count), options.localize.search.points);
  return localizer.localize_points(log.scans[scan], joined, {}, times);
}

/// One query uses all threads, several share them.
std::vector<Answer> answers(const LocalizeOptions& options, const PlaceMap& map, const ScanLog& log,
                            const Session& session) {
  const std::vector<std::size_t> scans = queries(options, log.scans.size());
  const bool single = scans.size() == 1;
  std::vector<std::unique_ptr<Localizer>> localizers(single ? 1 : thread_count(session.threads));
  std::vector<Answer> found(scans.size());
  parallel_for(
      scans.size(), localizers.size(),
      [&](std::size_t k, std::size_t thread) {
        if (!localizers[thread]) {
          localizers[thread] = std::make_unique<Localizer>(map, options.localize, single ? session.threads : 1);
        }
        LocalizeTimes times;
        const std::size_t scan = scans[k];
        const LocalizationResult result = localize_scan(*localizers[thread], options, log, scan, &times);
        const PoseHypothesis* best = result.best();
        Answer& answer = found[k];
        answer.outcome = {.scan = scan,
                          .verdict = result.verdict,
                          .map_from_sensor = best != nullptr ? std::optional(best->map_from_sensor) : std::nullopt,
                          .pose_in_log = pose_in_log(log, scan),
                          .time_us = times.total_us()};
        answer.places = result.hypotheses.size();
        answer.line = answer_line(scan, result, answer.outcome.pose_in_log);
        answer.json = answer_json(scan, result, times, {options.hypotheses, options.samples});
      },
      progress_bar(session, "localizing"));
  return found;
}

/// The picture of one scan's answer.
CaptionedFigure example(const LocalizeOptions& options, const PlaceMap& map, const std::vector<Point2>& points,
                        const ScanLog& log, std::size_t scan) {
  Localizer localizer(map, options.localize);
  const LocalizationResult result = localize_scan(localizer, options, log, scan);
  const std::string caption =
      fmt::format("Scan {}: {} ({})", scan, to_string(result.verdict), to_string(result.reason));
  return {localization_picture(points, log.scans[scan], result, pose_in_log(log, scan), caption), caption};
}

/// For the report: a unique answer from the middle of the log, and the ambiguous one with most places.
std::vector<std::size_t> scans_to_show(const std::vector<Answer>& found) {
  std::optional<std::size_t> unique;
  std::optional<std::size_t> ambiguous;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Verdict verdict = found[k].outcome.verdict;
    if (verdict == Verdict::unique && (!unique || k <= found.size() / 2)) { unique = k; }
    if (verdict == Verdict::ambiguous && (!ambiguous || found[k].places > found[*ambiguous].places)) { ambiguous = k; }
  }
  std::vector<std::size_t> scans;
  for (const std::optional<std::size_t>& k : {unique, ambiguous}) {
    if (k) { scans.push_back(found[*k].outcome.scan); }
  }
  return scans;
}

void write_pictures(const LocalizeOptions& options, const PlaceMap& map, const ScanLog& log,
                    const std::vector<Answer>& found, std::span<const LocalizedScan> outcomes) {
  if (options.svg.empty() && options.out.empty()) { return; }
  const std::vector<Point2> points = map_points(map);
  if (!options.svg.empty()) {
    value_or_quit(write_file_atomically(options.svg, example(options, map, points, log, *options.scan).svg));
  }
  if (options.out.empty()) { return; }
  std::vector<CaptionedFigure> examples;
  for (const std::size_t scan : scans_to_show(found)) { examples.push_back(example(options, map, points, log, scan)); }
  const std::filesystem::path out = value_or_quit(folder_for_results(options.out));
  const std::string title = "Scans of " + std::filesystem::path(options.log).filename().string() + " in the map " +
                            std::filesystem::path(options.map).filename().string();
  value_or_quit(write_file_atomically(out / "report.html", localize_report(title, outcomes, points, examples)));
}

/// --track: all scans in order.
int run_track(LocalizeOptions& options, const Session& session, const PlaceMap& map, const DrivenLog& driven) {
  options.tracker.localize = options.localize;
  options.tracker.seed = session.seed;
  const std::vector<TrackedScan> tracked = track(map, driven, options.tracker, session);
  nlohmann::ordered_json json{{"map", options.map}, {"log", options.log}};
  json.update(track_json(driven, tracked, options.hypotheses));
  json["method"] = options.flags.method();
  json["feature_params"] = json_from_feature_params(map.feature_params());
  json["params"] = options.params.json();
  json["seed"] = session.seed;
  json.update(provenance());
  write_json(session, json);
  if (session.talks()) {
    for (std::size_t i = 0; i < tracked.size() && !options.summary_only; ++i) {
      fmt::print("{}\n", track_line(i, tracked[i]));
    }
    fmt::print("{}", track_text(driven, tracked));
  }
  const TrackSummary summary = summarise(tracked);
  return summary.lost == summary.scans ? exit_not_found : exit_done;
}

int run(LocalizeOptions& options, const Session& session) {
  options.params.resolve(session, {"ransac"});
  options.localize = options.flags.localize();
  const PlaceMap map = value_or_quit(read_place_map(options.map));
  check_options(options, map);
  const DrivenLog driven = with_odometry(value_or_quit(read_log(options.log, {}, progress_bar(session, "reading"))));
  if (options.track) { return run_track(options, session, map, driven); }
  if (options.join > 1 && driven.odometry == "none") {
    throw BadInput(options.log + ": --join expected a log with odometry, found none");
  }
  const ScanLog& log = driven.log;
  const std::vector<Answer> found = answers(options, map, log, session);
  std::vector<LocalizedScan> outcomes;
  nlohmann::ordered_json json{{"map", options.map}, {"log", options.log}, {"queries", nlohmann::ordered_json::array()}};
  for (const Answer& answer : found) {
    outcomes.push_back(answer.outcome);
    json["queries"].push_back(answer.json);
  }
  if (options.join > 1) { json.update({{"join", options.join}, {"odometry", driven.odometry}}); }
  json["method"] = options.flags.method();
  json["feature_params"] = json_from_feature_params(map.feature_params());
  json["params"] = options.params.json();
  json["seed"] = session.seed;
  json.update(provenance());
  write_pictures(options, map, log, found, outcomes);
  write_json(session, json);
  if (session.talks()) {
    if (!options.summary_only) {
      for (const Answer& answer : found) { fmt::print("{}\n", answer.line); }
    }
    if (found.size() > 1) { fmt::print("{}", summary_text(summarise(outcomes))); }
  }
  const bool all_lost =
      std::ranges::all_of(outcomes, [](const LocalizedScan& scan) { return scan.verdict == Verdict::lost; });
  return all_lost ? exit_not_found : exit_done;
}

}  // namespace

void add_localize(CLI::App& program, Session& session) {
  auto options = std::make_shared<LocalizeOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("MAP", options->map, "map file made by flirt map")->required();
    command.add_option("LOG", options->log, "log with the scans to find; its poses are not looked at")->required();
    CLI::Option* scan = command.add_option("--scan", options->scan, "localize this scan alone, 0 for the first");
    command.add_option("--every", options->every, "localize every K-th scan (default 1)")
        ->check(CLI::Range(1, 1000000))
        ->excludes(scan);
    command.add_option("--hypotheses", options->hypotheses, "best places of a scan in the JSON, at most (default 10)");
    command
        .add_option("--join", options->join,
                    "search for each scan together with those before it, N in all, by the log's odometry (default 1)")
        ->check(CLI::Range(1, 1000));
    command.add_option("--svg", options->svg, "picture of one scan's answer, with --scan");
    command.add_option("-o,--output", options->out, "folder for report.html: success, times, and pictures");
    command.add_flag("--summary", options->summary_only, "print the summary alone, not a line for each scan");
    command.add_flag("--samples", options->samples,
                     "with --method papers, add every match to the JSON: weighted samples of p(pose | scan, map)");
    CLI::Option* track =
        command
            .add_flag("--track", options->track, "follow the robot through all scans in order, by the log's odometry")
            ->excludes(scan);
    for (const char* other : {"--every", "--svg", "--output", "--samples", "--join"}) {
      track->excludes(command.get_option(other));
    }
    options->flags.add(command, options->params);
    options->params.add(command, "track", options->tracker);
    options->params.add(command, "uniform", options->tracker.uniform);
  };
  CLI::App* command = add_command(program, session, "localize", "Find the poses of single scans in a map.",
                                  "flirt localize fr079.flirt run.log.gz --scan 12 --svg where.svg", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
