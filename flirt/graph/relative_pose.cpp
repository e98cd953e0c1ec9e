#include "flirt/graph/consistency.hpp"
#include "flirt/graph/edge_error.hpp"

#include <Eigen/Cholesky>

namespace flirt {
namespace {

Eigen::Matrix3d moved(const Eigen::Matrix3d& covariance, const Pose2& to_from_here) {
  const Eigen::Matrix3d to = adjoint(to_from_here);
  return to * covariance * to.transpose();
}

}  // namespace

RelativePose operator*(const RelativePose& a_from_b, const RelativePose& b_from_c) {
  return {a_from_b.a_from_b * b_from_c.a_from_b,
          moved(a_from_b.covariance, inverse(b_from_c.a_from_b)) + b_from_c.covariance};
}

RelativePose inverse(const RelativePose& a_from_b) {
  return {inverse(a_from_b.a_from_b), moved(a_from_b.covariance, a_from_b.a_from_b)};
}

double squared_mahalanobis(const RelativePose& one, const RelativePose& other) {
  const Pose2 difference = inverse(one.a_from_b) * other.a_from_b;
  const Eigen::Vector3d error(difference.x, difference.y, difference.theta);
  const Eigen::Matrix3d covariance = one.covariance + other.covariance;
  return error.dot(covariance.ldlt().solve(error));
}

std::optional<RelativePose> relative_pose(const PoseEdge& edge) {
  const Eigen::LLT<Eigen::Matrix3d> cholesky(edge.information);
  if (cholesky.info() != Eigen::Success || !(cholesky.rcond() > 1e-12)) { return std::nullopt; }
  return RelativePose{edge.a_from_b, cholesky.solve(Eigen::Matrix3d::Identity())};
}

}  // namespace flirt
