#include "flirt/sim/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace flirt {
namespace {

constexpr double nothing_hit = std::numeric_limits<double>::infinity();
constexpr double past_glass = 1e-6;  // m, behind a pane at which a beam that passed it goes on
constexpr double depth_jump =
    0.2;  // m, from one beam to the next at an edge, above which a reading may fall in between

/// Standard normal numbers two at a time (Box and Muller), half the cost of Rng::normal.
class Normals {
 public:
  explicit Normals(Rng& rng) : rng_(rng) {}
  double next() {
    has_spare_ = !has_spare_;
    if (!has_spare_) { return spare_; }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - rng_.uniform()));
    const double angle = 2.0 * std::numbers::pi * rng_.uniform();
    spare_ = radius * std::sin(angle);
    return radius * std::cos(angle);
  }

 private:
  Rng& rng_;
  bool has_spare_{false};
  double spare_{0};
};

}  // namespace

Lidar::Lidar(const LidarParams& params) : params_(params) {
  const double sign = params.beam_order == BeamOrder::clockwise ? -1.0 : 1.0;
  beams_ = {-sign * params.field_of_view / 2, sign * params.field_of_view / params.beams, params.range_min,
            params.range_max};
  sensor_directions_.reserve(params.beams);
  for (std::size_t i = 0; i < params.beams; ++i) {
    sensor_directions_.push_back({std::cos(beams_.angle(i)), std::sin(beams_.angle(i))});
  }
}

/// Distance to the surface that returns the beam, +inf when none up to `limit` does.
double Lidar::true_range(const RayCaster& caster, Point2 origin, Point2 direction, double limit, Rng& rng) const {
  double from = 0;
  while (const std::optional<RayHit> hit = caster.first_hit(origin, direction, from, limit)) {
    const bool returns = hit->material != Material::glass || hit->cosine >= std::cos(params_.glass_glare) ||
                         rng.uniform() < params_.glass_returns;
    if (returns) { return hit->range; }
    from = hit->range + past_glass;
  }
  return nothing_hit;
}

/// Shortens `limits` (m, one per beam) where the disc stands in the way; 0 when the scanner is within it.
void Lidar::cover_by(const PlanDisc& disc, const Pose2& map_from_sensor, std::vector<double>& limits) const {
  const Point2 center = inverse(map_from_sensor) * disc.center;
  const double distance = norm(center);
  if (distance - disc.radius > params_.range_max) { return; }
  if (distance <= disc.radius) {
    std::fill(limits.begin(), limits.end(), 0.0);
    return;
  }
  const double step = std::abs(beams_.angle_step);
  const double half_width = std::asin(disc.radius / distance);
  // Number of the beam towards the middle of the disc, and the same one turn later for discs across beam 0's back.
  const double full_turn = 2 * std::numbers::pi / step;
  const double turned = wrap_angle(std::atan2(center.y, center.x) - beams_.angle_min) / beams_.angle_step;
  for (const double middle : {turned, turned + full_turn}) {
    const double first = std::max(0.0, std::ceil(middle - half_width / step));
    const double last = std::min(static_cast<double>(limits.size()) - 1, std::floor(middle + half_width / step));
    for (double beam = first; beam <= last; ++beam) {
      const auto i = static_cast<std::size_t>(beam);
      const double aside = cross(sensor_directions_[i], center);
      const double half_chord = std::sqrt(std::max(0.0, disc.radius * disc.radius - aside * aside));
      limits[i] = std::min(limits[i], dot(sensor_directions_[i], center) - half_chord);
    }
  }
}

/// A beam that grazes an edge lights both what is before and what is behind: some readings fall in between, of either
/// beam beside the edge. A wall at a grazing angle is no edge, however far apart its readings are.
void Lidar::mix_at_edges(std::vector<double>& ranges, Rng& rng) const {
  const std::vector<double> clean = ranges;
  const double bend = 2 * std::cos(beams_.angle_step);
  const auto is_one_wall = [&](std::size_t first, std::size_t second, std::size_t third) {
    const double inverse = bend / clean[second] - 1 / clean[first];  // of the range at which a wall goes on
    return inverse > 0 && std::abs(1 / inverse - clean[third]) <= depth_jump;
  };
  for (std::size_t i = 0; i + 1 < clean.size(); ++i) {
    const double jump = clean[i + 1] - clean[i];
    if (!(std::abs(jump) > depth_jump) || std::isinf(jump)) { continue; }
    if (i > 0 && is_one_wall(i - 1, i, i + 1)) { continue; }
    if (i + 2 < clean.size() && is_one_wall(i + 2, i + 1, i)) { continue; }
    if (rng.uniform() >= params_.mixed_pixels) { continue; }
    ranges[rng.uniform() < 0.5 ? i : i + 1] = clean[i] + rng.uniform() * jump;
  }
}

/// The reading for a true distance and standard normal noise: rounding, losses and limits.
double Lidar::reading(double range, double noise, Rng& rng) const {
  if (range >= params_.range_max || rng.uniform() < params_.dropouts) { return params_.range_max; }
  double measured = range + (params_.noise + params_.noise_per_metre * range) * noise;
  if (params_.resolution > 0) { measured = std::round(measured / params_.resolution) * params_.resolution; }
  if (measured <= 0) { return params_.range_min / 2; }  // too near, not "no return"
  return std::min(measured, params_.range_max);
}

std::vector<double> Lidar::measure(const RayCaster& caster, std::span<const PlanDisc> moving,
                                   const Pose2& map_from_sensor, Rng& rng) const {
  std::vector<double> ranges(params_.beams, nothing_hit);
  for (const PlanDisc& disc : moving) { cover_by(disc, map_from_sensor, ranges); }
  const double c = std::cos(map_from_sensor.theta);
  const double s = std::sin(map_from_sensor.theta);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const Point2 in_sensor = sensor_directions_[i];
    const Point2 in_map{c * in_sensor.x - s * in_sensor.y, s * in_sensor.x + c * in_sensor.y};
    const double limit = std::min(ranges[i], params_.range_max);
    ranges[i] = std::min(ranges[i], true_range(caster, map_from_sensor.translation(), in_map, limit, rng));
  }
  if (params_.mixed_pixels > 0) { mix_at_edges(ranges, rng); }
  Normals normals(rng);
  for (double& range : ranges) { range = reading(range, normals.next(), rng); }
  return ranges;
}

}  // namespace flirt
