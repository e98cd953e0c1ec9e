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

/// The bin that a whole number of bins beyond the first means, in a full turn of `bins`.
std::size_t wrapped(std::ptrdiff_t bin, std::ptrdiff_t bins) {
  const std::ptrdiff_t rest = bin % bins;
  return static_cast<std::size_t>(rest < 0 ? rest + bins : rest);
}

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
}

void BetaGrid::count(const BeamFan& fan, const Keypoint& keypoint) {
  std::fill(hits_.begin(), hits_.end(), 0U);
  std::fill(misses_.begin(), misses_.end(), 0U);
  if (!can_describe(params_, keypoint)) { return; }
  place(keypoint);
  const double reach = outer_radius(params_, keypoint) + params_.radial_inflation;
  fan.for_each_near(keypoint.sensor_from_keypoint.translation(), reach,
                    [&](std::size_t i, const FanBeam& beam) { count_beam(beam, fan.angle(i)); });
}

void BetaGrid::place(const Keypoint& keypoint) {
  keypoint_from_sensor_ = -1.0 * keypoint.sensor_from_keypoint.translation();
  direction_ = keypoint.sensor_from_keypoint.theta;
  const Point2 rotation = unit(direction_);
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

void BetaGrid::count_beam(const FanBeam& beam, double angle) {
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
  const auto bins = static_cast<double>(lower_.size());
  const double turns = (angle - direction_) / (2.0 * std::numbers::pi);
  const double start = (turns - std::floor(turns)) * bins;
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
  const std::vector<Point2>& entries = clockwise ? placed_upper_ : placed_lower_;
  const std::vector<Point2>& exits = clockwise ? placed_lower_ : placed_upper_;
  const auto first = static_cast<std::ptrdiff_t>(clockwise ? std::ceil(start + overlap) - 1.0
                                                           : std::floor(start - overlap - 1.0) + 1.0);
  const auto last = static_cast<std::ptrdiff_t>(clockwise ? std::floor(start - half - overlap - 1.0) + 1.0
                                                          : std::ceil(start + half + overlap) - 1.0);
  const std::ptrdiff_t wedges = std::min(bins, std::abs(last - first) + 1);
  const auto crossing = [&](Point2 edge, double otherwise) {
    const double sine = cross(direction, edge);
    return side * sine > 0 ? course.across * dot(direction, edge) / sine : otherwise;
  };
  for (std::ptrdiff_t k = 0; k < wedges; ++k) {
    const std::size_t wedge = wrapped(clockwise ? first - k : first + k, bins);
    const Interval within{crossing(entries[wedge], -infinity), crossing(exits[wedge], infinity)};
    if (within.from > course.known.to) { return; }
    if (within.to < course.known.from) { continue; }
    // A point on the line between two bins belongs to the one that it opens, counter-clockwise.
    const bool ends_here = clockwise ? within.from < course.end && course.end <= within.to
                                     : within.from <= course.end && course.end < within.to;
    count_wedge(course, wedge, within, ends_here);
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
  const double nearest = course.across_squared + (passes_foot ? 0.0 : std::min(from_squared, to_squared));
  const double farthest = course.across_squared + std::max(from_squared, to_squared);
  const bool has_length = to - from > least_length;
  const bool ends = ends_here && course.ends_on_something;
  const std::size_t rings = low_squared_.size();
  std::uint32_t* const hits = hits_.data() + wedge * rings;
  std::uint32_t* const misses = misses_.data() + wedge * rings;
  for (std::size_t j = 0; j < rings; ++j) {
    const bool is_met = has_length && farthest > low_squared_[j] && nearest < high_squared_[j];
    const bool is_hit = ends && course.end_squared >= low_squared_[j] && course.end_squared < high_squared_[j];
    hits[j] += static_cast<std::uint32_t>(is_hit);
    misses[j] += static_cast<std::uint32_t>(is_met && !is_hit);
  }
}

}  // namespace flirt
