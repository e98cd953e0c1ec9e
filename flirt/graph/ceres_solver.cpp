#include "flirt/graph/ceres_solver.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/graph/edge_error.hpp"
#include "flirt/graph/spanning_tree.hpp"

#include <Eigen/Eigenvalues>
#include <ceres/ceres.h>

#include <array>
#include <deque>
#include <vector>

namespace flirt {
namespace {

/// S with Sᵀ S = information, also when some direction was not measured at all.
Eigen::Matrix3d square_root(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

class EdgeCost final : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  explicit EdgeCost(const PoseEdge& edge) : edge_(edge), root_(square_root(edge.information)) {}

  bool Evaluate(const double* const* poses, double* residuals, double** jacobians) const override {
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const Pose2 map_from_a{poses[0][0], poses[0][1], poses[0][2]};
    const Pose2 map_from_b{poses[1][0], poses[1][1], poses[1][2]};
    const LinearizedEdge linear = linearize(edge_, map_from_a, map_from_b);
    Eigen::Map<Eigen::Vector3d> residual(residuals);
    residual = root_ * linear.error;
    if (jacobians == nullptr) { return true; }
    const auto give = [this](double* jacobian, const Eigen::Matrix3d& derivative) {
      if (jacobian != nullptr) { Eigen::Map<RowMajor>{jacobian} = root_ * derivative; }
    };
    give(jacobians[0], linear.by_a);
    give(jacobians[1], linear.by_b);
    return true;
  }

 private:
  const PoseEdge& edge_;
  Eigen::Matrix3d root_;
};

class EdgeLoss final : public ceres::LossFunction {
 public:
  EdgeLoss(RobustLoss loss, double width) : loss_(loss), width_(width) {}

  void set_weight(double weight) { weight_ = weight; }
  void Evaluate(double s, double* rho) const override {
    const LossValue loss = robust_loss(loss_, width_, s);
    rho[0] = weight_ * loss.value;
    rho[1] = weight_ * loss.first;
    rho[2] = weight_ * loss.second;
  }

 private:
  RobustLoss loss_;
  double width_;
  double weight_{1};
};

ceres::Problem::Options ours_to_keep() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

ceres::Solver::Options solver_options(std::uint32_t iterations, double trust_radius) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // no BLAS, whose threads could change the sums
  options.num_threads = 1;
  options.max_num_iterations = static_cast<int>(iterations);
  options.function_tolerance = 1e-9;
  options.initial_trust_region_radius = trust_radius;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

struct CeresSolver::Problem {
  PoseGraph& graph;
  std::vector<std::array<double, 3>> poses;
  std::deque<EdgeCost> costs;  // Ceres keeps their addresses
  std::deque<EdgeLoss> losses;
  ceres::Problem problem;
};

CeresSolver::CeresSolver(PoseGraph& graph, std::uint32_t fixed_node, RobustLoss loss, double loss_width)
    : problem_(new Problem{graph,
                           std::vector<std::array<double, 3>>(graph.map_from_node.size()),
                           {},
                           {},
                           ceres::Problem(ours_to_keep())}) {
  Problem& p = *problem_;
  for (auto& pose : p.poses) { p.problem.AddParameterBlock(pose.data(), 3); }
  for (const PoseEdge& edge : graph.edges) {
    p.costs.emplace_back(edge);
    p.losses.emplace_back(edge.kind == EdgeKind::loop ? loss : RobustLoss::none, loss_width);
    if (edge.a == edge.b) { continue; }
    p.problem.AddResidualBlock(&p.costs.back(), &p.losses.back(), p.poses[edge.a].data(), p.poses[edge.b].data());
  }
  const SpanningTree tree = spanning_tree(graph, fixed_node);
  for (std::size_t node = 0; node < p.poses.size(); ++node) {
    if (tree.parent[node] == no_node) { p.problem.SetParameterBlockConstant(p.poses[node].data()); }
  }
}

CeresSolver::~CeresSolver() = default;

CeresSolver::Outcome CeresSolver::solve(std::span<const double> weight, std::uint32_t iterations, double trust_radius) {
  Problem& p = *problem_;
  FLIRT_ASSERT(weight.size() == p.losses.size());
  for (std::size_t k = 0; k < p.losses.size(); ++k) { p.losses[k].set_weight(weight[k]); }
  for (std::size_t i = 0; i < p.poses.size(); ++i) {
    const Pose2& pose = p.graph.map_from_node[i];
    p.poses[i] = {pose.x, pose.y, pose.theta};
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(iterations, trust_radius), &p.problem, &summary);
  for (std::size_t i = 0; i < p.poses.size(); ++i) {
    const auto& [x, y, theta] = p.poses[i];
    p.graph.map_from_node[i] = {x, y, wrap_angle(theta)};
  }
  const auto steps = summary.num_successful_steps + summary.num_unsuccessful_steps;
  return {static_cast<std::uint32_t>(steps > 0 ? steps - 1 : 0),  // Ceres counts the start as a step
          summary.termination_type == ceres::CONVERGENCE};
}

}  // namespace flirt
