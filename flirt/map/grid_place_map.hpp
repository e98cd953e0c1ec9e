// flirt/map/grid_place_map.hpp: a place map from an occupancy grid map, such as a robot's map server has.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/result.hpp"
#include "flirt/features/extract.hpp"
#include "flirt/grid/grey_image.hpp"
#include "flirt/map/place_map.hpp"

#include <concepts>
#include <cstdint>

namespace flirt {

struct GridPlaceMapParams {
  double spacing{1.0};       ///< m between the places of virtual scans
  double clearance{0.3};     ///< m that virtual scans keep from anything occupied
  double range_max{20.0};    ///< m, reach of virtual scans
  std::uint32_t beams{360};  ///< of a virtual scan, over a full turn
  std::uint32_t counts{8};   ///< hits of an occupied and passes of a free cell
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, GridPlaceMapParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.spacing, Field{"spacing", "m", "between the places of virtual scans", 0.1, 100});
  visit(params.clearance, Field{"clearance", "m", "that virtual scans keep from anything occupied", 0, 10});
  visit(params.range_max, Field{"range_max", "m", "reach of virtual scans", 0.5, 50});
  visit(params.beams, Field{"beams", "", "of a virtual scan, over a full turn", 8, 7200});
  visit(params.counts, Field{"counts", "", "hits of an occupied and passes of a free cell", 2, 1000});
}

/// The evidence is the grid itself: an occupied pixel counts in every cell of 0.05 m that it touches, a free one in
/// those where nothing is occupied. Virtual scans, cast on a lattice of free places, give the keypoints. An error when
/// the grid has no free cell, or the map would be larger than 10 km. O(pixels + places · beams · reach).
[[nodiscard]] Result<PlaceMap> place_map_from_grid(const GreyImage& image, const GridMapMetadata& metadata,
                                                   const GridPlaceMapParams& params = {},
                                                   const FeatureParams& features = {});

}  // namespace flirt
