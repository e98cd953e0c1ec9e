// apps/flirt/slam.cpp: `flirt slam`, a consistent map from any log.
#include "flirt/slam/slam.hpp"

#include "flirt/core/stopwatch.hpp"
#include "flirt/io/flirt_map.hpp"
#include "flirt/io/g2o.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/tum.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/slam_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

namespace flirt::app {
namespace {

struct SlamOptions {
  std::string log;
  std::string out;
  bool no_odometry{false};
  std::optional<std::uint32_t> window;
  std::string front_end;
  std::string resume;
  std::size_t every{1};
  SlamParams slam;
  ParamFlags params;
};

/// The short flags say the same as --slam-odometry, --slam-window and --slam-front-end, and win over a file.
void apply_short_flags(SlamOptions& options) {
  if (options.no_odometry) { options.slam.odometry = OdometryUse::ignore; }
  if (options.window) { options.slam.window = *options.window; }
  for (const auto& [kind, name] : enum_names(FrontEndKind{})) {
    if (name == options.front_end) { options.slam.front_end = kind; }
  }
}

std::string name_of(FrontEndKind front_end) {
  for (const auto& [kind, name] : enum_names(FrontEndKind{})) {
    if (kind == front_end) { return std::string(name); }
  }
  return {};
}

ScanLog every_kth(ScanLog log, std::size_t k) {
  if (k == 1) { return log; }
  ScanLog thinned;
  for (std::size_t i = 0; i < log.scans.size(); i += k) {
    thinned.scans.push_back(std::move(log.scans[i]));
    if (!log.map_from_robot.empty()) { thinned.map_from_robot.push_back(log.map_from_robot[i]); }
  }
  return thinned;
}

/// What the run made of the log's odometry.
std::string odometry_use(const SlamOptions& options, const ScanLog& log) {
  std::vector<Pose2> stated;
  for (const Scan& scan : log.scans) {
    if (scan.odom_from_robot) { stated.push_back(*scan.odom_from_robot); }
  }
  if (stated.empty()) { return "none in the log"; }
  const bool moves = std::ranges::any_of(stated, [&](const Pose2& pose) { return pose != stated.front(); });
  if (!moves && stated.size() > 1) { return "none: that of the log never moves"; }
  return options.slam.odometry == OdometryUse::ignore || options.slam.window > 0 ? "ignored" : "used";
}

/// What `flirt slam` wrote earlier.
struct EarlierMap {
  std::vector<Scan> scans;
  std::vector<double> stamps;
  PoseGraph graph;
};

EarlierMap read_earlier(const std::string& folder) {
  const std::filesystem::path path(folder);
  const PlaceMap places = value_or_quit(read_place_map(path / "map.flirt"));
  const std::vector<StampedPose> trajectory = value_or_quit(read_tum(path / "trajectory.tum"));
  EarlierMap earlier;
  earlier.graph = value_or_quit(read_g2o(path / "graph.g2o")).graph;
  const std::size_t nodes = earlier.graph.map_from_node.size();
  if (places.size() != nodes || trajectory.size() != nodes || nodes == 0) {
    throw BadInput(
        fmt::format("{}: expected one map of flirt slam, found {} nodes in graph.g2o, {} scans in map.flirt and "
                    "{} poses in trajectory.tum",
                    folder, nodes, places.size(), trajectory.size()));
  }
  constexpr std::uint32_t farthest_motion = 3;  // nodes; edges of the front-ends reach no farther
  for (PoseEdge& edge : earlier.graph.edges) {
    const std::uint32_t apart = edge.a > edge.b ? edge.a - edge.b : edge.b - edge.a;
    edge.kind = apart <= farthest_motion ? EdgeKind::motion : EdgeKind::loop;
  }
  for (std::size_t i = 0; i < nodes; ++i) {
    earlier.scans.push_back(places.scan(i));
    earlier.stamps.push_back(trajectory[i].stamp);
  }
  return earlier;
}

SlamRun map_log(const SlamOptions& options, const ScanLog& log, const EarlierMap& earlier, const Session& session) {
  SlamRun run{.log = options.log,
              .odometry = odometry_use(options, log),
              .front_end = name_of(options.slam.front_end),
              .graph = {},
              .steps = {},
              .summary = {},
              .latency_ms = {},
              .params = options.params.json(),
              .seed = session.seed};
  const Progress progress = progress_bar(session, "mapping");
  Slam slam(options.slam);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    Stopwatch stopwatch;
    slam.add(log.scans[i]);
    run.latency_ms.push_back(stopwatch.lap_us() * 1e-3);
    if (progress) { progress(static_cast<double>(i + 1) / static_cast<double>(log.scans.size())); }
  }
  if (!earlier.scans.empty()) {
    run.earlier_scans = earlier.scans.size();
    run.join = slam.join(earlier.scans, earlier.graph);
    if (run.join->agreeing == 0) { return run; }
  }
  slam.finish();
  run.graph = slam.graph();
  run.steps = slam.steps();
  run.summary = slam.summary();
  return run;
}

void print(const SlamOptions& options, const SlamRun& run, const LogReport& report) {
  const SlamSummary& s = run.summary;
  fmt::print("{}: {} scans, odometry {}, {} closures\n", options.log, s.scans, run.odometry, s.closures);
  if (report.odometry_repeats_pose) {
    fmt::print("the odometry of this log repeats its corrected poses: it was not used\n");
  }
  if (run.join) {
    fmt::print("joined to the {} scans of {}: {} of {} places found agree\n", run.earlier_scans, options.resume,
               run.join->agreeing, run.join->found);
  }
  if (s.unobservable > 0) {
    fmt::print("{} motions could not be seen in some direction: see summary.json\n", s.unobservable);
    if (s.pieces > 1) { fmt::print("only they hold {} pieces of the map together\n", s.pieces); }
  }
  if (s.predictions > 0) { fmt::print("{} scans were placed by prediction alone\n", s.predictions); }
  const SlamTimes& t = s.seconds;
  fmt::print("{:.2f} s: motion {:.2f}, closures {:.2f}, optimization {:.2f}, joint alignment {:.2f}\n",
             t.points + t.front_end + t.loops + t.optimize + t.polish, t.points + t.front_end, t.loops, t.optimize,
             t.polish);
  fmt::print("map, trajectory, graph and report in {}\n", options.out);
}

/// Nothing is written but the JSON that was asked for.
int report_not_found(const SlamOptions& options, const SlamRun& run, const Session& session) {
  write_json(session, slam_json(run));
  if (!session.quiet) {
    fmt::print(stderr,
               "flirt: {}: not found in the map of {}: {} of {} scans were found at one place each, too few of them "
               "agree; nothing was written\n",
               options.log, options.resume, run.join->found, run.join->queries);
  }
  return exit_not_found;
}

/// The scans of both runs, those of the earlier map first.
ScanLog with_earlier(EarlierMap earlier, ScanLog log) {
  if (earlier.scans.empty()) { return log; }
  ScanLog both;
  both.scans = std::move(earlier.scans);
  for (std::size_t i = 0; i < both.scans.size(); ++i) { both.scans[i].stamp = earlier.stamps[i]; }
  std::ranges::move(log.scans, std::back_inserter(both.scans));
  return both;
}

/// The folder for results, which goes away again when nothing comes into it.
class ResultsFolder {
 public:
  explicit ResultsFolder(const std::string& folder)
      : is_new_(std::filesystem::status(folder, ignored_).type() == std::filesystem::file_type::not_found),
        path_(value_or_quit(folder_for_results(folder))) {}
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;
  ~ResultsFolder() {
    if (is_new_) { std::filesystem::remove(path_, ignored_); }  // fails for one that is not empty
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::error_code ignored_{};
  bool is_new_;
  std::filesystem::path path_;
};

int run(SlamOptions& options, const Session& session) {
  options.params.resolve(session);
  apply_short_flags(options);
  if (!options.resume.empty() && options.slam.window > 0) {
    throw UsageError("slam: --resume: expected no --window, which keeps no map to join");
  }
  LoadedLog loaded = value_or_quit(read_log(options.log, {}, progress_bar(session, "reading")));
  loaded.log = every_kth(std::move(loaded.log), options.every);
  EarlierMap earlier;
  std::optional<ResultsFolder> folder;
  if (options.resume.empty()) {
    require_slam_outputs(folder.emplace(options.out).path());
  } else {
    earlier = read_earlier(options.resume);
  }
  const SlamRun result = map_log(options, loaded.log, earlier, session);
  if (result.join && result.join->agreeing == 0) { return report_not_found(options, result, session); }
  if (!folder) { require_slam_outputs(folder.emplace(options.out).path()); }
  write_slam_outputs(folder->path(), result, with_earlier(std::move(earlier), std::move(loaded.log)), session);
  write_json(session, slam_json(result));
  if (session.talks()) { print(options, result, loaded.report); }
  return exit_done;
}

}  // namespace

void add_slam(CLI::App& program, Session& session) {
  auto options = std::make_shared<SlamOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("LOG", options->log, "log of scans")->required();
    command.add_option("-o,--output", options->out, "folder for the results")->required();
    command.add_flag("--no-odometry", options->no_odometry, "do as if the log had no odometry");
    command
        .add_option("--window", options->window, "incremental mapping over the last N scans, no closures, no odometry")
        ->check(CLI::Range(1, 1000000));
    std::vector<std::string> front_ends;
    for (const auto& [kind, name] : enum_names(FrontEndKind{})) { front_ends.emplace_back(name); }
    command.add_option("--front-end", options->front_end, "how the motion between scans is found")
        ->check(CLI::IsMember(front_ends));
    command.add_option("--resume", options->resume,
                       "folder of an earlier flirt slam: find this log in its map, and make one map of both");
    command.add_option("--every", options->every, "use every K-th scan (default 1)")->check(CLI::Range(1, 1000000));
    options->params.add(command, "slam", options->slam);
    for (const std::string same : {"odometry", "window", "front-end"}) {
      command.get_option((same == "odometry" ? "--no-" : "--") + same)->excludes(command.get_option("--slam-" + same));
    }
  };
  CLI::App* command = add_command(
      program, session, "slam",
      "Make a consistent map of any log, with odometry or without. Nothing is drawn at random: --seed changes "
      "nothing.",
      "flirt slam run.log.gz -o run-map", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
