#include "flirt/features/shape_context.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>

namespace flirt {

ShapeContext::ShapeContext(const ShapeContextParams& params) : params_(params) {
  FLIRT_ASSERT(out_of_range(params).empty());
  points_.resize(dimension());
}

void ShapeContext::count(const BeamFan& fan, const Keypoint& keypoint) {
  std::fill(points_.begin(), points_.end(), 0U);
  if (!can_describe(params_, keypoint)) { return; }
  const double inner = params_.inner_radius;
  const double outer = outer_radius(params_, keypoint);
  const double bins_per_metre = params_.radial_bins / (outer - inner);
  const double bins_per_radian = params_.angular_bins / (2.0 * std::numbers::pi);
  const Point2 centre = keypoint.sensor_from_keypoint.translation();
  const double theta = keypoint.sensor_from_keypoint.theta;
  const Point2 direction{std::cos(theta), std::sin(theta)};
  fan.for_each_near(centre, outer, [&](const FanBeam& beam) {
    const Point2 offset = beam.length * beam.direction - centre;
    const double squared_distance = squared_norm(offset);
    const bool is_inside = squared_distance >= inner * inner && squared_distance < outer * outer;
    if (!beam.has_return || !is_inside) { return; }
    const double angle = std::atan2(cross(direction, offset), dot(direction, offset));
    const double ring = (std::sqrt(squared_distance) - inner) * bins_per_metre;
    const auto a = static_cast<std::uint32_t>((angle + std::numbers::pi) * bins_per_radian) % params_.angular_bins;
    const auto j = std::min(static_cast<std::uint32_t>(std::max(ring, 0.0)), params_.radial_bins - 1);
    ++points_[a * params_.radial_bins + j];
  });
}

}  // namespace flirt
