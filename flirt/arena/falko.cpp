#include "flirt/arena/falko.hpp"

#include "flirt/arena/sectors.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace flirt {
namespace {

/// The first point of the left side, the last of the right, and the candidate make a triangle that is not flat.
bool is_corner(const PolarScan& scan, const FalkoCandidate& candidate, double base_ratio) {
  const Point2 begin = scan.points[candidate.sides.left.front()];
  const Point2 along = scan.points[candidate.sides.right.back()] - begin;
  const double base = norm(along);
  const double smallest = candidate.reach / base_ratio;
  if (!(base > 0) || base < smallest) { return false; }
  return std::abs(cross(along, scan.points[candidate.element] - begin)) / base >= smallest;
}

Point2 mean_offset(const PolarScan& scan, Point2 origin, std::span<const std::uint32_t> side) {
  Point2 sum;
  for (const std::uint32_t j : side) { sum = sum + (scan.points[j] - origin); }
  return (1.0 / static_cast<double>(side.size())) * sum;
}

/// Sum over the pairs of neighbours of how far apart they lie in direction.
std::uint32_t unevenness(const PolarScan& scan, const FalkoCandidate& candidate, std::span<const std::uint32_t> side,
                         std::uint32_t sectors) {
  std::vector<std::uint32_t> own;
  for (const std::uint32_t j : side) {
    const double direction = direction_of(scan.points[j] - scan.points[candidate.element]);
    own.push_back(sector_of(direction - candidate.direction, sectors));
  }
  std::uint32_t sum = 0;
  for (std::size_t a = 0; a < own.size(); ++a) {
    for (std::size_t b = a + 1; b < own.size(); ++b) { sum += sector_distance(own[a], own[b], sectors); }
  }
  return sum;
}

/// normal · point = offset, the normal of length 1.
struct Line {
  Point2 normal;
  double offset;
};

/// Total least squares over one side and the candidate.
Line line_through(const PolarScan& scan, std::uint32_t element, std::span<const std::uint32_t> side) {
  const Point2 origin = scan.points[element];
  const double n = static_cast<double>(side.size()) + 1;
  const Point2 mean = (static_cast<double>(side.size()) / n) * mean_offset(scan, origin, side);
  double xx = mean.x * mean.x;
  double yy = mean.y * mean.y;
  double xy = mean.x * mean.y;
  for (const std::uint32_t j : side) {
    const Point2 offset = scan.points[j] - origin - mean;
    xx += offset.x * offset.x;
    yy += offset.y * offset.y;
    xy += offset.x * offset.y;
  }
  const double along = 0.5 * std::atan2(2 * xy, xx - yy);
  const Point2 normal{-std::sin(along), std::cos(along)};
  return {normal, dot(normal, origin + mean)};
}

/// Where the lines through both sides meet, unless they are parallel or meet far away: then the return itself.
Point2 point_between_beams(const PolarScan& scan, const FalkoCandidate& candidate) {
  constexpr double farthest = 0.2;  // m
  constexpr double parallel = 1e-7;
  const Line left = line_through(scan, candidate.element, candidate.sides.left);
  const Line right = line_through(scan, candidate.element, candidate.sides.right);
  const Point2 own = scan.points[candidate.element];
  const double determinant = cross(left.normal, right.normal);
  if (std::abs(determinant) < parallel) { return own; }
  const Point2 meet{(left.offset * right.normal.y - right.offset * left.normal.y) / determinant,
                    (left.normal.x * right.offset - right.normal.x * left.offset) / determinant};
  return norm(meet - own) < farthest ? meet : own;
}

/// The lead of each candidate over the worst; 0 where it is too small. When all are perfect, all are accepted.
std::vector<double> scores_of(const PolarScan& scan, std::span<const FalkoCandidate> candidates, double min_score) {
  std::vector<double> scores(scan.size());
  std::uint32_t worst = 0;
  for (const FalkoCandidate& candidate : candidates) { worst = std::max(worst, candidate.raw); }
  for (const FalkoCandidate& candidate : candidates) {
    const double lead = worst == 0 ? 1.0 : static_cast<double>(worst - candidate.raw);
    if (lead > worst * min_score / 100) { scores[candidate.element] = lead; }
  }
  return scores;
}

}  // namespace

FalkoParams tuned_falko() {
  FalkoParams params;
  params.reach.reach = 0.2;
  params.base_ratio = 8;
  return params;
}

FalkoParams sparse_falko() {
  FalkoParams params;
  params.reach.reach = 0.4;
  params.base_ratio = 12;
  params.min_score = 30;
  params.min_side_points = 1;
  return params;
}

std::vector<FalkoCandidate> falko_candidates(const PolarScan& scan, const FalkoParams& params) {
  std::vector<FalkoCandidate> candidates;
  for (std::uint32_t i = 0; i < scan.size(); ++i) {
    if (!scan.has_return(i)) { continue; }
    FalkoCandidate candidate{.element = i, .reach = reach_at(scan.ranges[i], params.reach)};
    candidate.sides = neighbours_of(scan, i, candidate.reach);
    const auto& [left, right] = candidate.sides;
    if (std::min(left.size(), right.size()) < std::max(params.min_side_points, 1U)) { continue; }
    if (!is_corner(scan, candidate, params.base_ratio)) { continue; }
    candidate.direction =
        direction_of(mean_offset(scan, scan.points[i], left) + mean_offset(scan, scan.points[i], right));
    candidate.raw =
        unevenness(scan, candidate, left, params.sectors) + unevenness(scan, candidate, right, params.sectors);
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

std::vector<Keypoint> detect_falko(const Scan& scan, const FalkoParams& params) {
  const PolarScan polar = polar_scan(scan, params.limits);
  const std::vector<FalkoCandidate> candidates = falko_candidates(polar, params);
  const std::vector<double> scores = scores_of(polar, candidates, params.min_score);
  std::vector<Keypoint> keypoints;
  for (const std::uint32_t i : local_maxima(polar, scores, params.suppression_radius)) {
    const auto& candidate = *std::ranges::lower_bound(candidates, i, {}, &FalkoCandidate::element);
    const Point2 point = params.between_beams ? point_between_beams(polar, candidate) : polar.points[i];
    keypoints.push_back({.sensor_from_keypoint = {point.x, point.y, candidate.direction},
                         .scale = static_cast<float>(candidate.reach),
                         .support_radius = static_cast<float>(candidate.reach),
                         .response = static_cast<float>(scores[i]),
                         .beam = polar.beams[i]});
  }
  return keypoints;
}

}  // namespace flirt
