#include "flirt/slam/gauss_newton.hpp"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace flirt {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

struct Linearized {
  Eigen::Vector3d error;
  Eigen::Matrix3d by_a;
  Eigen::Matrix3d by_b;
};

/// Error of an edge and its derivatives by steps of the two poses in their own frames.
Linearized linearize(const PoseEdge& edge, const Pose2& map_from_a, const Pose2& map_from_b) {
  const Pose2 a_from_b = inverse(map_from_a) * map_from_b;
  const Pose2 off = inverse(edge.a_from_b) * a_from_b;
  const double c = std::cos(off.theta);
  const double s = std::sin(off.theta);
  Linearized out;
  out.error << off.x, off.y, off.theta;
  out.by_b << c, -s, 0, s, c, 0, 0, 0, 1;
  const double measured_c = std::cos(edge.a_from_b.theta);
  const double measured_s = std::sin(edge.a_from_b.theta);
  // A step (u, v, w) of a moves b as seen from a by −(u, v) − w × t.
  const double x = a_from_b.x;
  const double y = a_from_b.y;
  Eigen::Matrix<double, 2, 3> in_a;
  in_a << -1, 0, y, 0, -1, -x;
  Eigen::Matrix2d measured_from_a;
  measured_from_a << measured_c, measured_s, -measured_s, measured_c;
  out.by_a.topRows<2>() = measured_from_a * in_a;
  out.by_a.row(2) << 0, 0, -1;
  return out;
}

double robust_weight(const PoseEdge& edge, const Eigen::Vector3d& error) {
  if (edge.kind != EdgeKind::loop) { return 1; }
  constexpr double scale = 30;
  const double root = 1 / (1 + error.dot(edge.information * error) / scale);
  return root * root;
}

void add_block(std::vector<Eigen::Triplet<double>>& entries, std::uint32_t row, std::uint32_t column,
               const Eigen::Matrix3d& block) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto r = static_cast<int>(3 * row) + i;
      const auto k = static_cast<int>(3 * column) + j;
      if (r >= k) { entries.emplace_back(r, k, block(i, j)); }
    }
  }
}

}  // namespace

GaussNewtonSummary gauss_newton(PoseGraph& graph, std::size_t steps) {
  constexpr std::size_t trusting_steps = 2;
  GaussNewtonSummary summary;
  const auto size = static_cast<Eigen::Index>(3 * graph.map_from_node.size());
  if (graph.map_from_node.size() < 2) { return summary; }
  Eigen::SimplicialLDLT<Sparse> solver;
  for (std::size_t step = 0; step < steps; ++step) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(graph.edges.size() * 36);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
    for (const PoseEdge& edge : graph.edges) {
      const Linearized at = linearize(edge, graph.map_from_node[edge.a], graph.map_from_node[edge.b]);
      // The first steps bring the poses to where the closures want them; only then it shows which of them are alone.
      const double weight = step < trusting_steps ? 1.0 : robust_weight(edge, at.error);
      const Eigen::Matrix3d information = weight * edge.information;
      const Eigen::Matrix3d by_a = at.by_a.transpose() * information;
      const Eigen::Matrix3d by_b = at.by_b.transpose() * information;
      add_block(entries, edge.a, edge.a, by_a * at.by_a);
      add_block(entries, edge.b, edge.b, by_b * at.by_b);
      add_block(entries, edge.a, edge.b, by_a * at.by_b);
      add_block(entries, edge.b, edge.a, by_b * at.by_a);
      gradient.segment<3>(3 * edge.a) += by_a * at.error;
      gradient.segment<3>(3 * edge.b) += by_b * at.error;
    }
    constexpr double held = 1e12;
    for (int i = 0; i < 3; ++i) { entries.emplace_back(i, i, held); }
    Sparse matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (step == 0) { solver.analyzePattern(matrix); }
    solver.factorize(matrix);
    if (solver.info() != Eigen::Success) { return summary; }
    const Eigen::VectorXd change = -solver.solve(gradient);
    summary = {};
    for (std::size_t i = 0; i < graph.map_from_node.size(); ++i) {
      const Eigen::Vector3d d = change.segment<3>(static_cast<Eigen::Index>(3 * i));
      graph.map_from_node[i] = graph.map_from_node[i] * Pose2{d.x(), d.y(), d.z()};
      summary.translation = std::max(summary.translation, d.head<2>().norm());
      summary.rotation = std::max(summary.rotation, std::abs(d.z()));
    }
    if (summary.translation < 1e-3 && summary.rotation < 1e-4) { break; }
  }
  return summary;
}

}  // namespace flirt
