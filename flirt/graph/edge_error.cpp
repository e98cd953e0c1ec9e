#include "flirt/graph/edge_error.hpp"

#include <cmath>

namespace flirt {

Eigen::Vector3d edge_error(const PoseEdge& edge, const Pose2& map_from_a, const Pose2& map_from_b) {
  const Pose2 error = inverse(edge.a_from_b) * (inverse(map_from_a) * map_from_b);
  return {error.x, error.y, error.theta};
}

LinearizedEdge linearize(const PoseEdge& edge, const Pose2& map_from_a, const Pose2& map_from_b) {
  // The position in the error is Rᵀ(angle) (b − a) + constant, with angle = heading of a + angle of the measurement.
  const double angle = map_from_a.theta + edge.a_from_b.theta;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const Point2 d = map_from_b.translation() - map_from_a.translation();
  LinearizedEdge linear;
  linear.error = edge_error(edge, map_from_a, map_from_b);
  linear.by_a << -c, -s, -s * d.x + c * d.y,  //
      s, -c, -c * d.x - s * d.y,              //
      0, 0, -1;
  linear.by_b << c, s, 0,  //
      -s, c, 0,            //
      0, 0, 1;
  return linear;
}

double chi2(const PoseEdge& edge, std::span<const Pose2> map_from_node) {
  const Eigen::Vector3d error = edge_error(edge, map_from_node[edge.a], map_from_node[edge.b]);
  return error.dot(edge.information * error);
}

double chi2(const PoseGraph& graph) {
  double sum = 0;
  for (const PoseEdge& edge : graph.edges) { sum += chi2(edge, graph.map_from_node); }
  return sum;
}

Eigen::Matrix3d adjoint(const Pose2& a_from_b) {
  const double c = std::cos(a_from_b.theta);
  const double s = std::sin(a_from_b.theta);
  Eigen::Matrix3d matrix;
  matrix << c, -s, a_from_b.y,  //
      s, c, -a_from_b.x,        //
      0, 0, 1;
  return matrix;
}

}  // namespace flirt
