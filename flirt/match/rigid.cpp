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

  [[nodiscard]] double length() const { return std::sqrt(dot_sum * dot_sum + cross_sum * cross_sum); }  ///< m²
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

Pose2 RigidMotion::pose() const {
  return {translation.x, translation.y, wrap_angle(std::atan2(sine, cosine))};
}

std::optional<RigidMotion> fit_rigid(std::span<const PointPair> pairs) {
  if (pairs.size() < 2) { return std::nullopt; }
  const Moments moments = moments_of(pairs);
  const double length = moments.length();
  constexpr double smallest_size = 1e-18;   // m²: points within a nanometre of each other have no direction
  constexpr double smallest_share = 1e-12;  // below it, rounding decides the rotation
  const double size = std::sqrt(moments.query_squares * moments.reference_squares);  // length ≤ size (Cauchy, Schwarz)
  if (!(size > smallest_size && length > smallest_share * size) || !std::isfinite(length)) { return std::nullopt; }
  const RigidMotion rotation{moments.dot_sum / length, moments.cross_sum / length};
  return RigidMotion{rotation.cosine, rotation.sine, moments.reference_mean - rotation * moments.query_mean};
}

double sum_of_squares(std::span<const PointPair> pairs, const Pose2& reference_from_query) {
  double sum = 0.0;
  for (const PointPair& pair : pairs) { sum += squared_norm(pair.reference - reference_from_query * pair.query); }
  return sum;
}

Eigen::Matrix3d rigid_covariance(std::span<const PointPair> pairs, double point_deviation) {
  FLIRT_ASSERT(pairs.size() >= 2);
  const Moments moments = moments_of(pairs);
  const double length = moments.length();
  // θ = atan2(cross_sum, dot_sum) and t = r̄ − R q̄. For one pair of n, with ⊥ a turn by +90° and δ the errors:
  //   δθ = ⊥(R q')·δr / length − ⊥(Rᵀ r')·δq / length,   δt = (δr − R δq) / n − ⊥(R q̄) δθ.
  // The errors are isotropic, so R δq may stand for δq, and as Σ q' = Σ r' = 0 the two terms of δt are uncorrelated.
  const double of_theta = (moments.query_squares + moments.reference_squares) / (length * length);
  const double of_means = 2.0 / static_cast<double>(pairs.size());
  const RigidMotion rotation{moments.dot_sum / length, moments.cross_sum / length};
  const Point2 lever = turned_left(rotation * moments.query_mean);
  const Eigen::Vector3d by_theta{-lever.x, -lever.y, 1.0};
  Eigen::Matrix3d unit_covariance = of_theta * by_theta * by_theta.transpose();
  unit_covariance(0, 0) += of_means;
  unit_covariance(1, 1) += of_means;
  return point_deviation * point_deviation * unit_covariance;
}

double deviation_from_residuals(std::span<const PointPair> pairs, const Pose2& reference_from_query) {
  FLIRT_ASSERT(pairs.size() >= 2);
  const double equations = 2.0 * static_cast<double>(pairs.size()) - 3.0;
  return std::sqrt(sum_of_squares(pairs, reference_from_query) / (2.0 * equations));
}

}  // namespace flirt
