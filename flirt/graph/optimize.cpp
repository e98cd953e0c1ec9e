#include "flirt/graph/optimize.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/graph/ceres_solver.hpp"
#include "flirt/graph/edge_error.hpp"
#include "flirt/graph/graduated.hpp"
#include "flirt/graph/toro.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace flirt {
namespace {

constexpr std::uint32_t iterations_per_round = 4;  // of graduated non-convexity: the next round's loss is near
constexpr double settled = 1e-6;                   // m or rad; a pass of toro that corrects no edge by more is the last

struct Outcome {
  std::uint32_t iterations{0};
  bool converged{false};
  std::vector<double> weight{};  ///< per edge, at the end
};

/// Weight 1 for motion edges, weight_of(chi2 of the edge) for loop edges.
template <class WeightOf>
std::vector<double> loop_weights(const PoseGraph& graph, const WeightOf& weight_of) {
  std::vector<double> weight(graph.edges.size(), 1.0);
  for (std::size_t k = 0; k < weight.size(); ++k) {
    if (graph.edges[k].kind == EdgeKind::loop) { weight[k] = weight_of(chi2(graph.edges[k], graph.map_from_node)); }
  }
  return weight;
}

std::vector<double> robust_weights(const PoseGraph& graph, const OptimizeParams& params) {
  return loop_weights(graph, [&](double s) { return robust_loss(params.loss, params.loss_width, s).first; });
}

double worst_loop(const PoseGraph& graph) {
  double worst = 0;
  for (const PoseEdge& edge : graph.edges) {
    if (edge.kind == EdgeKind::loop) { worst = std::max(worst, chi2(edge, graph.map_from_node)); }
  }
  return worst;
}

bool has_only_zeros_and_ones(const std::vector<double>& weight) {
  return std::all_of(weight.begin(), weight.end(), [](double w) { return w == 0 || w == 1; });
}

/// solve(weights, iterations) → {iterations, converged} moves the poses of `graph`.
template <class Solve>
Outcome graduated(PoseGraph& graph, const OptimizeParams& params, const Solve& solve) {
  const double limit = params.loss_width * params.loss_width;
  Graduation graduation = Graduation::from(params.graduated, limit, worst_loop(graph));
  std::uint32_t iterations = 0;
  const auto weights = [&] { return loop_weights(graph, [&](double s) { return graduation.weight(s); }); };
  for (; !graduation.is_last(); graduation = graduation.next()) {
    const std::vector<double> weight = weights();
    iterations += solve(weight, iterations_per_round).iterations;
    if (params.graduated == Graduated::truncated && has_only_zeros_and_ones(weight)) { break; }
  }
  const std::vector<double> weight = weights();
  const auto last = solve(weight, params.iterations);
  return {iterations + last.iterations, last.converged, weight};
}

Outcome by_ceres(PoseGraph& graph, const OptimizeParams& params) {
  if (params.graduated != Graduated::off) {
    CeresSolver solver(graph, params.fixed_node, RobustLoss::none, params.loss_width);
    return graduated(graph, params, [&](const std::vector<double>& weight, std::uint32_t iterations) {
      return solver.solve(weight, iterations, params.trust_radius);
    });
  }
  CeresSolver solver(graph, params.fixed_node, params.loss, params.loss_width);
  const auto [iterations, converged] =
      solver.solve(std::vector(graph.edges.size(), 1.0), params.iterations, params.trust_radius);
  return {iterations, converged, robust_weights(graph, params)};
}

Outcome by_toro(PoseGraph& graph, const OptimizeParams& params) {
  Toro toro(graph, params.fixed_node);
  const auto passes = [&](std::uint32_t iterations, const auto& weights) {
    const std::uint32_t late = iterations - std::max(1U, iterations / 10);
    double late_chi2 = 0;  // when nine tenths of the passes are done, or all but one
    for (std::uint32_t n = 0; n < iterations; ++n) {
      if (n == late) { late_chi2 = chi2(graph); }
      const double rate = Toro::rate(n, iterations);
      if (toro.pass(weights(), rate) < settled && rate >= 1) { return CeresSolver::Outcome{n + 1, true}; }
    }
    const bool is_flat = std::abs(late_chi2 - chi2(graph)) <= 0.01 * late_chi2;
    return CeresSolver::Outcome{iterations, is_flat};
  };
  if (params.graduated != Graduated::off) {
    return graduated(graph, params, [&](const std::vector<double>& weight, std::uint32_t iterations) {
      return passes(iterations, [&] { return weight; });
    });
  }
  const auto [iterations, converged] = passes(params.iterations, [&] { return robust_weights(graph, params); });
  return {iterations, converged, robust_weights(graph, params)};
}

void check(const PoseGraph& graph, const OptimizeParams& params) {
  const std::size_t n = graph.map_from_node.size();
  FLIRT_ASSERT(params.fixed_node < n);
  for (const PoseEdge& edge : graph.edges) {
    FLIRT_ASSERT(edge.a < n && edge.b < n);
    FLIRT_ASSERT(is_finite(edge.a_from_b) && edge.information.allFinite());
  }
}

}  // namespace

OptimizeSummary optimize(PoseGraph& graph, const OptimizeParams& params) {
  const auto start = std::chrono::steady_clock::now();
  if (graph.map_from_node.empty()) { return {.converged = true}; }
  check(graph, params);
  OptimizeSummary summary{.initial_chi2 = chi2(graph)};
  const Outcome outcome = params.backend == Backend::ceres ? by_ceres(graph, params) : by_toro(graph, params);
  summary.iterations = outcome.iterations;
  summary.converged = outcome.converged;
  for (std::uint32_t k = 0; k < graph.edges.size(); ++k) {
    const bool is_rejected = graph.edges[k].kind == EdgeKind::loop && outcome.weight[k] < 0.5;
    if (is_rejected) { summary.rejected.push_back(k); }
    if (!is_rejected) { summary.final_chi2 += chi2(graph.edges[k], graph.map_from_node); }
  }
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return summary;
}

}  // namespace flirt
