#include "flirt/registration/refine.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

/// Whether the map ever saw the place, in m from its origin.
bool is_seen(const MapFields& fields, float x, float y) {
  if (!(x >= 0 && y >= 0)) { return false; }
  const auto per_metre = static_cast<float>(1.0 / fields.cell_size);
  const auto cell_x = static_cast<std::int32_t>(x * per_metre);
  const auto cell_y = static_cast<std::int32_t>(y * per_metre);
  const MapTile* const tile = fields.tile_at(cell_x, cell_y);
  return tile != nullptr && (tile->agreement[MapTile::offset(cell_x, cell_y)] & Agreement::unknown) == 0;
}

/// A pose of the map in a frame at the fields' origin, where floats are exact enough.
Pose2 in_fields(const MapFields& fields, const Pose2& map_from_sensor) {
  return {map_from_sensor.x - fields.origin.x, map_from_sensor.y - fields.origin.y, map_from_sensor.theta};
}

/// Σ w JᵀMJ and Σ w JᵀMr over the end points, in a frame at the fields' origin, rotation about the sensor.
struct NormalEquations {
  float xx{0}, xy{0}, yy{0}, xt{0}, yt{0}, tt{0};  // upper triangle of the information matrix
  float gx{0}, gy{0}, gt{0};                       // gradient
  float weight{0};
  float squared{0};  // m², Σ w r²
};

NormalEquations normal_equations(const MapFields& fields, const ScanPoints& points, const Pose2& origin_from_sensor,
                                 double width, double before) {
  const auto c = static_cast<float>(std::cos(origin_from_sensor.theta));
  const auto s = static_cast<float>(std::sin(origin_from_sensor.theta));
  const auto x0 = static_cast<float>(origin_from_sensor.x);
  const auto y0 = static_cast<float>(origin_from_sensor.y);
  const auto per_metre = static_cast<float>(1.0 / fields.cell_size);
  const auto inverse_squared_width = static_cast<float>(1.0 / (width * width));
  const auto tile_width = static_cast<float>(MapTile::side * fields.cell_size);
  NormalEquations sum;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float lever_x = c * points.x[i] - s * points.y[i];
    const float lever_y = s * points.x[i] + c * points.y[i];
    const float x = x0 + lever_x;
    const float y = y0 + lever_y;
    if (!(x >= 0 && y >= 0)) { continue; }
    const auto cell_x = static_cast<std::int32_t>(x * per_metre);
    const auto cell_y = static_cast<std::int32_t>(y * per_metre);
    const MapTile* const tile = fields.tile_at(cell_x, cell_y);
    if (tile == nullptr) { continue; }
    const std::uint16_t index = tile->line[MapTile::offset(cell_x, cell_y)];
    if (index == 0) { continue; }
    const LinePiece& line = tile->lines[index - 1];
    const std::int32_t tile_x = cell_x / MapTile::side;
    const std::int32_t tile_y = cell_y / MapTile::side;
    const float dx = x - static_cast<float>(tile_x) * tile_width - line.x;
    const float dy = y - static_cast<float>(tile_y) * tile_width - line.y;
    if (before > 0 && points.range[i] > 0) {  // of joined scans no beam is known
      const float share = static_cast<float>(before) / points.range[i];
      if (!is_seen(fields, x - dx - share * lever_x, y - dy - share * lever_y)) { continue; }
    }
    // M = n nᵀ + roundness · t tᵀ
    const float m_xx = line.normal_x * line.normal_x + line.roundness * line.normal_y * line.normal_y;
    const float m_xy = line.normal_x * line.normal_y * (1.0F - line.roundness);
    const float m_yy = line.normal_y * line.normal_y + line.roundness * line.normal_x * line.normal_x;
    const float r_x = m_xx * dx + m_xy * dy;
    const float r_y = m_xy * dx + m_yy * dy;
    const float squared = dx * r_x + dy * r_y;
    const float root = 1.0F / (1.0F + squared * inverse_squared_width);
    const float w = root * root;
    const float m_xt = -m_xx * lever_y + m_xy * lever_x;
    const float m_yt = -m_xy * lever_y + m_yy * lever_x;
    sum.xx += w * m_xx;
    sum.xy += w * m_xy;
    sum.yy += w * m_yy;
    sum.xt += w * m_xt;
    sum.yt += w * m_yt;
    sum.tt += w * (lever_x * m_yt - lever_y * m_xt);
    sum.gx += w * r_x;
    sum.gy += w * r_y;
    sum.gt += w * (lever_x * r_y - lever_y * r_x);
    sum.weight += w;
    sum.squared += w * squared;
  }
  return sum;
}

Eigen::Matrix3d information_of(const NormalEquations& sum) {
  Eigen::Matrix3d information;
  information << sum.xx, sum.xy, sum.xt, sum.xy, sum.yy, sum.yt, sum.xt, sum.yt, sum.tt;
  return information;
}

/// What all variances are multiplied by: see `refine`.
double inflation(const NormalEquations& sum, double support, const RefineParams& params) {
  constexpr double smallest_residual = 0.004;  // m, of few points that happen to agree
  const double mean_square = sum.weight > 0 ? static_cast<double>(sum.squared / sum.weight) : 0.0;
  const double square = std::max(mean_square, smallest_residual * smallest_residual);
  return square / (params.usual_residual * params.usual_residual) * std::exp(params.unexplained * (1 - support));
}

}  // namespace

Pose2 refined_pose(const MapFields& fields, const ScanPoints& points, const Pose2& map_from_sensor,
                   const RefineParams& params) {
  Pose2 pose = in_fields(fields, map_from_sensor);
  double width = params.start_width;
  // Holds directions in which nothing is known: a weak wish to stay.
  const Eigen::Matrix3d stay = Eigen::Vector3d(1e-2, 1e-2, 1e-2).asDiagonal();
  for (std::uint32_t i = 0; i < params.iterations; ++i) {
    const NormalEquations sum = normal_equations(fields, points, pose, width, params.before);
    const Eigen::Vector3d gradient(sum.gx, sum.gy, sum.gt);
    const Eigen::Vector3d step = -(information_of(sum) + stay).ldlt().solve(gradient);
    pose = {pose.x + step.x(), pose.y + step.y(), wrap_angle(pose.theta + step.z())};
    const bool small = step.head<2>().norm() < params.stop_translation && std::abs(step.z()) < params.stop_rotation;
    if (small && width <= params.end_width) { break; }
    width = std::max(params.end_width, params.shrink * width);
  }
  return {pose.x + fields.origin.x, pose.y + fields.origin.y, pose.theta};
}

RefinedPose refine(const MapFields& fields, const ScanPoints& points, const Pose2& map_from_sensor,
                   const RefineParams& params) {
  RefinedPose refined{refined_pose(fields, points, map_from_sensor, params)};
  const NormalEquations sum =
      normal_equations(fields, points, in_fields(fields, refined.map_from_sensor), params.end_width, params.before);
  refined.support = points.size() == 0 ? 0.0 : sum.weight / static_cast<double>(points.size());
  const double inflated = inflation(sum, refined.support, params);
  const double variance = inflated * params.residual_sigma * params.residual_sigma;
  const Eigen::Vector3d common(params.common_translation, params.common_translation, params.common_rotation);
  const Eigen::Matrix3d information = information_of(sum) / variance + Eigen::Matrix3d::Identity();
  refined.covariance = information.inverse();
  refined.covariance.diagonal() += inflated * common.cwiseAbs2();
  return refined;
}

}  // namespace flirt
