#include "flirt/core/scan.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace flirt {

Reading classify(double range, const Beams& beams) {
  if (std::isnan(range) || range < 0) { return Reading::invalid; }
  if (range == 0 || range >= beams.range_max || range == std::numeric_limits<double>::infinity()) {
    return Reading::no_return;
  }
  return range < beams.range_min ? Reading::invalid : Reading::hit;
}

bool is_full_turn(const Scan& scan) {
  const double step = std::abs(scan.beams.angle_step);
  return step * static_cast<double>(scan.ranges.size()) > 2.0 * std::numbers::pi - 0.5 * step && step > 0;
}

std::vector<BeamPoint> hit_points(const Scan& scan) {
  std::vector<BeamPoint> points;
  points.reserve(scan.ranges.size());
  const std::size_t n = scan.ranges.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = scan.beams.angle_step < 0 ? n - 1 - k : k;
    const double range = scan.ranges[i];
    if (classify(range, scan.beams) != Reading::hit) { continue; }
    const double angle = scan.beams.angle(i);
    points.push_back({{range * std::cos(angle), range * std::sin(angle)}, static_cast<std::uint32_t>(i)});
  }
  return points;
}

}  // namespace flirt
