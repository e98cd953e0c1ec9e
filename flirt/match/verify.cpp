// flirt/match/verify.cpp: query end points looked up in the beams of the reference.
#include "flirt/match/verify.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

namespace flirt {
namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;

/// The end point of one beam and the line through it and its neighbours.
struct Surface {
  bool hit{false};
  double range{0};  ///< m
  Point2 point{};   ///< m, reference frame
  Point2 middle{};  ///< m, a point of the line
  Point2 normal{};  ///< unit length; zero where there is no line
};

/// Total least squares line through beam i and the hits within `window` beams and `farthest` metres of it.
void fit_line(std::vector<Surface>& surfaces, std::size_t i, std::size_t window, double farthest) {
  const std::size_t first = i - std::min(i, window);
  const std::size_t last = std::min(surfaces.size() - 1, i + window);
  const auto belongs = [&](const Surface& other) {
    return other.hit && squared_norm(other.point - surfaces[i].point) <= farthest * farthest;
  };
  double count = 0.0;
  Point2 sum{};
  for (std::size_t k = first; k <= last; ++k) {
    if (!belongs(surfaces[k])) { continue; }
    sum = sum + surfaces[k].point;
    count += 1.0;
  }
  if (count < 2.0) { return; }
  const Point2 middle = (1.0 / count) * sum;
  double xx_minus_yy = 0.0;
  double xy = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    if (!belongs(surfaces[k])) { continue; }
    const Point2 offset = surfaces[k].point - middle;
    xx_minus_yy += offset.x * offset.x - offset.y * offset.y;
    xy += offset.x * offset.y;
  }
  const double direction = 0.5 * std::atan2(2.0 * xy, xx_minus_yy);
  surfaces[i].middle = middle;
  surfaces[i].normal = {-std::sin(direction), std::cos(direction)};
}

/// A scan as a lookup from direction to end points.
class PolarScan {
 public:
  PolarScan(const Scan& scan, const VerifyParams& params)
      : beams_(scan.beams), full_turn_(is_full_turn(scan)), surfaces_(scan.ranges.size()) {
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      if (classify(scan.ranges[i], beams_) != Reading::hit) { continue; }
      const double angle = beams_.angle(i);
      surfaces_[i].hit = true;
      surfaces_[i].range = scan.ranges[i];
      surfaces_[i].point = scan.ranges[i] * Point2{std::cos(angle), std::sin(angle)};
    }
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      if (surfaces_[i].hit) { fit_line(surfaces_, i, params.line_window, params.line_distance); }
    }
  }

  /// The end point nearest to `point`, if one is within `distance`.
  [[nodiscard]] const Surface* nearest(Point2 point, double distance) const {
    const double range = norm(point);
    const double position = position_of(point);
    const double turn = full_turn / step();
    const double reach = range > distance ? std::asin(distance / range) / step() : turn;
    const Surface* best = nullptr;
    double best_squared = distance * distance;
    for (const double shift : {-turn, 0.0, turn}) {
      const double first = std::max(0.0, std::ceil(position + shift - reach));
      const double last = std::min(static_cast<double>(surfaces_.size()) - 1.0, std::floor(position + shift + reach));
      for (double k = first; k <= last; k += 1.0) {
        const Surface& surface = surfaces_[static_cast<std::size_t>(k)];
        const double squared = squared_norm(surface.point - point);
        if (surface.hit && squared <= best_squared) {
          best = &surface;
          best_squared = squared;
        }
      }
    }
    return best;
  }

  /// True when both beams beside `point` ended more than `margin` behind it.
  [[nodiscard]] bool has_seen_free(Point2 point, double margin) const {
    const double position = position_of(point);
    const double beyond = norm(point) + margin;
    for (const double beam : {std::floor(position), std::ceil(position)}) {
      const std::optional<std::size_t> i = index_of(beam);
      if (!i || !surfaces_[*i].hit || surfaces_[*i].range <= beyond) { return false; }
    }
    return true;
  }

 private:
  [[nodiscard]] double step() const { return std::abs(beams_.angle_step); }

  /// Direction in beams from beam 0, in [0, full turn).
  [[nodiscard]] double position_of(Point2 point) const {
    const double sign = beams_.angle_step < 0.0 ? -1.0 : 1.0;
    const double angle = std::fmod(sign * (std::atan2(point.y, point.x) - beams_.angle_min), full_turn);
    return (angle < 0.0 ? angle + full_turn : angle) / step();
  }
  [[nodiscard]] std::optional<std::size_t> index_of(double beam) const {
    if (beam < static_cast<double>(surfaces_.size())) { return static_cast<std::size_t>(beam); }
    return full_turn_ ? std::optional<std::size_t>(0) : std::nullopt;
  }

  Beams beams_;
  bool full_turn_;
  std::vector<Surface> surfaces_;
};

/// To the line at the surface, or to its point where it has no line.
double distance_to(const Surface& surface, Point2 point) {
  if (surface.normal == Point2{}) { return norm(point - surface.point); }
  return std::abs(dot(surface.normal, point - surface.middle));
}

double median_of(std::vector<double>& values) {
  if (values.empty()) { return 0.0; }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

Verification verify(const Scan& query, const Scan& reference, const Pose2& reference_from_query,
                    const VerifyParams& params) {
  FLIRT_ASSERT(is_finite(reference_from_query));
  Verification result;
  if (reference.ranges.empty() || reference.beams.angle_step == 0.0) { return result; }
  const PolarScan polar(reference, params);
  std::vector<double> residuals;
  for (const BeamPoint& end : hit_points(query)) {
    const Point2 point = reference_from_query * end.point;
    ++result.query_points;
    result.free_points += polar.has_seen_free(point, params.free_margin) ? 1U : 0U;
    const Surface* surface = polar.nearest(point, std::max(params.near_distance, params.line_distance));
    if (surface == nullptr) { continue; }
    const double to_point = norm(surface->point - point);
    result.near_points += to_point <= params.near_distance ? 1U : 0U;
    if (to_point <= params.line_distance) { residuals.push_back(distance_to(*surface, point)); }
  }
  if (result.query_points == 0) { return result; }
  const auto all = static_cast<double>(result.query_points);
  result.near_share = result.near_points / all;
  result.free_share = result.free_points / all;
  result.line_points = static_cast<std::uint32_t>(residuals.size());
  if (residuals.empty()) { return result; }
  result.mean_line_residual = std::accumulate(residuals.begin(), residuals.end(), 0.0) / result.line_points;
  result.median_line_residual = median_of(residuals);
  return result;
}

}  // namespace flirt
