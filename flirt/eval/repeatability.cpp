#include "flirt/eval/repeatability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

namespace flirt {
namespace {

/// Area of the part of a disc of radius r that lies beyond a chord at distance d (signed) from its centre, m².
double segment_area(double r, double d) {
  const double ratio = std::clamp(d / r, -1.0, 1.0);
  return r * r * std::acos(ratio) - d * std::sqrt(std::max(0.0, r * r - d * d));
}

double intersection_area(const Region& a, const Region& b) {
  const double d = norm(a.centre - b.centre);
  const double smaller = std::min(a.radius, b.radius);
  if (d >= a.radius + b.radius) { return 0; }
  if (d <= std::abs(a.radius - b.radius)) { return std::numbers::pi * smaller * smaller; }
  const double chord = (d * d + a.radius * a.radius - b.radius * b.radius) / (2 * d);
  return segment_area(a.radius, chord) + segment_area(b.radius, d - chord);
}

std::vector<Point2> within(const Region& region, std::span<const Point2> points) {
  std::vector<Point2> inside;
  for (const Point2& point : points) {
    if (squared_norm(point - region.centre) <= region.radius * region.radius) { inside.push_back(point); }
  }
  return inside;
}

}  // namespace

double overlap_error(const Region& a, const Region& b) {
  const double areas = std::numbers::pi * (a.radius * a.radius + b.radius * b.radius);
  if (areas == 0) { return a.centre == b.centre ? 0 : 1; }
  const double common = intersection_area(a, b);
  return 1 - common / (areas - common);
}

double modified_hausdorff(const Region& region, std::span<const Point2> from, std::span<const Point2> to) {
  const std::vector<Point2> shape = within(region, from);
  const std::vector<Point2> other = within(region, to);
  if (shape.empty() || other.empty()) { return std::numeric_limits<double>::infinity(); }
  double sum = 0;
  for (const Point2& p : shape) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Point2& q : other) { nearest = std::min(nearest, squared_norm(p - q)); }
    sum += std::sqrt(nearest);
  }
  return sum / static_cast<double>(shape.size());
}

std::vector<RegionPair> overlapping_pairs(std::span<const Region> reference, std::span<const Region> other,
                                          double max_error) {
  std::vector<RegionPair> pairs;
  for (std::uint32_t i = 0; i < reference.size(); ++i) {
    for (std::uint32_t j = 0; j < other.size(); ++j) {
      if (overlap_error(reference[i], other[j]) < max_error) { pairs.push_back({i, j}); }
    }
  }
  return pairs;
}

std::vector<RegionPair> one_to_one_pairs(std::span<const Region> reference, std::span<const Region> other,
                                         double max_error) {
  std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> ranked;
  for (const RegionPair& pair : overlapping_pairs(reference, other, max_error)) {
    ranked.emplace_back(overlap_error(reference[pair.reference], other[pair.other]), pair.reference, pair.other);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<bool> reference_taken(reference.size());
  std::vector<bool> other_taken(other.size());
  std::vector<RegionPair> pairs;
  for (const auto& [error, i, j] : ranked) {
    if (reference_taken[i] || other_taken[j]) { continue; }
    reference_taken[i] = true;
    other_taken[j] = true;
    pairs.push_back({i, j});
  }
  return pairs;
}

RepeatabilityCounts& RepeatabilityCounts::operator+=(const RepeatabilityCounts& other) {
  keypoints += other.keypoints;
  present += other.present;
  corresponding += other.corresponding;
  scans += other.scans;
  return *this;
}

RepeatabilityCounts repeatability(const RegionScan& reference, const RegionScan& other,
                                  const RepeatabilityParams& params) {
  std::vector<Region> present;
  for (const Region& region : reference.regions) {
    if (modified_hausdorff(region, reference.points, other.points) < params.presence) { present.push_back(region); }
  }
  const auto pairs = one_to_one_pairs(present, other.regions, params.overlap_error);
  return {.keypoints = static_cast<std::uint32_t>(reference.regions.size()),
          .present = static_cast<std::uint32_t>(present.size()),
          .corresponding = static_cast<std::uint32_t>(pairs.size()),
          .scans = 1};
}

std::vector<Region> regions_of(std::span<const Keypoint> keypoints, const Pose2& reference_from_sensor, RegionRule rule,
                               double common_radius) {
  std::vector<Region> regions;
  regions.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) {
    const double radius = rule == RegionRule::common ? common_radius : static_cast<double>(keypoint.support_radius);
    regions.push_back({reference_from_sensor * keypoint.sensor_from_keypoint.translation(), radius});
  }
  return regions;
}

}  // namespace flirt
