// flirt/arena/polar_scan.hpp: a scan as the rival methods look at it: returns in order of angle, neighbours by
// distance.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/scan.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace flirt {

/// Which returns count.
struct ReturnLimits {
  double range_min{0.1};  ///< m, returns must be longer
  double range_max{30};   ///< m, the longest return that counts
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, ReturnLimits>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.range_min, Field{"range_min", "m", "returns must be longer", 0.0, 1e3});
  visit(params.range_max, Field{"range_max", "m", "the longest return that counts", 0.0, 1e6});
}

/// One element per beam, in order of increasing angle whichever way the scanner turns.
struct PolarScan {
  std::vector<double> ranges{};        ///< m; 0 where the beam has no return that counts
  std::vector<Point2> points{};        ///< m, sensor frame; the origin where there is no return
  std::vector<std::uint32_t> beams{};  ///< indices into Scan::ranges
  double step{0};                      ///< rad, from one beam to the next, > 0
  bool is_closed{false};               ///< the first and the last beam are neighbours

  [[nodiscard]] std::size_t size() const { return ranges.size(); }
  [[nodiscard]] bool has_return(std::size_t i) const { return ranges[i] > 0; }
};

/// O(beams).
[[nodiscard]] PolarScan polar_scan(const Scan& scan, const ReturnLimits& limits);

/// How far one looks around a return: A e^(B range), and 0.8 of the range where that is more than the range.
struct ReachParams {
  double reach{0.1};          ///< m, A: at the sensor
  double reach_growth{0.07};  ///< 1/m, B
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, ReachParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.reach, Field{"reach", "m", "radius of the neighbourhood at the sensor", 1e-3, 10.0});
  visit(params.reach_growth, Field{"reach_growth", "1/m", "growth of its logarithm with the range", 0.0, 1.0});
}

/// m.
[[nodiscard]] double reach_at(double range, const ReachParams& params);

/// Elements of a PolarScan near another, by rising angle on either side.
struct Neighbours {
  std::vector<std::uint32_t> left{};   ///< at smaller angles
  std::vector<std::uint32_t> right{};  ///< at larger angles
};

/// Whether a point just as far as the radius is a neighbour.
enum class Boundary : std::uint8_t { included, excluded };

/// All returns within `radius` (m) of return i but itself; gaps do not end them, and a closed scan has no seam.
/// O(beams within the radius as seen from the sensor).
[[nodiscard]] Neighbours neighbours_of(const PolarScan& scan, std::size_t i, double radius,
                                       Boundary boundary = Boundary::included);

/// Elements that survive non-maximum suppression, ascending. A score > 0 is a candidate, larger is better. The window
/// is as wide as `radius` (m) looks at the candidate's range; of a run of equal maxima the middle one stays.
/// O(beams · window).
[[nodiscard]] std::vector<std::uint32_t> local_maxima(const PolarScan& scan, std::span<const double> scores,
                                                      double radius);

}  // namespace flirt
