// flirt/graph/ceres_solver.hpp: weighted least squares over a pose graph by Ceres. Internal to flirt/graph; use
// flirt/graph/optimize.hpp.
#pragma once

#include "flirt/graph/pose_graph.hpp"
#include "flirt/graph/robust.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace flirt {

/// The problem stays built from one solve to the next; only weights change.
class CeresSolver {
 public:
  /// `graph` must outlive the solver. `fixed_node` and the roots of other parts of the graph stay. `loss` is that of
  /// loop edges.
  CeresSolver(PoseGraph& graph, std::uint32_t fixed_node, RobustLoss loss, double loss_width);
  ~CeresSolver();
  CeresSolver(const CeresSolver&) = delete;
  CeresSolver& operator=(const CeresSolver&) = delete;
  CeresSolver(CeresSolver&&) = delete;
  CeresSolver& operator=(CeresSolver&&) = delete;

  struct Outcome {
    std::uint32_t iterations{0};
    bool converged{false};
  };
  /// Moves the graph's poses. `weight` is one factor per edge, `trust_radius` as in OptimizeParams.
  Outcome solve(std::span<const double> weight, std::uint32_t iterations, double trust_radius);

 private:
  struct Problem;
  std::unique_ptr<Problem> problem_;
};

}  // namespace flirt
