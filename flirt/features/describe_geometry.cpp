#include "flirt/features/describe_geometry.hpp"

#include <algorithm>
#include <limits>

namespace flirt {
namespace {

/// Fills in what the reading says; length 0 when that is nothing.
void read_beam(FanBeam& beam, double range, const Beams& layout, NoReturnMeaning no_return) {
  const Reading reading = std::isfinite(beam.direction.x) ? classify(range, layout) : Reading::invalid;
  const bool is_free = reading == Reading::no_return && no_return == NoReturnMeaning::free_space;
  beam.has_return = reading == Reading::hit;
  beam.length = beam.has_return ? range : (is_free ? layout.range_max : 0.0);
}

}  // namespace

void BeamFan::assign(const Scan& scan, NoReturnMeaning no_return) {
  if (scan.beams != layout_ || scan.ranges.size() != beams_.size()) {
    layout_ = scan.beams;
    beams_.clear();
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      const double angle = layout_.angle(i);
      beams_.push_back({.direction = {std::cos(angle), std::sin(angle)}});
    }
  }
  for (std::size_t i = 0; i < beams_.size(); ++i) { read_beam(beams_[i], scan.ranges[i], layout_, no_return); }
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
