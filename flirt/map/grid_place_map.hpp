// flirt/map/grid_place_map.hpp: a place map from an occupancy grid map, such as a robot's map server has.
//
//   const Result<GridMapImage> grid = read_grid_map("office.yaml");   // flirt/io/ros_map.hpp
//   const Result<PlaceMap> map = place_map_from_grid(grid->image, grid->metadata);
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/parallel.hpp"
#include "flirt/core/result.hpp"
#include "flirt/features/extract.hpp"
#include "flirt/grid/grey_image.hpp"
#include "flirt/map/place_map.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>

namespace flirt {

struct GridPlaceMapParams {
  double spacing{1.0};       ///< m, side of the squares that get a virtual scan each
  double clearance{0.3};     ///< m that virtual scans keep from anything occupied
  double range_max{20.0};    ///< m, reach of virtual scans
  std::uint32_t beams{360};  ///< of a virtual scan, over a full turn
  std::uint32_t counts{8};   ///< hits of an occupied cell, passes of a free one
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, GridPlaceMapParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.spacing, Field{"spacing", "m", "side of the squares that get a virtual scan each", 0.2, 100});
  visit(params.clearance, Field{"clearance", "m", "that virtual scans keep from anything occupied", 0.05, 0.75});
  visit(params.range_max, Field{"range_max", "m", "reach of virtual scans", 0.5, 50});
  visit(params.beams, Field{"beams", "", "of a virtual scan, over a full turn", 8, 7200});
  visit(params.counts, Field{"counts", "", "hits of an occupied cell, passes of a free one", 2, 1000});
}

/// The evidence is the grid itself, whatever its resolution and rotation: a cell of 0.05 m is occupied when anything in
/// it is (with hits by the share of its area, so that walls stay where they are to less than a cell), and free when
/// most of it is; what beams pass, and what thick walls are, is in `grid_pixels.hpp`. Each square of free space gets a
/// virtual scan, at the clear cell nearest to its middle, for keypoints; its beams end on occupied cells, and have no
/// return where they come to unknown ones. `map_from_sensor` of virtual scans has heading 0. Errors: no pixel is free;
/// pixels smaller than 1 mm; the map covers more than 1 km², or lies more than 1000 km from its origin. Parallel; the
/// same on any number of threads. O(16 · cells + pixels + scans · beams · reach).
[[nodiscard]] Result<PlaceMap> place_map_from_grid(const GreyImage& image, const GridMapMetadata& metadata,
                                                   const GridPlaceMapParams& params = {},
                                                   const FeatureParams& features = {}, std::size_t threads = 0,
                                                   const Progress& progress = {},
                                                   MapVariances variances = MapVariances::leave_out);

}  // namespace flirt
