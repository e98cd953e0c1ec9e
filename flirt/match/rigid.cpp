// flirt/match/rigid.cpp: closed-form least squares in SE(2) and its error propagation.
#include "flirt/match/rigid.hpp"

#include "flirt/core/assert.hpp"

#include <cmath>

namespace flirt {
namespace {

/// The vector turned by +90°.
Point2 turned_left(Point2 v) {
  return {-v.y, v.x};
}

/// What the closed form needs: centroids, and the sums of dot and cross products about them.
struct Moments {
  Point2 query_mean{};
  Point2 reference_mean{};
  double dot_sum{0};            ///< m², Σ q'·r' = length · cos θ
  double cross_sum{0};          ///< m², Σ q'×r' = length · sin θ
  double query_squares{0};      ///< m², Σ |q'|²
  double reference_squares{0};  ///< m², Σ |r'|²
};

Moments moments_of(std::span<const PointPair> pairs) {
  Moments moments;
  const double share = 1.0 / static_cast<double>(pairs.size());
  for (const PointPair& pair : pairs) {
    moments.query_mean = moments.query_mean + share * pair.query;
    moments.reference_mean = moments.reference_mean + share * pair.reference;
  }
  for (const PointPair& pair : pairs) {
    const Point2 query = pair.query - moments.query_mean;
    const Point2 reference = pair.reference - moments.reference_mean;
    moments.dot_sum += dot(query, reference);
    moments.cross_sum += cross(query, reference);
    moments.query_squares += squared_norm(query);
    moments.reference_squares += squared_norm(reference);
  }
  return moments;
}

}  // namespace

std::optional<Pose2> fit_rigid(std::span<const PointPair> pairs) {
  if (pairs.size() < 2) { return std::nullopt; }
  const Moments moments = moments_of(pairs);
  const double length = std::sqrt(moments.dot_sum * moments.dot_sum + moments.cross_sum * moments.cross_sum);
  constexpr double smallest_size = 1e-18;   // m²: points within a nanometre of each other have no direction
  constexpr double smallest_share = 1e-12;  // below it, rounding decides the rotation
  const double size = std::sqrt(moments.query_squares * moments.reference_squares);  // length ≤ size (Cauchy, Schwarz)
  if (!(size > smallest_size && length > smallest_share * size) || !std::isfinite(length)) { return std::nullopt; }
  const double theta = wrap_angle(std::atan2(moments.cross_sum, moments.dot_sum));
  const Point2 translation = moments.reference_mean - Pose2{0.0, 0.0, theta} * moments.query_mean;
  return Pose2{translation.x, translation.y, theta};
}

double sum_of_squares(std::span<const PointPair> pairs, const Pose2& reference_from_query) {
  double sum = 0.0;
  for (const PointPair& pair : pairs) { sum += squared_norm(pair.reference - reference_from_query * pair.query); }
  return sum;
}

Eigen::Matrix3d rigid_covariance(std::span<const PointPair> pairs, const Pose2& reference_from_query,
                                 double point_deviation) {
  FLIRT_ASSERT(pairs.size() >= 2);
  const Moments moments = moments_of(pairs);
  const double length = std::hypot(moments.dot_sum, moments.cross_sum);
  const double share = 1.0 / static_cast<double>(pairs.size());
  const Pose2 rotation{0.0, 0.0, reference_from_query.theta};
  // θ = atan2(cross_sum, dot_sum) and t = r̄ − R q̄. For one pair, with ⊥ a turn by +90° and δ the errors:
  //   δθ = ⊥(R q')·δr / length − ⊥(Rᵀ r')·δq / length,   δt = share (δr − R δq) − ⊥(R q̄) δθ.
  // The columns of a Jacobian over R δq instead of δq have the same J Jᵀ, since the errors are isotropic.
  const Point2 lever = turned_left(rotation * moments.query_mean);
  Eigen::Matrix3d unit_covariance = Eigen::Matrix3d::Zero();
  for (const PointPair& pair : pairs) {
    const Point2 by_reference = turned_left(rotation * (pair.query - moments.query_mean));
    const Point2 by_query = turned_left(pair.reference - moments.reference_mean);
    Eigen::Matrix<double, 3, 4> jacobian;
    jacobian.row(2) << by_reference.x, by_reference.y, -by_query.x, -by_query.y;
    jacobian.row(2) /= length;
    jacobian.row(0) << share, 0.0, -share, 0.0;
    jacobian.row(1) << 0.0, share, 0.0, -share;
    jacobian.row(0) -= lever.x * jacobian.row(2);
    jacobian.row(1) -= lever.y * jacobian.row(2);
    unit_covariance += jacobian * jacobian.transpose();
  }
  return point_deviation * point_deviation * unit_covariance;
}

double deviation_from_residuals(std::span<const PointPair> pairs, const Pose2& reference_from_query) {
  FLIRT_ASSERT(pairs.size() >= 2);
  const double equations = 2.0 * static_cast<double>(pairs.size()) - 3.0;
  return std::sqrt(sum_of_squares(pairs, reference_from_query) / (2.0 * equations));
}

}  // namespace flirt
