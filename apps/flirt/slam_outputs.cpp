#include "apps/flirt/slam_outputs.hpp"

#include "flirt/io/file.hpp"
#include "flirt/io/flirt_map.hpp"
#include "flirt/io/g2o.hpp"
#include "flirt/io/tum.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/report/html.hpp"

#include "apps/flirt/latency.hpp"
#include "apps/flirt/map_picture.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace flirt::app {
namespace {

std::vector<StampedPose> trajectory(const SlamRun& run, const ScanLog& log) {
  std::vector<StampedPose> poses;
  poses.reserve(log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    poses.push_back({log.scans[i].stamp, run.graph.map_from_node[i]});
  }
  return poses;
}

std::string figure(const SlamRun& run, const GridMapImage& map) {
  const std::vector<Pose2>& poses = run.graph.map_from_node;
  MapOverlay overlay{.way = poses};
  for (const PoseEdge& edge : run.graph.edges) {
    if (edge.kind != EdgeKind::loop) { continue; }
    overlay.closures.emplace_back(poses[edge.a].translation(), poses[edge.b].translation());
  }
  for (std::size_t i = 0; i < run.steps.size(); ++i) {
    if (run.steps[i].unobservable) { overlay.unseen.push_back(poses[run.earlier_scans + i].translation()); }
  }
  return map_picture(map, overlay);
}

std::vector<std::vector<std::string>> counts_table(const SlamRun& run) {
  const SlamSummary& s = run.summary;
  return {{"scans", std::to_string(s.scans)},
          {"odometry", run.odometry},
          {"closures", std::to_string(s.closures)},
          {"of them found by a search of the whole map", std::to_string(s.anywhere)},
          {"motions not observable in some direction", std::to_string(s.unobservable)},
          {"pieces of the map that only such motions hold together", std::to_string(s.pieces)},
          {"scans found by the wide search only", std::to_string(s.wide)},
          {"scans placed by prediction alone", std::to_string(s.predictions)},
          {"scans put elsewhere at the end", std::to_string(s.repaired)},
          {"pairs of scans aligned at the end", std::to_string(s.pairs)},
          {"their points from the other's lines, rms (m)", fmt::format("{:.4f}", s.pair_residual)}};
}

std::vector<std::vector<std::string>> times_table(const SlamRun& run) {
  const SlamTimes& t = run.summary.seconds;
  const Latency latency = latency_of(run.latency_ms);
  const auto seconds = [](double v) { return fmt::format("{:.3f}", v); };
  const auto ms = [](double v) { return fmt::format("{:.2f}", v); };
  return {{"points of the scans (s)", seconds(t.points)},
          {"motion between scans (s)", seconds(t.front_end)},
          {"search for earlier visits (s)", seconds(t.loops)},
          {"optimization (s)", seconds(t.optimize)},
          {"joint alignment at the end (s)", seconds(t.polish)},
          {"a scan, median (ms)", ms(latency.median)},
          {"a scan, 99 % (ms)", ms(latency.p99)},
          {"a scan, worst (ms)", ms(latency.worst)}};
}

std::string report(const SlamRun& run, const GridMapImage& map) {
  HtmlReport html("flirt slam: " + std::filesystem::path(run.log).filename().string());
  html.figure(figure(run, map), "Black: occupied. White: free. Grey: never seen.");
  if (run.summary.unobservable > 0) {
    html.paragraph(
        fmt::format("{} motions could not be seen in some direction (a bare corridor, or nothing in sight): "
                    "there the map's length is a guess, unless a closure corrected it.",
                    run.summary.unobservable));
  }
  html.heading("What was found");
  html.table({"", ""}, counts_table(run));
  html.heading("Times (wall clock)");
  html.table({"", ""}, times_table(run));
  return html.text();
}

}  // namespace

nlohmann::ordered_json slam_json(const SlamRun& run) {
  const SlamSummary& s = run.summary;
  const Latency latency = latency_of(run.latency_ms);
  nlohmann::ordered_json unobservable = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < run.steps.size(); ++i) {
    if (run.steps[i].unobservable) { unobservable.push_back(i); }
  }
  nlohmann::ordered_json json{
      {"log", run.log},
      {"scans", s.scans},
      {"odometry", run.odometry},
      {"front_end", run.front_end},
      {"closures", s.closures},
      {"closures_anywhere", s.anywhere},
      {"loop_edges", std::ranges::count(run.graph.edges, EdgeKind::loop, &PoseEdge::kind)},
      {"edges", run.graph.edges.size()},
      {"unobservable", {{"count", s.unobservable}, {"scans", unobservable}, {"pieces", s.pieces}}},
      {"fallbacks", {{"wide_search", s.wide}, {"prediction", s.predictions}}},
      {"structure", {{"featureless", s.featureless}, {"cluttered", s.cluttered}}},
      {"optimizations", s.optimizations},
      {"repaired", s.repaired},
      {"pairs", s.pairs},
      {"pair_residual_m", s.pair_residual},
      {"seconds",
       {{"points", s.seconds.points},
        {"front_end", s.seconds.front_end},
        {"loops", s.seconds.loops},
        {"optimize", s.seconds.optimize},
        {"polish", s.seconds.polish}}},
      {"latency_ms", {{"median", latency.median}, {"p99", latency.p99}, {"worst", latency.worst}}},
      {"params", run.params},
      {"seed", run.seed}};
  if (run.join) {
    json["resumed"] = {{"earlier_scans", run.earlier_scans},
                       {"queries", run.join->queries},
                       {"found", run.join->found},
                       {"agreeing", run.join->agreeing}};
  }
  json.update(provenance());
  return json;
}

void require_slam_outputs(const std::filesystem::path& folder) {
  for (const char* name : {"trajectory.tum", "session.tum", "graph.g2o", "map.yaml", "map.pgm", "map.png", "map.flirt",
                           "report.html", "summary.json"}) {
    value_or_quit(require_writable(folder / name));
  }
}

void write_slam_outputs(const std::filesystem::path& folder, const SlamRun& run, ScanLog log, const Session& session) {
  const std::vector<StampedPose> poses = trajectory(run, log);
  log.map_from_robot = run.graph.map_from_node;
  const GridMapImage map = map_of(log, log.map_from_robot, run.log);
  const PlaceMap places =
      value_or_quit(build_place_map(log, {}, session.threads, progress_bar(session, "features")), run.log);
  const std::string page = report(run, map);
  value_or_quit(write_tum(folder / "trajectory.tum", poses));
  if (run.join) {
    const auto first = poses.begin() + static_cast<std::ptrdiff_t>(run.earlier_scans);
    value_or_quit(write_tum(folder / "session.tum", {first, poses.end()}));
  }
  value_or_quit(write_g2o(folder / "graph.g2o", run.graph));
  value_or_quit(write_grid_map(folder / "map.yaml", map));
  value_or_quit(write_grey_image(folder / "map.png", map.image));
  value_or_quit(write_place_map(folder / "map.flirt", places));
  value_or_quit(write_file_atomically(folder / "report.html", page));
  value_or_quit(write_file_atomically(folder / "summary.json", json_text(slam_json(run))));
}

}  // namespace flirt::app
