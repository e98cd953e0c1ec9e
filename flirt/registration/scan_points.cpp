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
  while (end < points.size() &&
         std::abs(static_cast<double>(scan.ranges[points[end].beam] - scan.ranges[points[end - 1].beam])) < gap) {
    ++end;
  }
  return end;
}

/// Whether one of the two readings next to a thing, `step` away from its outermost point, is longer by the gap. Two,
/// since a beam that meets the edge of a leg may return a range between that of the leg and that of what is behind.
bool is_left_behind(std::span<const BeamPoint> points, const Scan& scan, std::size_t outermost, std::ptrdiff_t step,
                    double gap) {
  for (std::ptrdiff_t k = 1; k <= 2; ++k) {
    const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(outermost) + k * step;
    if (i < 0 || i >= std::ssize(points)) { return false; }
    if (scan.ranges[points[static_cast<std::size_t>(i)].beam] > scan.ranges[points[outermost].beam] + gap) {
      return true;
    }
  }
  return false;
}

/// The points without those on legs that stand before all that is beside them.
std::vector<BeamPoint> without_nearest_legs(std::span<const BeamPoint> points, const Scan& scan,
                                            const ScanPointParams& params) {
  std::vector<BeamPoint> kept;
  kept.reserve(points.size());
  for (std::size_t begin = 0; begin < points.size();) {
    const std::size_t end = end_of_thing(points, scan, begin, params.leg_gap / 2);
    const bool narrow = norm(points[end - 1].point - points[begin].point) < params.leg_width;
    const bool is_leg = narrow && is_left_behind(points, scan, begin, -1, params.leg_gap) &&
                        is_left_behind(points, scan, end - 1, 1, params.leg_gap);
    if (!is_leg) {
      kept.insert(kept.end(), points.begin() + static_cast<std::ptrdiff_t>(begin),
                  points.begin() + static_cast<std::ptrdiff_t>(end));
    }
    begin = end;
  }
  return kept;
}

/// The points without those on legs. Once a leg is gone, one half behind it stands free, too.
std::vector<BeamPoint> without_legs(std::vector<BeamPoint> points, const Scan& scan, const ScanPointParams& params) {
  if (params.leg_width <= 0) { return points; }
  for (;;) {
    std::vector<BeamPoint> kept = without_nearest_legs(points, scan, params);
    if (kept.size() == points.size()) { return kept; }
    points = std::move(kept);
  }
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
