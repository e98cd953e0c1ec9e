#include "apps/flirt/bench_slam_dynamic.hpp"

#include "flirt/core/stopwatch.hpp"
#include "flirt/eval/cpu_time.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"
#include "flirt/sim/station.hpp"
#include "flirt/slam/slam.hpp"

#include "apps/flirt/error_json.hpp"
#include "apps/flirt/memory.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace flirt::app {
namespace {

ScanLog rush_hour(const std::string& place, const Session& session) {
  const bool tunnel = place == "tunnel";
  const World world = tunnel ? make_tunnel({}) : make_station({});
  SimulateParams params{.seed = session.seed, .threads = session.threads};
  params.drive.rounds = 1;
  params.people.count = tunnel ? 40 : 160;
  params.odometry.mode = OdometryMode::none;
  return value_or_quit(simulate(world, params)).log;
}

double way_of(const std::vector<Pose2>& poses) {
  double way = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) { way += distance(poses[i - 1], poses[i]); }
  return way;
}

DynamicRun run_place(const std::string& place, const ScanLog& log, const std::string& method,
                     const SlamMethods& methods, const Session& session) {
  DynamicRun run{.place = place, .method = method, .log = log};
  const MappingResult found =
      map_scans(log, method, OdometryUse::ignore, methods, session, progress_bar(session, place + " by " + method));
  const Pose2 truth_from_found = log.map_from_robot.front() * inverse(found.map_from_robot.front());
  std::vector<PosePair> pairs;
  pairs.reserve(log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    run.map_from_robot.push_back(truth_from_found * found.map_from_robot[i]);
    pairs.push_back({log.scans[i].stamp, run.map_from_robot[i], log.map_from_robot[i]});
  }
  run.way = way_of(log.map_from_robot);
  run.end_distance = distance(run.map_from_robot.back(), log.map_from_robot.back());
  run.end_degrees = degrees_from_radians(heading_difference(run.map_from_robot.back(), log.map_from_robot.back()));
  run.ate = absolute_error(pairs);
  run.cpu_seconds = found.cpu_seconds;
  return run;
}

/// `scans` scans of a robot that drives round after round through an office building.
ScanLog long_log(std::size_t scans, const Session& session) {
  const World world = make_office({});
  SimulateParams params{.seed = session.seed, .threads = session.threads};
  params.people.count = 10;
  const std::size_t two_rounds = value_or_quit(simulate(world, params)).log.scans.size();
  params.drive.rounds = static_cast<std::uint32_t>(2 * scans / two_rounds + 2);
  ScanLog log = value_or_quit(simulate(world, params)).log;
  log.scans.resize(std::min(log.scans.size(), scans));
  log.map_from_robot.resize(log.scans.size());
  return log;
}

std::vector<std::string> latency_cells(const std::string& name, const Latency& latency) {
  return {name, fmt::format("{:.2f}", latency.median), fmt::format("{:.2f}", latency.p99),
          fmt::format("{:.2f}", latency.worst)};
}

nlohmann::ordered_json latency_json(const Latency& latency) {
  return {{"median", latency.median}, {"p99", latency.p99}, {"worst", latency.worst}};
}

}  // namespace

std::vector<std::string> dynamic_places() {
  return {"tunnel", "station"};
}

std::vector<DynamicRun> run_dynamic(const std::vector<std::string>& places, const std::vector<std::string>& methods,
                                    const SlamMethods& methods_params, const Session& session) {
  std::vector<DynamicRun> runs;
  for (const std::string& place : places) {
    const ScanLog log = rush_hour(place, session);
    for (const std::string& method : methods) {
      if (method == "rbpf") { continue; }  // it has no window
      runs.push_back(run_place(place, log, method, methods_params, session));
    }
  }
  return runs;
}

TextTable dynamic_table(const std::vector<DynamicRun>& runs) {
  TextTable text{.header = {"place", "method", "scans", "way m", "end error m", "deg", "ATE m", "CPU s"}, .rows = {}};
  for (const DynamicRun& run : runs) {
    text.rows.push_back({run.place, run.method, std::to_string(run.log.scans.size()), fmt::format("{:.0f}", run.way),
                         fmt::format("{:.2f}", run.end_distance), fmt::format("{:.1f}", run.end_degrees),
                         fmt::format("{:.3f}", run.ate.translation.rmse), fmt::format("{:.2f}", run.cpu_seconds)});
  }
  return text;
}

nlohmann::ordered_json dynamic_json(const std::vector<DynamicRun>& runs) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const DynamicRun& run : runs) {
    json.push_back({{"place", run.place},
                    {"method", run.method},
                    {"scans", run.log.scans.size()},
                    {"way_m", run.way},
                    {"end_error_m", run.end_distance},
                    {"end_error_deg", run.end_degrees},
                    {"ate", error_json(run.ate)},
                    {"cpu_seconds", run.cpu_seconds}});
  }
  return json;
}

LongRun run_long(std::size_t scans, const SlamParams& params, const Session& session) {
  const ScanLog log = long_log(scans, session);
  const Progress progress = progress_bar(session, "long run");
  const double before = process_cpu_us();
  Slam slam(params);
  std::vector<double> ms;
  double early_mb = 0;
  const std::size_t quarter = log.scans.size() / 4;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    if (i == quarter) { early_mb = resident_mb(); }
    Stopwatch stopwatch;
    slam.add(log.scans[i]);
    ms.push_back(stopwatch.lap_us() * 1e-3);
    if (progress) { progress(static_cast<double>(i + 1) / static_cast<double>(log.scans.size())); }
  }
  const double grown_mb = resident_mb() - early_mb;
  std::vector<PosePair> pairs;
  pairs.reserve(log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    pairs.push_back({log.scans[i].stamp, slam.graph().map_from_node[i], log.map_from_robot[i]});
  }
  const auto at = [&](std::size_t i) { return ms.begin() + static_cast<std::ptrdiff_t>(i); };
  return {.scans = log.scans.size(),
          .all = latency_of(ms),
          .first_quarter = latency_of({ms.begin(), at(quarter)}),
          .last_quarter = latency_of({at(ms.size() - quarter), ms.end()}),
          .bytes_per_scan = grown_mb * 1024 * 1024 / static_cast<double>(std::max<std::size_t>(1, ms.size() - quarter)),
          .cpu_seconds = (process_cpu_us() - before) * 1e-6,
          .ate = absolute_error(pairs).translation.rmse};
}

TextTable long_table(const LongRun& run) {
  return {{fmt::format("{} scans, ms a scan", run.scans), "median", "99 %", "worst"},
          {latency_cells("all", run.all),
           latency_cells("first quarter", run.first_quarter),
           latency_cells("last quarter", run.last_quarter),
           {"memory, bytes a scan", fmt::format("{:.0f}", run.bytes_per_scan)},
           {"CPU s", fmt::format("{:.1f}", run.cpu_seconds)},
           {"ATE m", fmt::format("{:.3f}", run.ate)}}};
}

nlohmann::ordered_json long_json(const LongRun& run) {
  return {{"scans", run.scans},
          {"latency_ms",
           {{"all", latency_json(run.all)},
            {"first_quarter", latency_json(run.first_quarter)},
            {"last_quarter", latency_json(run.last_quarter)}}},
          {"bytes_per_scan", run.bytes_per_scan},
          {"cpu_seconds", run.cpu_seconds},
          {"ate_m", run.ate}};
}

}  // namespace flirt::app
