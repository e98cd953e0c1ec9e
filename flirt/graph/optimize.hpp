// flirt/graph/optimize.hpp: the poses that agree best with all measurements of a pose graph.
//
//   PoseGraph graph = ...;                                        // poses near enough, or chain_motion(graph)
//   const OptimizeSummary summary = optimize(graph, {.graduated = Graduated::truncated});
//   for (const std::uint32_t edge : summary.rejected) { ... }     // loop edges that the others contradict
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/graph/pose_graph.hpp"
#include "flirt/graph/robust.hpp"

#include <array>
#include <concepts>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

enum class Backend : std::uint8_t {
  ceres,  ///< sparse least squares (Levenberg–Marquardt): the exact minimum next to the start
  toro,   ///< flirt/graph/toro.hpp: stochastic gradient descent over a tree, forgiving about the start
};
constexpr auto enum_names(Backend /*tag*/) {
  return std::array{std::pair{Backend::ceres, std::string_view("ceres")},
                    std::pair{Backend::toro, std::string_view("toro")}};
}

/// Graduated non-convexity (Yang, Antonante, Tzoumas and Carlone 2020): loop edges are weighted by a loss that starts
/// nearly convex and ends bounded, so that a bad start and wrong loops can be had at once.
enum class Graduated : std::uint8_t {
  off,
  geman_mcclure,  ///< ends as Geman and McClure's loss
  truncated,      ///< ends as truncated least squares: an edge counts fully or not at all
};
constexpr auto enum_names(Graduated /*tag*/) {
  using enum Graduated;
  return std::array<std::pair<Graduated, std::string_view>, 3>{
      {{off, "off"}, {geman_mcclure, "geman-mcclure"}, {truncated, "truncated"}}};
}

struct OptimizeParams {
  Backend backend{Backend::ceres};      ///< method
  std::uint32_t iterations{100};        ///< at most; under `graduated` in its last round
  RobustLoss loss{RobustLoss::none};    ///< of loop edges; not used under `graduated`
  double loss_width{3.37};              ///< Mahalanobis distance where the loss bends: √χ²₃ at 0.99
  Graduated graduated{Graduated::off};  ///< weights of loop edges by graduated non-convexity
  std::uint32_t fixed_node{0};          ///< keeps its pose; other parts of the graph keep their first node's
  /// Of ceres' first step: the normal equations' diagonal grows by its inverse. A small one goes carefully where the
  /// start is bad. But a long chain's weakest bend is so weak that this holds it: from near the minimum, give
  /// `undamped`.
  double trust_radius{1e4};
};
constexpr double undamped = 1e10;  ///< a trust radius; steps are those of Gauss and Newton while they help

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, OptimizeParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.backend, Field{"backend", "", "method that finds the poses"});
  visit(params.iterations, Field{"iterations", "", "at most; of graduated non-convexity in its last round", 1, 1e6});
  visit(params.loss, Field{"loss", "", "robust loss of loop edges"});
  visit(params.loss_width, Field{"loss_width", "1", "Mahalanobis distance where the loss bends", 1e-3, 1e6});
  visit(params.graduated, Field{"graduated", "", "graduated non-convexity on loop edges"});
  visit(params.fixed_node, Field{"fixed_node", "", "keeps its pose"});
  visit(params.trust_radius, Field{"trust_radius", "1", "of the first step of ceres; large: Gauss-Newton", 1e-3, 1e15});
}

struct OptimizeSummary {
  double initial_chi2{0};  ///< over all edges
  double final_chi2{0};    ///< over all edges that were not rejected
  std::uint32_t iterations{0};
  bool converged{false};  ///< at a minimum; toro: the last tenth of its passes, one at least, changed χ² by ≤ 1 %
  std::vector<std::uint32_t> rejected{};  ///< indices of loop edges with a final weight below one half
  double seconds{0};                      ///< wall clock; the one field that differs from run to run
};

/// Moves the poses of `graph` to the (robust) minimum of Σ errorᵀ · information · error near where they are. One
/// thread; the same input gives the same poses. Edges must name nodes of the graph, with finite measurements and
/// positive semi-definite information. Per iteration: ceres O(fill-in of the sparse factor), toro O(Σ path lengths).
OptimizeSummary optimize(PoseGraph& graph, const OptimizeParams& params = {});

}  // namespace flirt
