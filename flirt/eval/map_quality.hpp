// flirt/eval/map_quality.hpp: how well scans fit each other at given poses, without any truth.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/scan.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace flirt {

struct MapQualityParams {
  double reach{4.0};          ///< m, scans whose sensors are nearer than this may overlap
  std::uint32_t partners{8};  ///< scans that each scan is compared with, at most, drawn from all in reach
  double max_distance{0.15};  ///< m, a point further from all points of the other scan is not on the same wall
  double min_overlap{0.5};    ///< share of a scan's points on walls of the other; pairs with less do not count
  double cell_size{0.05};     ///< m, of the grid whose occupied cells are counted
  std::uint64_t seed{0};      ///< of the draw
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, MapQualityParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.reach, Field{"reach", "m", "scans nearer than this may overlap", 0.1, 100.0});
  visit(params.partners, Field{"partners", "", "scans that each scan is compared with, at most", 1.0, 1e6});
  visit(params.max_distance, Field{"max_distance", "m", "between points of the same wall, at most", 0.01, 5.0});
  visit(params.min_overlap,
        Field{"min_overlap", "1", "share of points on common walls; less does not count", 0.0, 1.0});
  visit(params.cell_size, Field{"cell_size", "m", "of the grid whose occupied cells are counted", 0.01, 1.0});
  visit(params.seed, Field{"seed", "", "of the draw of partners"});
}

struct MapQuality {
  double point_to_line_rms{0};    ///< m, over all points of overlapping pairs; 0 when there are none
  std::size_t pairs{0};           ///< that overlap
  std::size_t points{0};          ///< on common walls
  std::size_t occupied_cells{0};  ///< with a hit ratio ≥ 0.15: fewer for the same scans means sharper walls
};

/// Residuals of each scan's end points from the lines through the nearest points of up to `partners` other scans, and
/// the size of the map of all scans. `map_from_robot` has one pose per scan. The same on any number of threads.
/// O(scans² + scans · partners · points · window).
[[nodiscard]] MapQuality map_quality(const ScanLog& log, std::span<const Pose2> map_from_robot,
                                     const MapQualityParams& params = {}, std::size_t threads = 0);

}  // namespace flirt
