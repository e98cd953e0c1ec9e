// tests/features/slow_beta_grid.hpp: an independent, slow derivation of what a beam says about a bin: the ray is
// clipped to the two half planes of the bin's sides, and the disc of the inner arc is cut out of that of the outer one.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/features/beta_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace flirt::slow {

struct Sector {
  double from_angle{0};  ///< rad, relative to the keypoint's direction
  double to_angle{0};
  double inner{0};  ///< m
  double outer{0};
};

/// Part of a ray, by the distance from the sensor.
struct Piece {
  double from{0};  ///< m
  double to{0};
};

inline Sector sector_of(const BetaGridParams& params, std::uint32_t bin, double outer_radius) {
  const std::uint32_t a = bin / params.radial_bins;
  const std::uint32_t j = bin % params.radial_bins;
  const double angle = 2.0 * std::numbers::pi / params.angular_bins;
  const double width = (outer_radius - params.inner_radius) / params.radial_bins;
  const double inner = params.inner_radius + j * width;
  return {-std::numbers::pi + a * angle - params.angular_inflation,
          -std::numbers::pi + (a + 1) * angle + params.angular_inflation,
          std::max(params.inner_radius, inner - params.radial_inflation), inner + width + params.radial_inflation};
}

/// Where |origin + t · direction| < radius.
inline Piece inside_disc(Point2 origin, Point2 direction, double radius) {
  const double b = dot(origin, direction);
  const double discriminant = b * b - squared_norm(origin) + radius * radius;
  if (discriminant <= 0) { return {0, 0}; }
  return {-b - std::sqrt(discriminant), -b + std::sqrt(discriminant)};
}

inline void clip_to_half_plane(Piece& piece, double value, double slope) {  // keeps t with value + t · slope ≥ 0
  if (slope > 0) {
    piece.from = std::max(piece.from, -value / slope);
  } else if (slope < 0) {
    piece.to = std::min(piece.to, -value / slope);
  } else if (value < 0) {
    piece.to = piece.from;
  }
}

/// The parts of an endless beam inside a sector (less than half a turn wide) around the keypoint, nearest first.
inline std::vector<Piece> pieces(const Pose2& sensor_from_keypoint, double beam_angle, const Sector& sector) {
  const Pose2 keypoint_from_sensor = inverse(sensor_from_keypoint);
  const Point2 origin = keypoint_from_sensor.translation();
  const double angle = beam_angle + keypoint_from_sensor.theta;
  const Point2 direction{std::cos(angle), std::sin(angle)};
  const Point2 low{std::cos(sector.from_angle), std::sin(sector.from_angle)};
  const Point2 high{std::cos(sector.to_angle), std::sin(sector.to_angle)};
  Piece all = inside_disc(origin, direction, sector.outer);
  all.from = std::max(all.from, 0.0);
  clip_to_half_plane(all, cross(low, origin), cross(low, direction));
  clip_to_half_plane(all, cross(origin, high), cross(direction, high));
  std::vector<Piece> result;
  const Piece hole = inside_disc(origin, direction, sector.inner);
  for (const Piece piece : {Piece{all.from, std::min(all.to, hole.from)}, Piece{std::max(all.from, hole.to), all.to}}) {
    if (hole.to > hole.from && piece.to > piece.from) { result.push_back(piece); }
  }
  if (hole.to <= hole.from && all.to > all.from) { result.push_back(all); }
  return result;
}

inline bool contains(const Pose2& sensor_from_keypoint, Point2 point, const Sector& sector) {
  const Point2 q = inverse(sensor_from_keypoint) * point;
  const double radius = std::hypot(q.x, q.y);
  const double centre = 0.5 * (sector.from_angle + sector.to_angle);
  const double off = std::abs(std::remainder(std::atan2(q.y, q.x) - centre, 2.0 * std::numbers::pi));
  return radius >= sector.inner && radius < sector.outer && off < 0.5 * (sector.to_angle - sector.from_angle);
}

struct Counts {
  std::vector<std::uint32_t> hits{};
  std::vector<std::uint32_t> misses{};
};

inline Counts count(const Scan& scan, const Pose2& sensor_from_keypoint, const BetaGridParams& params,
                    double outer_radius) {
  const std::uint32_t bins = params.angular_bins * params.radial_bins;
  Counts counts{std::vector<std::uint32_t>(bins), std::vector<std::uint32_t>(bins)};
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const Reading reading = classify(scan.ranges[i], scan.beams);
    const bool is_free = reading == Reading::no_return && params.no_return == NoReturnMeaning::free_space;
    if (reading != Reading::hit && !is_free) { continue; }
    const double angle = scan.beams.angle(i);
    const double end = is_free ? scan.beams.range_max : scan.ranges[i];
    const Point2 point{end * std::cos(angle), end * std::sin(angle)};
    for (std::uint32_t bin = 0; bin < bins; ++bin) {
      const Sector sector = sector_of(params, bin, outer_radius);
      if (!is_free && contains(sensor_from_keypoint, point, sector)) {
        ++counts.hits[bin];
        continue;
      }
      const std::vector<Piece> parts = pieces(sensor_from_keypoint, angle, sector);
      counts.misses[bin] += static_cast<std::uint32_t>(!parts.empty() && parts.front().from < end);
    }
  }
  return counts;
}

}  // namespace flirt::slow
