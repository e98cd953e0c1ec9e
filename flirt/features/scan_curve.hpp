// flirt/features/scan_curve.hpp: the curve that a scan draws, as the detectors walk along it.
#pragma once

#include "flirt/core/scan.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// What becomes of beams without a return.
enum class NoReturn {
  drop,          ///< the curve goes on from the hit before to the hit after
  at_range_max,  ///< they count as points at Beams::range_max where that is finite; no keypoint lands on them
};
constexpr auto enum_names(NoReturn /*tag*/) {
  return std::to_array<std::pair<NoReturn, std::string_view>>(
      {{NoReturn::drop, "drop"}, {NoReturn::at_range_max, "at-range-max"}});
}

/// Points in order of increasing angle, sensor frame. All vectors have one element per point.
struct ScanCurve {
  std::vector<std::uint32_t> beams;  ///< indices into Scan::ranges
  std::vector<double> ranges;        ///< m
  std::vector<double> cosines;       ///< of the beam's angle
  std::vector<double> sines;         ///< of the beam's angle
  std::vector<double> x;             ///< m
  std::vector<double> y;             ///< m
  std::vector<bool> hit;             ///< false for a beam without a return that counts as a point
  std::size_t beam_count{0};         ///< of the scan
  bool closed{false};                ///< full turn: the last point is followed by the first

  [[nodiscard]] std::size_t size() const { return beams.size(); }
  /// True when point j comes right after point i and no beam lies between.
  [[nodiscard]] bool adjacent(std::size_t i, std::size_t j) const;
};

/// Makes curves of scans; keeps the directions of the beams from one scan to the next, and all memory.
class ScanCurveReader {
 public:
  const ScanCurve& read(const Scan& scan, NoReturn no_return);

 private:
  void update_directions(const Scan& scan);

  Beams beams_{};
  std::vector<double> cosines_;  ///< of every beam
  std::vector<double> sines_;    ///< of every beam
  ScanCurve curve_;
};

}  // namespace flirt
