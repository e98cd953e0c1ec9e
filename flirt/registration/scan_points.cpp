#include "flirt/registration/scan_points.hpp"

namespace flirt {

ScanPoints scan_points(const Scan& scan, const ScanPointParams& params) {
  ScanPoints points;
  Point2 last;
  for (const BeamPoint& hit : hit_points(scan)) {
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
