#include "flirt/registration/scan_points.hpp"

#include <cmath>
#include <cstddef>
#include <span>

namespace flirt {
namespace {

/// One past the last of the points from `begin` on that hang together: the ranges of neighbours differ by less than
/// `gap`.
std::size_t end_of_thing(std::span<const BeamPoint> points, const Scan& scan, std::size_t begin, double gap) {
  std::size_t end = begin + 1;
  while (end < points.size() && points[end].beam == points[end - 1].beam + 1 &&
         std::abs(static_cast<double>(scan.ranges[points[end].beam] - scan.ranges[points[end - 1].beam])) < gap) {
    ++end;
  }
  return end;
}

/// The points without those on legs.
std::vector<BeamPoint> without_legs(std::vector<BeamPoint> points, const Scan& scan, const ScanPointParams& params) {
  if (params.leg_width <= 0) { return points; }
  const auto range = [&](std::size_t i) { return static_cast<double>(scan.ranges[points[i].beam]); };
  std::vector<BeamPoint> kept;
  kept.reserve(points.size());
  for (std::size_t begin = 0; begin < points.size();) {
    const std::size_t end = end_of_thing(points, scan, begin, params.leg_gap / 2);
    const bool before_left = begin > 0 && range(begin - 1) > range(begin) + params.leg_gap;
    const bool before_right = end < points.size() && range(end) > range(end - 1) + params.leg_gap;
    const bool narrow = norm(points[end - 1].point - points[begin].point) < params.leg_width;
    if (!(narrow && before_left && before_right)) {
      for (std::size_t i = begin; i < end; ++i) { kept.push_back(points[i]); }
    }
    begin = end;
  }
  return kept;
}

}  // namespace

ScanPoints scan_points(const Scan& scan, const ScanPointParams& params) {
  ScanPoints points;
  Point2 last;
  for (const BeamPoint& hit : without_legs(hit_points(scan), scan, params)) {
    const double range = scan.ranges[hit.beam];
    if (range < params.range_min || range >= params.range_max) { continue; }
    if (points.size() != 0 && norm(hit.point - last) < params.spacing) { continue; }
    last = hit.point;
    points.x.push_back(static_cast<float>(last.x));
    points.y.push_back(static_cast<float>(last.y));
    points.range.push_back(static_cast<float>(range));
  }
  if (points.size() > 1 && is_full_turn(scan)) {  // the first point is the neighbour of the last one, too
    const Point2 first{points.x.front(), points.y.front()};
    if (norm(first - last) < params.spacing) {
      points.x.pop_back();
      points.y.pop_back();
      points.range.pop_back();
    }
  }
  return points;
}

}  // namespace flirt
