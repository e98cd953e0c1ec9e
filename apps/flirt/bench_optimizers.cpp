// apps/flirt/bench_optimizers.cpp: `flirt bench optimizers`, the pose-graph back-ends on the graphs that logs hold.
#include "flirt/eval/cpu_time.hpp"
#include "flirt/eval/trajectory_metrics.hpp"
#include "flirt/graph/edge_error.hpp"
#include "flirt/graph/optimize.hpp"
#include "flirt/graph/spanning_tree.hpp"
#include "flirt/io/toro_graph.hpp"

#include "apps/flirt/command.hpp"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace flirt::app {
namespace {

struct BenchOptimizersOptions {
  std::vector<std::string> logs;
  OptimizeParams optimize;
  ParamFlags params;
};

/// The file's own poses are the truth; the index stands for the stamp.
TrajectoryError error_against(const std::vector<Pose2>& published, const PoseGraph& graph) {
  std::vector<PosePair> pairs;
  pairs.reserve(published.size());
  for (std::size_t i = 0; i < published.size(); ++i) {
    pairs.push_back({static_cast<double>(i), graph.map_from_node[i], published[i]});
  }
  return absolute_error(pairs);
}

nlohmann::ordered_json short_error_json(const TrajectoryError& error) {
  return {
      {"ate_m", error.translation.rmse}, {"max_m", error.translation.max}, {"ate_deg", error.rotation_degrees.rmse}};
}

nlohmann::ordered_json run_backend(const BenchOptimizersOptions& options, Backend backend, const PoseGraph& start,
                                   const std::vector<Pose2>& published) {
  PoseGraph graph = start;
  OptimizeParams params = options.optimize;
  params.backend = backend;
  const double before = process_cpu_us();
  const OptimizeSummary summary = optimize(graph, params);
  const double seconds = (process_cpu_us() - before) * 1e-6;
  nlohmann::ordered_json json{{"backend", to_string(backend)},    {"cpu_seconds", seconds},
                              {"wall_seconds", summary.seconds},  {"iterations", summary.iterations},
                              {"converged", summary.converged},   {"initial_chi2", summary.initial_chi2},
                              {"final_chi2", summary.final_chi2}, {"rejected", summary.rejected.size()}};
  json.update(short_error_json(error_against(published, graph)));
  return json;
}

nlohmann::ordered_json bench_log(const BenchOptimizersOptions& options, const std::string& log) {
  const GraphFile file = value_or_quit(read_toro_graph(log));
  if (const std::size_t nodes = file.graph.map_from_node.size(); options.optimize.fixed_node >= nodes) {
    throw UsageError(fmt::format("--optimize-fixed-node: expected less than the {} nodes of {}, found {}", nodes, log,
                                 options.optimize.fixed_node));
  }
  PoseGraph start = file.graph;
  chain_motion(start);
  nlohmann::ordered_json json{{"log", log},
                              {"nodes", start.map_from_node.size()},
                              {"edges", start.edges.size()},
                              {"chi2_of_published", chi2(file.graph)},
                              {"start", short_error_json(error_against(file.graph.map_from_node, start))},
                              {"runs", nlohmann::ordered_json::array()}};
  for (const Backend backend : {Backend::ceres, Backend::toro}) {
    json["runs"].push_back(run_backend(options, backend, start, file.graph.map_from_node));
  }
  return json;
}

void print(const nlohmann::ordered_json& log) {
  fmt::print("{}: {} nodes, {} edges, start {:.3f} m off\n", log["log"].get<std::string>(), log["nodes"].get<int>(),
             log["edges"].get<int>(), log["start"]["ate_m"].get<double>());
  for (const auto& row : log["runs"]) {
    fmt::print("  {:<6} ATE {:.4f} m  {:.3f} deg  chi2 {:.1f} -> {:.1f}  {} iterations{}  {:.3f} s\n",
               row["backend"].get<std::string>(), row["ate_m"].get<double>(), row["ate_deg"].get<double>(),
               row["initial_chi2"].get<double>(), row["final_chi2"].get<double>(), row["iterations"].get<int>(),
               row["converged"].get<bool>() ? "" : " (not settled)", row["cpu_seconds"].get<double>());
  }
}

int run(const BenchOptimizersOptions& options, const Session& session) {
  options.params.resolve(session);
  nlohmann::ordered_json json{{"logs", nlohmann::ordered_json::array()}};
  for (const std::string& log : options.logs) {
    json["logs"].push_back(bench_log(options, log));
    if (session.talks()) { print(json["logs"].back()); }
  }
  json["params"] = options.params.json();
  json.update(provenance());
  write_json(session, json);
  return exit_done;
}

}  // namespace

void add_bench_optimizers(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchOptimizersOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("LOG", options->logs, "logs or graphs with VERTEX2 and EDGE2 lines; their poses are the truth")
        ->required();
    options->params.add(command, "optimize", options->optimize, {"backend"});
  };
  CLI::App* command = add_command(
      bench, session, "optimizers", "Pose-graph back-ends on a file's own graph, from its chained motion edges.",
      "flirt bench optimizers flirtlib-fr079.log.gz flirtlib-intel-lab.log.gz", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
