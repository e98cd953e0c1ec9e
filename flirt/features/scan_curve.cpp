#include "flirt/features/scan_curve.hpp"

#include <cmath>

namespace flirt {

bool ScanCurve::adjacent(std::size_t i, std::size_t j) const {
  const std::uint32_t low = beams[i] < beams[j] ? beams[i] : beams[j];
  const std::uint32_t high = beams[i] < beams[j] ? beams[j] : beams[i];
  return high - low == 1 || (closed && beam_count > 2 && low == 0 && high + 1 == beam_count);
}

void ScanCurveReader::update_directions(const Scan& scan) {
  if (scan.beams == beams_ && cosines_.size() == scan.ranges.size()) { return; }
  beams_ = scan.beams;
  cosines_.resize(scan.ranges.size());
  sines_.resize(scan.ranges.size());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    cosines_[i] = std::cos(beams_.angle(i));
    sines_[i] = std::sin(beams_.angle(i));
  }
}

const ScanCurve& ScanCurveReader::read(const Scan& scan, NoReturn no_return) {
  update_directions(scan);
  const std::size_t n = scan.ranges.size();
  curve_.beams.clear();
  curve_.ranges.clear();
  curve_.cosines.clear();
  curve_.sines.clear();
  curve_.x.clear();
  curve_.y.clear();
  curve_.hit.clear();
  curve_.beam_count = n;
  curve_.closed = is_full_turn(scan);
  const bool keep = no_return == NoReturn::at_range_max && std::isfinite(scan.beams.range_max);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = scan.beams.angle_step < 0 ? n - 1 - k : k;
    const Reading reading = classify(scan.ranges[i], scan.beams);
    if (reading == Reading::invalid || (reading == Reading::no_return && !keep)) { continue; }
    const double range = reading == Reading::hit ? scan.ranges[i] : scan.beams.range_max;
    curve_.beams.push_back(static_cast<std::uint32_t>(i));
    curve_.ranges.push_back(range);
    curve_.cosines.push_back(cosines_[i]);
    curve_.sines.push_back(sines_[i]);
    curve_.x.push_back(range * cosines_[i]);
    curve_.y.push_back(range * sines_[i]);
    curve_.hit.push_back(reading == Reading::hit);
  }
  return curve_;
}

}  // namespace flirt
