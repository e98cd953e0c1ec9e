#include "apps/flirt/bench_slam_run.hpp"

#include "flirt/core/rng.hpp"
#include "flirt/core/stopwatch.hpp"
#include "flirt/eval/cpu_time.hpp"
#include "flirt/slam/rbpf.hpp"
#include "flirt/slam/slam.hpp"

#include "apps/flirt/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace flirt::app {
namespace {

/// Times `add` for each scan.
template <class Mapper>
void add_all(Mapper& mapper, const ScanLog& log, MappingResult& result, const Progress& progress) {
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    Stopwatch stopwatch;
    mapper.add(log.scans[i]);
    result.latency_ms.push_back(stopwatch.lap_us() * 1e-3);
    if (progress) { progress(static_cast<double>(i + 1) / static_cast<double>(log.scans.size())); }
  }
}

void map_by_graph(const ScanLog& log, const SlamParams& params, MappingResult& result, const Progress& progress) {
  Slam slam(params);
  add_all(slam, log, result, progress);
  slam.finish();
  result.map_from_robot = slam.graph().map_from_node;
  result.has_loops = params.window == 0;
  for (const PoseEdge& edge : slam.graph().edges) {
    if (edge.kind != EdgeKind::loop) { continue; }
    result.loop_nodes.emplace_back(edge.a, edge.b);
    result.loop_motions.push_back(edge.a_from_b);
  }
}

std::vector<StampedPose> stamped(const ScanLog& log, const std::vector<Pose2>& map_from_robot) {
  std::vector<StampedPose> poses;
  poses.reserve(log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) { poses.push_back({log.scans[i].stamp, map_from_robot[i]}); }
  return poses;
}

/// Against truth, relations, and the scans themselves.
void judge(SlamRow& row, const SlamInput& input, const Session& session) {
  const std::vector<StampedPose> estimate = stamped(input.log, row.map_from_robot);
  if (!input.relations.empty()) { row.relations = relations_error(estimate, input.relations); }
  if (!input.truth.empty() && row.method != "corrected") {
    const PairedTrajectory paired = pairs_by_stamp(estimate, input.truth);
    if (paired.pairs.empty()) { throw BadInput(input.file + ": expected scans with stamps of the truth, found none"); }
    row.ate = absolute_error(paired.pairs);
    row.rpe = relative_error(paired.pairs);
    if (!row.relations || row.relations->difference.translation.count == 0) {
      std::vector<StampedPose> truth;
      truth.reserve(paired.pairs.size());
      for (const PosePair& pair : paired.pairs) { truth.push_back({pair.stamp, pair.truth}); }
      row.relations = relations_error(estimate, derive_relations(truth, session.seed));
      row.relations_source = "derived";
    }
  }
  row.quality = map_quality(input.log, row.map_from_robot, {.seed = session.seed}, session.threads);
}

Closures judge_closures(const MappingResult& found, const std::vector<Pose2>& truth) {
  constexpr double most_distance = 0.5;  // m
  const double most_turn = radians_from_degrees(10);
  Closures closures{.accepted = found.loop_nodes.size()};
  for (std::size_t i = 0; i < found.loop_nodes.size() && !truth.empty(); ++i) {
    const auto [a, b] = found.loop_nodes[i];
    const Pose2 expected = inverse(truth[a]) * truth[b];
    const bool wrong = distance(expected, found.loop_motions[i]) > most_distance ||
                       heading_difference(expected, found.loop_motions[i]) > most_turn;
    closures.wrong += wrong ? 1 : 0;
  }
  return closures;
}

}  // namespace

std::vector<std::string> slam_methods() {
  std::vector<std::string> names;
  for (const auto& [kind, name] : enum_names(FrontEndKind{})) { names.emplace_back(name); }
  names.emplace_back("rbpf");
  return names;
}

MappingResult map_scans(const ScanLog& log, const std::string& method, OdometryUse odometry, SlamMethods methods,
                        const Session& session, const Progress& progress) {
  MappingResult result;
  forget_peak();
  const double before = process_cpu_us();
  if (method == "rbpf") {
    methods.rbpf.odometry = odometry;
    Rbpf filter(methods.rbpf, session.seed, session.threads);
    add_all(filter, log, result, progress);
    result.map_from_robot = filter.trajectory();
  } else {
    methods.slam.odometry = odometry;
    for (const auto& [kind, name] : enum_names(FrontEndKind{})) {
      if (name == method) { methods.slam.front_end = kind; }
    }
    map_by_graph(log, methods.slam, result, progress);
  }
  result.cpu_seconds = (process_cpu_us() - before) * 1e-6;
  result.memory_mb = peak_mb();
  return result;
}

SlamRow run_method(const SlamInput& input, const std::string& method, OdometryUse odometry, const SlamMethods& methods,
                   const Session& session) {
  const MappingResult found =
      map_scans(input.log, method, odometry, methods, session, progress_bar(session, input.name + " by " + method));
  SlamRow row{.method = method,
              .odometry = odometry == OdometryUse::use ? input.odometry : "none",
              .map_from_robot = found.map_from_robot,
              .cpu_seconds = found.cpu_seconds,
              .latency = latency_of(found.latency_ms),
              .memory_mb = found.memory_mb};
  for (const auto& [a, b] : found.loop_nodes) {
    row.closure_lines.emplace_back(found.map_from_robot[a].translation(), found.map_from_robot[b].translation());
  }
  if (found.has_loops) { row.closures = judge_closures(found, input.corrected); }
  judge(row, input, session);
  return row;
}

std::vector<SlamRow> rows_of_log(const SlamInput& input, const Session& session) {
  std::vector<SlamRow> rows;
  if (!input.corrected.empty()) {
    rows.push_back({.method = "corrected", .odometry = "none", .map_from_robot = input.corrected, .mapped = false});
  }
  const bool complete =
      std::ranges::all_of(input.log.scans, [](const Scan& scan) { return scan.odom_from_robot.has_value(); });
  if (complete && !input.log.scans.empty()) {
    rows.push_back({.method = "odometry", .odometry = input.odometry, .mapped = false});
    for (const Scan& scan : input.log.scans) { rows.back().map_from_robot.push_back(*scan.odom_from_robot); }
  }
  for (SlamRow& row : rows) { judge(row, input, session); }
  return rows;
}

JitteredStarts run_starts(const SlamInput& input, const std::string& method, std::size_t starts,
                          const SlamMethods& methods, const Session& session) {
  constexpr double reach = 10;  // m
  JitteredStarts result{.name = input.name, .method = method};
  for (std::size_t i = 0; i < starts; ++i) {
    Rng rng(session.seed, i);
    SlamMethods moved = methods;
    moved.slam.start_x = rng.uniform(-reach, reach);
    moved.slam.start_y = rng.uniform(-reach, reach);
    moved.slam.start_theta = rng.uniform(-std::numbers::pi, std::numbers::pi);
    moved.rbpf.start_x = moved.slam.start_x;
    moved.rbpf.start_y = moved.slam.start_y;
    moved.rbpf.start_theta = moved.slam.start_theta;
    const MappingResult found =
        map_scans(input.log, method, OdometryUse::ignore, moved, session,
                  progress_bar(session, fmt::format("{}, start {} of {}", input.name, i + 1, starts)));
    const auto pairs = pairs_by_stamp(stamped(input.log, found.map_from_robot), input.truth).pairs;
    result.ate.push_back(absolute_error(pairs).translation.rmse);
  }
  std::vector<double> sorted = result.ate;
  std::ranges::sort(sorted);
  result.bound = input.bound.value_or(sorted.empty() ? 0 : 1.2 * sorted[sorted.size() / 2]);
  result.kept =
      static_cast<std::size_t>(std::ranges::count_if(result.ate, [&](double ate) { return ate <= result.bound; }));
  return result;
}

}  // namespace flirt::app
