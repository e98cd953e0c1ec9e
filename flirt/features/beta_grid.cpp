#include "flirt/features/beta_grid.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <limits>

namespace flirt {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double radial_distance = 1e-9;  // m; a beam that passes the keypoint nearer than this is taken as radial
constexpr double radial_overlap = 1e-9;   // angular bins; a radial beam this near to the line between bins is on it
constexpr double least_length = 1e-9;     // m; less is rounding, of a beam that starts or turns on a bin's edge
constexpr double least_overlap = 1e-12;   // angular bins; a wedge that the sweep touches less is left out

Point2 unit(double angle) {
  return {std::cos(angle), std::sin(angle)};
}
Point2 rotated(Point2 v, Point2 rotation) {
  return {rotation.x * v.x - rotation.y * v.y, rotation.y * v.x + rotation.x * v.y};
}

/// std::floor and std::ceil are calls on machines before SSE 4.1; the numbers here are small.
std::ptrdiff_t floor_index(double x) {
  const auto truncated = static_cast<std::ptrdiff_t>(x);
  return truncated - static_cast<std::ptrdiff_t>(x < static_cast<double>(truncated));
}
std::ptrdiff_t ceil_index(double x) {
  return -floor_index(-x);
}

/// Where a beam crosses the half line along an edge, as a fraction: only those in reach are worth a division. The
/// denominator is not positive when the beam does not cross it.
struct Crossing {
  double numerator{0};  ///< m
  double denominator{0};

  [[nodiscard]] bool is_after(double along) const { return denominator > 0 && numerator > along * denominator; }
  [[nodiscard]] bool is_before(double along) const { return denominator > 0 && numerator <= along * denominator; }
  [[nodiscard]] double along() const { return numerator / denominator; }
};

}  // namespace

Occupancy occupancy(std::uint32_t hits, std::uint32_t misses, const BetaGridParams& params) {
  const bool with_prior = params.estimate == OccupancyEstimate::posterior;
  const double alpha = hits + (with_prior ? params.prior_hits : 0.0);
  const double beta = misses + (with_prior ? params.prior_misses : 0.0);
  const double sum = alpha + beta;
  if (sum == 0) { return {0.5, 1.0 / 12.0}; }
  return {alpha / sum, alpha * beta / (sum * sum * (sum + 1.0))};
}

/// A part of a beam, by the coordinate along it.
struct BetaGrid::Interval {
  double from{0};  ///< m
  double to{0};    ///< m
};

/// One beam as the keypoint sees it: it runs at the distance |across|, on the left of the keypoint's foot point when
/// positive; positions are measured along it from that foot point.
struct BetaGrid::Course {
  double across{0};          ///< m
  double across_squared{0};  ///< m²
  Interval known{};          ///< within the outer arc, from the sensor to the end
  double end{0};             ///< m; where the beam ends
  double end_squared{0};     ///< m²; squared distance of the end from the keypoint
  bool ends_on_something{false};
};

BetaGrid::BetaGrid(const BetaGridParams& params) : params_(params) {
  FLIRT_ASSERT(out_of_range(params).empty());
  const std::uint32_t bins = params.angular_bins;
  const auto edge = [&](std::uint32_t k) { return 2.0 * std::numbers::pi * (k % bins) / bins - std::numbers::pi; };
  for (std::uint32_t k = 0; k < bins; ++k) {
    lower_.push_back(unit(edge(k) - params.angular_inflation));
    upper_.push_back(unit(edge(k + 1) + params.angular_inflation));
  }
  placed_lower_.resize(bins);
  placed_upper_.resize(bins);
  low_squared_.resize(params.radial_bins);
  high_squared_.resize(params.radial_bins);
  hits_.resize(dimension());
  misses_.resize(dimension());
  passed_.resize(dimension());
}

void BetaGrid::count(const BeamFan& fan, const Keypoint& keypoint) {
  std::fill(hits_.begin(), hits_.end(), 0U);
  std::fill(misses_.begin(), misses_.end(), 0U);
  std::fill(passed_.begin(), passed_.end(), 0.0);
  if (!can_describe(params_, keypoint)) { return; }
  place(keypoint);
  const double reach = outer_radius(params_, keypoint) + params_.radial_inflation;
  fan.for_each_near(keypoint.sensor_from_keypoint.translation(), reach, [&](const FanBeam& beam) { count_beam(beam); });
  std::transform(passed_.begin(), passed_.end(), misses_.begin(),
                 [](double beams) { return static_cast<std::uint32_t>(beams); });
}

void BetaGrid::place(const Keypoint& keypoint) {
  keypoint_from_sensor_ = -1.0 * keypoint.sensor_from_keypoint.translation();
  turn_ = share_of_turn(keypoint.sensor_from_keypoint.theta);
  const Point2 rotation = unit(keypoint.sensor_from_keypoint.theta);
  for (std::size_t k = 0; k < lower_.size(); ++k) {
    placed_lower_[k] = rotated(lower_[k], rotation);
    placed_upper_[k] = rotated(upper_[k], rotation);
  }
  const double inner = params_.inner_radius;
  const double width = (outer_radius(params_, keypoint) - inner) / params_.radial_bins;
  for (std::size_t j = 0; j < low_squared_.size(); ++j) {
    const double low = std::max(inner, inner + static_cast<double>(j) * width - params_.radial_inflation);
    const double high = inner + static_cast<double>(j + 1) * width + params_.radial_inflation;
    low_squared_[j] = low * low;
    high_squared_[j] = high * high;
  }
}

void BetaGrid::count_beam(const FanBeam& beam) {
  const double across = cross(beam.direction, keypoint_from_sensor_);
  const double across_squared = across * across;
  const double half_chord_squared = high_squared_.back() - across_squared;
  const double sensor = dot(keypoint_from_sensor_, beam.direction);
  const double end = sensor + beam.length;
  if (!(half_chord_squared > 0) || !(beam.length > 0)) { return; }
  const double half_chord = std::sqrt(half_chord_squared);
  const Interval known{std::max(sensor, -half_chord), std::min(end, half_chord)};
  if (!(known.to > known.from)) { return; }
  const Course course{
      across, across_squared, known, end, across_squared + end * end, beam.has_return && end <= half_chord};
  // Where the beam comes from, as seen by the keypoint, in angular bins from the first; the beam then turns around the
  // keypoint by up to half a circle. Its own direction plus π, and the bins start at −π.
  const double turn = beam.turn - turn_;
  const double start = (turn < 0 ? turn + 1.0 : turn) * static_cast<double>(lower_.size());
  if (std::abs(across) <= radial_distance) {
    count_radial(course, start);
  } else {
    sweep(course, beam.direction, start);
  }
}

/// The position angle of a point on the beam falls (keypoint on the right of the beam) or grows (on the left) by π from
/// −∞ to +∞ along it, so that the wedges are met in order. The beam meets the half line along v at
/// across · (u · v) / (u × v) if v points to the beam's side of the keypoint.
void BetaGrid::sweep(const Course& course, Point2 direction, double start) {
  const auto bins = static_cast<std::ptrdiff_t>(lower_.size());
  const double half = 0.5 * static_cast<double>(bins);
  const double overlap =
      params_.angular_inflation * static_cast<double>(bins) / (2.0 * std::numbers::pi) - least_overlap;
  const bool clockwise = course.across > 0;
  const double side = clockwise ? 1.0 : -1.0;
  const Point2* const entries = clockwise ? placed_upper_.data() : placed_lower_.data();
  const Point2* const exits = clockwise ? placed_lower_.data() : placed_upper_.data();
  const std::ptrdiff_t first = clockwise ? ceil_index(start + overlap) - 1 : floor_index(start - overlap - 1.0) + 1;
  const std::ptrdiff_t last =
      clockwise ? floor_index(start - half - overlap - 1.0) + 1 : ceil_index(start + half + overlap) - 1;
  const std::ptrdiff_t wedges = std::min(bins, std::abs(last - first) + 1);
  const std::ptrdiff_t step = clockwise ? bins - 1 : 1;
  const double distance = std::abs(course.across);
  const Interval known = course.known;
  std::ptrdiff_t wedge = first < 0 ? first + bins : first % bins;
  for (std::ptrdiff_t k = 0; k < wedges; ++k, wedge = wedge + step < bins ? wedge + step : wedge + step - bins) {
    const Crossing exit{distance * dot(direction, exits[wedge]), side * cross(direction, exits[wedge])};
    if (exit.is_before(known.from)) { continue; }
    const Crossing entry{distance * dot(direction, entries[wedge]), side * cross(direction, entries[wedge])};
    if (entry.is_after(known.to)) { return; }
    const Interval within{entry.is_after(known.from) ? entry.along() : known.from,
                          exit.is_before(known.to) ? exit.along() : known.to};
    count_wedge(course, static_cast<std::size_t>(wedge), within,
                !entry.is_after(course.end) && !exit.is_before(course.end));
  }
}

/// A beam through the keypoint itself comes in by one direction and leaves by the opposite one.
void BetaGrid::count_radial(const Course& course, double start) {
  const auto bins = static_cast<double>(lower_.size());
  const double reach = 0.5 + params_.angular_inflation * bins / (2.0 * std::numbers::pi) + radial_overlap;
  for (std::size_t wedge = 0; wedge < lower_.size(); ++wedge) {
    const double centre = static_cast<double>(wedge) + 0.5;
    if (std::abs(std::remainder(start - centre, bins)) <= reach) {
      count_wedge(course, wedge, {-infinity, 0.0}, course.end <= 0.0);
    }
    if (std::abs(std::remainder(start + 0.5 * bins - centre, bins)) <= reach) {
      count_wedge(course, wedge, {0.0, infinity}, course.end > 0.0);
    }
  }
}

/// Along `within`, part of the beam in one wedge, the distance to the keypoint takes every value between its least and
/// its greatest, so that the rings met are those between the two.
void BetaGrid::count_wedge(const Course& course, std::size_t wedge, Interval within, bool ends_here) {
  const double from = std::max(within.from, course.known.from);
  const double to = std::min(within.to, course.known.to);
  const double from_squared = from * from;
  const double to_squared = to * to;
  const bool passes_foot = from < 0 && to > 0;
  const bool has_length = to - from > least_length;
  const double nearest = course.across_squared + (passes_foot ? 0.0 : std::min(from_squared, to_squared));
  const double farthest = has_length ? course.across_squared + std::max(from_squared, to_squared) : 0.0;
  const double* const low = low_squared_.data();
  const double* const high = high_squared_.data();
  const std::size_t rings = low_squared_.size();
  double* const passed = passed_.data() + wedge * rings;
  for (std::size_t j = 0; j < rings; ++j) { passed[j] += farthest > low[j] && nearest < high[j] ? 1.0 : 0.0; }
  if (!ends_here || !course.ends_on_something) { return; }
  for (std::size_t j = 0; j < rings; ++j) {
    const bool is_hit = course.end_squared >= low[j] && course.end_squared < high[j];
    if (!is_hit) { continue; }
    ++hits_[wedge * rings + j];
    passed[j] -= farthest > low[j] && nearest < high[j] ? 1.0 : 0.0;  // the bin of the end gets the hit only
  }
}

}  // namespace flirt
