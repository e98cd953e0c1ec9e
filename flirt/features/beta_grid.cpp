#include "flirt/features/beta_grid.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>

namespace flirt {
namespace {

using beta_grid_kernel::Counts;
using beta_grid_kernel::Course;
using beta_grid_kernel::Rings;
using beta_grid_kernel::Wedges;

constexpr double radial_distance = 1e-9;  // m; a beam that passes the keypoint nearer than this is taken as radial
constexpr double radial_overlap = 1e-9;   // rad; a radial beam this near to the line between two bins is on it

Point2 unit(double angle) {
  return {std::cos(angle), std::sin(angle)};
}
Point2 rotated(Point2 v, Point2 rotation) {
  return {rotation.x * v.x - rotation.y * v.y, rotation.y * v.x + rotation.x * v.y};
}

}  // namespace

BetaGrid::BetaGrid(const BetaGridParams& params)
    : params_(params),
      stride_((params.angular_bins + beta_grid_kernel::lanes - 1) / beta_grid_kernel::lanes * beta_grid_kernel::lanes) {
  FLIRT_ASSERT(out_of_range(params).empty());
  const std::uint32_t bins = params.angular_bins;
  const auto side = [&](std::uint32_t k) { return 2.0 * std::numbers::pi * (k % bins) / bins - std::numbers::pi; };
  for (std::uint32_t k = 0; k < bins; ++k) {
    lower_.push_back(unit(side(k) - params.angular_inflation));
    upper_.push_back(unit(side(k + 1) + params.angular_inflation));
  }
  placed_sides_.resize(4 * stride_);
  low_squared_.resize(params.radial_bins);
  high_squared_.resize(params.radial_bins);
  hit_counts_.resize(params.radial_bins * stride_);
  miss_counts_.resize(params.radial_bins * stride_);
  hits_.resize(dimension());
  misses_.resize(dimension());
}

void BetaGrid::count(const BeamFan& fan, const Keypoint& keypoint) {
  std::fill(hit_counts_.begin(), hit_counts_.end(), 0.0);
  std::fill(miss_counts_.begin(), miss_counts_.end(), 0.0);
  courses_.clear();
  if (can_describe(params_, keypoint)) {
    place(keypoint);
    const double reach = outer_radius(params_, keypoint) + params_.radial_inflation;
    fan.for_each_near(keypoint.sensor_from_keypoint.translation(), reach, [&](const FanBeam& beam) { follow(beam); });
    const double* const sides = placed_sides_.data();
    const Wedges wedges{sides, sides + stride_, sides + 2 * stride_, sides + 3 * stride_, stride_};
    beta_grid_kernel::count_courses(courses_, wedges, Rings{low_squared_, high_squared_},
                                    Counts{hit_counts_.data(), miss_counts_.data()});
  }
  for (std::size_t a = 0; a < lower_.size(); ++a) {
    for (std::size_t j = 0; j < low_squared_.size(); ++j) {
      hits_[a * low_squared_.size() + j] = static_cast<std::uint32_t>(hit_counts_[j * stride_ + a]);
      misses_[a * low_squared_.size() + j] = static_cast<std::uint32_t>(miss_counts_[j * stride_ + a]);
    }
  }
}

void BetaGrid::place(const Keypoint& keypoint) {
  keypoint_from_sensor_ = -1.0 * keypoint.sensor_from_keypoint.translation();
  const Point2 rotation = unit(keypoint.sensor_from_keypoint.theta);
  for (std::size_t k = 0; k < lower_.size(); ++k) {
    const Point2 lower = rotated(lower_[k], rotation);
    const Point2 upper = rotated(upper_[k], rotation);
    placed_sides_[k] = lower.x;
    placed_sides_[stride_ + k] = lower.y;
    placed_sides_[2 * stride_ + k] = upper.x;
    placed_sides_[3 * stride_ + k] = upper.y;
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

/// Keeps the part of the beam within the outer arc, for the kernel.
void BetaGrid::follow(const FanBeam& beam) {
  const double across = cross(beam.direction, keypoint_from_sensor_);
  const double half_chord_squared = high_squared_.back() - across * across;
  if (!(half_chord_squared > 0) || !(beam.length > 0)) { return; }
  const double half_chord = std::sqrt(half_chord_squared);
  const double sensor = dot(keypoint_from_sensor_, beam.direction);
  const double end = sensor + beam.length;
  const Course course{beam.direction.x,
                      beam.direction.y,
                      across,
                      std::max(sensor, -half_chord),
                      std::min(end, half_chord),
                      beam.has_return && end <= half_chord};
  if (!(course.to > course.from)) { return; }
  if (std::abs(across) <= radial_distance) {
    count_radial(course);
  } else {
    courses_.push_back(course);
  }
}

/// A beam through the keypoint itself comes in by one direction and leaves by the opposite one. Where that is the line
/// between two bins, it counts for both.
void BetaGrid::count_radial(const Course& course) {
  const auto count_way = [&](Point2 direction, double nearest, double farthest, bool ends) {
    for (std::size_t a = 0; a < lower_.size(); ++a) {
      const Point2 lower{placed_sides_[a], placed_sides_[stride_ + a]};
      const Point2 upper{placed_sides_[2 * stride_ + a], placed_sides_[3 * stride_ + a]};
      if (cross(lower, direction) < -radial_overlap || cross(direction, upper) < -radial_overlap) { continue; }
      for (std::size_t j = 0; j < low_squared_.size(); ++j) {
        const double end_squared = course.to * course.to;
        const bool is_met = farthest * farthest > low_squared_[j] && nearest * nearest < high_squared_[j];
        const bool is_hit = ends && end_squared >= low_squared_[j] && end_squared < high_squared_[j];
        hit_counts_[j * stride_ + a] += is_hit ? 1.0 : 0.0;
        miss_counts_[j * stride_ + a] += is_met && !is_hit ? 1.0 : 0.0;
      }
    }
  };
  const Point2 onwards{course.direction_x, course.direction_y};
  const bool ends_before = course.to <= 0;
  if (course.from < 0) {
    count_way(-1.0 * onwards, std::min(course.to, 0.0), course.from, course.ends_on_something && ends_before);
  }
  if (course.to > 0) {
    count_way(onwards, std::max(course.from, 0.0), course.to, course.ends_on_something && !ends_before);
  }
}

}  // namespace flirt
