#include "flirt/features/describe_geometry.hpp"

#include <algorithm>
#include <limits>

namespace flirt {
namespace {

/// Length 0 for a beam that says nothing.
FanBeam beam_of(double range, Point2 direction, const Beams& layout, NoReturnMeaning no_return) {
  if (!std::isfinite(direction.x) || !std::isfinite(direction.y)) { return {direction, 0.0, false}; }
  switch (classify(range, layout)) {
    case Reading::hit:
      return {direction, range, true};
    case Reading::no_return:
      return {direction, no_return == NoReturnMeaning::free_space ? layout.range_max : 0.0, false};
    case Reading::invalid:
      break;
  }
  return {direction, 0.0, false};
}

}  // namespace

void BeamFan::assign(const Scan& scan, NoReturnMeaning no_return) {
  const bool same_directions = scan.beams == layout_ && scan.ranges.size() == beams_.size();
  layout_ = scan.beams;
  beams_.resize(scan.ranges.size());
  for (std::size_t i = 0; i < beams_.size(); ++i) {
    const double angle = layout_.angle(i);
    const Point2 direction = same_directions ? beams_[i].direction : Point2{std::cos(angle), std::sin(angle)};
    beams_[i] = beam_of(scan.ranges[i], direction, layout_, no_return);
  }
}

BeamFan::Window BeamFan::window_around(Point2 centre, double radius) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Window all{0.0, static_cast<double>(beams_.size()), infinity};
  const double turn = 2.0 * std::numbers::pi / std::abs(layout_.angle_step);
  const double distance = norm(centre);
  const bool is_ordinary = turn >= 8.0 && std::isfinite(turn) && std::isfinite(layout_.angle_min);
  if (distance <= radius || !is_ordinary) { return all; }
  const double bearing = std::atan2(centre.y, centre.x);
  const double middle = (bearing - layout_.angle_min) / layout_.angle_step;
  const double half = std::asin(radius / distance) / std::abs(layout_.angle_step) + 1.0;  // one more against rounding
  const double high = middle + half + 1.0;
  const double shift = turn * std::floor(high / turn);  // the first window that ends behind beam 0
  return {middle - half - shift, high - shift, turn};
}

}  // namespace flirt
