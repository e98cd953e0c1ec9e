// apps/flirt/evaluate.cpp: `flirt evaluate`, how good a trajectory is.
#include "flirt/eval/map_quality.hpp"
#include "flirt/eval/trajectory_metrics.hpp"
#include "flirt/io/format.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/relations.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/error_json.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace flirt::app {
namespace {

struct EvaluateOptions {
  std::string estimate;
  std::string truth;
  std::string relations;
  std::string scans;
  double stamp_tolerance{0.0005};  ///< s
  double rpe_path{1.0};            ///< m
  MapQualityParams quality;
  ParamFlags params;
};

void print_row(std::string_view name, const TrajectoryError& error) {
  const auto text = [](const ErrorSummary& e, std::string_view unit) {
    if (e.count == 0) { return std::string("nothing to compare"); }
    return fmt::format("rmse {:.4f}  mean {:.4f} ± {:.4f}  median {:.4f}  max {:.4f} {}", e.rmse, e.mean, e.deviation,
                       e.median, e.max, unit);
  };
  fmt::print("  {:<22} {}\n  {:<22} {}\n", name, text(error.translation, "m"), "", text(error.rotation_degrees, "deg"));
}

void print_relations(const RelationsError& error, std::string_view source) {
  fmt::print("{} relations: {} with both stamps, {} skipped\n", source, error.difference.translation.count,
             error.skipped);
  print_row("component difference", error.difference);
  print_row("found * 1/expected", error.motion);
}

/// ATE, RPE and derived relations.
nlohmann::ordered_json against_truth(const EvaluateOptions& options, const Session& session,
                                     const std::vector<StampedPose>& estimate) {
  const std::vector<StampedPose> truth = value_or_quit(read_trajectory(options.truth));
  const PairedTrajectory paired = pairs_by_stamp(estimate, truth, options.stamp_tolerance);
  if (paired.pairs.empty()) {
    throw BadInput(fmt::format("{}: expected stamps of {} (within {} s), found none of them", options.estimate,
                               options.truth, options.stamp_tolerance));
  }
  const TrajectoryError ate = absolute_error(paired.pairs);
  const TrajectoryError rpe = relative_error(paired.pairs, options.rpe_path);
  const RelationsError derived =
      relations_error(estimate, derive_relations(truth, session.seed), options.stamp_tolerance);
  if (session.talks()) {
    fmt::print("{} poses with a true one, {} without\n", paired.pairs.size(), paired.skipped);
    print_row("ATE, aligned", ate);
    print_row(fmt::format("RPE over {:g} m", options.rpe_path), rpe);
    print_relations(derived, "derived");
  }
  return {{"truth", options.truth},
          {"pairs", paired.pairs.size()},
          {"skipped", paired.skipped},
          {"ate", error_json(ate)},
          {"rpe_path_m", options.rpe_path},
          {"rpe", error_json(rpe)},
          {"derived_relations", relations_json(derived, "derived")}};
}

nlohmann::ordered_json against_relations(const EvaluateOptions& options, const Session& session,
                                         const std::vector<StampedPose>& estimate) {
  const std::vector<Relation> relations = value_or_quit(read_relations(options.relations));
  const RelationsError error = relations_error(estimate, relations, options.stamp_tolerance);
  if (error.difference.translation.count == 0) {
    throw BadInput(fmt::format("{}: expected relations between stamps of {} (within {} s), found none of them",
                               options.relations, options.estimate, options.stamp_tolerance));
  }
  if (session.talks()) { print_relations(error, "official"); }
  return relations_json(error, "official");
}

/// The scans that the estimate has a pose for, with those poses.
ScanLog posed_scans(const EvaluateOptions& options, const Session& session, const std::vector<StampedPose>& estimate) {
  LoadedLog loaded = value_or_quit(read_log(options.scans, {}, progress_bar(session, "reading")));
  std::vector<StampedPose> scans;
  scans.reserve(loaded.log.scans.size());
  for (std::size_t i = 0; i < loaded.log.scans.size(); ++i) {
    scans.push_back({loaded.log.scans[i].stamp, {static_cast<double>(i), 0, 0}});  // x carries the index
  }
  ScanLog posed;
  for (const PosePair& pair : pairs_by_stamp(estimate, scans, options.stamp_tolerance).pairs) {
    posed.scans.push_back(std::move(loaded.log.scans[static_cast<std::size_t>(pair.truth.x)]));
    posed.map_from_robot.push_back(pair.estimate);
  }
  return posed;
}

nlohmann::ordered_json without_truth(const EvaluateOptions& options, const Session& session,
                                     const std::vector<StampedPose>& estimate) {
  const ScanLog log = posed_scans(options, session, estimate);
  if (log.scans.empty()) {
    throw BadInput(fmt::format("{}: expected scans at the stamps of {} (within {} s), found none of them",
                               options.scans, options.estimate, options.stamp_tolerance));
  }
  const MapQuality quality = map_quality(log, log.map_from_robot, options.quality, session.threads);
  if (session.talks()) {
    const std::string sharpness = quality.pairs == 0
                                      ? "nothing to compare"
                                      : fmt::format("rms {:.4f} m over {} pairs of scans, {} points",
                                                    quality.point_to_line_rms, quality.pairs, quality.points);
    fmt::print("{} scans with a pose\n  point to line          {}\n  occupied cells         {} of {:g} m\n",
               log.scans.size(), sharpness, quality.occupied_cells, options.quality.cell_size);
  }
  nlohmann::ordered_json json{{"log", options.scans}, {"scans", log.scans.size()}};
  json.update(quality_json(quality));
  return json;
}

int run(EvaluateOptions& options, const Session& session) {
  if (options.truth.empty() && options.relations.empty() && options.scans.empty()) {
    throw UsageError("evaluate: expected --truth, --relations or --scans to evaluate against, found none");
  }
  options.params.resolve(session, {"quality"});
  const std::vector<StampedPose> estimate = value_or_quit(read_trajectory(options.estimate));
  nlohmann::ordered_json json{
      {"estimate", options.estimate}, {"poses", estimate.size()}, {"stamp_tolerance_s", options.stamp_tolerance}};
  if (session.talks()) { fmt::print("{}: {} poses\n", options.estimate, estimate.size()); }
  if (!options.truth.empty()) { json.update(against_truth(options, session, estimate)); }
  if (!options.relations.empty()) { json["relations"] = against_relations(options, session, estimate); }
  if (!options.scans.empty()) { json["map_quality"] = without_truth(options, session, estimate); }
  json["params"] = options.params.json();
  json["seed"] = session.seed;
  json.update(provenance());
  write_json(session, json);
  return exit_done;
}

}  // namespace

void add_evaluate(CLI::App& program, Session& session) {
  auto options = std::make_shared<EvaluateOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("EST", options->estimate, "trajectory: TUM file, or log with poses")->required();
    command.add_option("--truth", options->truth, "true poses, TUM file or log: ATE, RPE, derived relations");
    command.add_option("--relations", options->relations, "file of relations: stamp1 stamp2 x y z roll pitch yaw");
    command.add_option("--scans", options->scans, "log with the scans: how well they fit each other at these poses");
    command
        .add_option("--stamp-tolerance", options->stamp_tolerance,
                    "s; stamps that differ by no more are the same moment (default 0.0005)")
        ->check(expect_at_least_0);
    command.add_option("--rpe-path", options->rpe_path, "m of the way that the relative error is over (default 1)")
        ->check(expect_above_0);
    options->params.add(command, "quality", options->quality);
  };
  CLI::App* command = add_command(
      program, session, "evaluate", "How good a trajectory is: against true poses, relations, or its own scans.",
      "flirt evaluate trajectory.tum --truth corrected.log.gz --scans run.log.gz", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
