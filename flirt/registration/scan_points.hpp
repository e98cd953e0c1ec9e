// flirt/registration/scan_points.hpp: what registration needs of a scan: end points, thinned to even spacing.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/scan.hpp"

#include <concepts>
#include <cstddef>
#include <vector>

namespace flirt {

struct ScanPointParams {
  double spacing{0.1};     ///< m, least distance between consecutive end points that are kept
  double range_min{0.05};  ///< m, shorter readings are not used
  double range_max{50.0};  ///< m, longer readings are not used
  double leg_width{0.2};   ///< m, what is narrower and stands free before all around it is left out; 0: nothing is
  double leg_gap{0.3};     ///< m, by which the readings on both sides of it are longer
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, ScanPointParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.spacing, Field{"spacing", "m", "least distance between end points that are kept", 0.0, 1.0});
  visit(params.range_min, Field{"point_range_min", "m", "shorter readings are not used", 0.0, 10.0});
  visit(params.range_max, Field{"point_range_max", "m", "longer readings are not used", 0.1, 100.0});
  visit(params.leg_width, Field{"leg_width", "m", "narrower things that stand free are left out", 0.0, 2.0});
  visit(params.leg_gap, Field{"leg_gap", "m", "by which readings on both sides of them are longer", 0.01, 10.0});
}

/// End points in order of increasing angle, in the sensor frame. Walls close to the sensor would otherwise outweigh
/// those far away, as they get many more beams a metre.
struct ScanPoints {
  std::vector<float> x{};      ///< m
  std::vector<float> y{};      ///< m
  std::vector<float> range{};  ///< m, √(x² + y²); 0: seen from another place, no beam of this one ended here

  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// Leaves out legs of people and chairs, which move and tell places apart wrongly: runs of neighbouring beams,
/// `leg_width` across at most, with longer readings on both sides once legs before them are gone. Of the others keeps
/// the first end point, and each that lies at least `spacing` from the last one kept; of a full turn the last one only
/// when it is not too near to the first. O(beams · legs one behind another).
[[nodiscard]] ScanPoints scan_points(const Scan& scan, const ScanPointParams& params = {});

}  // namespace flirt
