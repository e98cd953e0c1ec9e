// flirt/sim/office.hpp: office buildings made up from a seed.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/sim/floor_plan.hpp"

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace flirt {

/// A building of parallel corridors with rooms on both sides, joined by cross corridors. 500 m² is one corridor,
/// 100 000 m² some three thousand rooms.
struct OfficeParams {
  double area{2000};             ///< m², of the building's floor
  double corridor_width{2.2};    ///< m, the mean
  double room_depth{5.2};        ///< m, the mean
  double room_width{4.2};        ///< m, the mean
  double open_doors{0.55};       ///< share of the doors that stand open
  double half_open_doors{0.15};  ///< share of the doors that stand half open
  double furniture{0.7};         ///< 0 = empty rooms, 1 = crammed
  double glass_fronts{0.12};     ///< share of the rooms with a glass pane to the corridor or to the outside
  double twin_rooms{0.15};       ///< share of the rooms that repeat their neighbour, furniture included
  std::uint64_t seed{1};         ///< another seed, another building
  double changed{0};             ///< share of the furniture and doors that people have moved: the same building later
  std::uint64_t visit{1};        ///< another visit, other changes
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, OfficeParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.area, Field{"area", "m2", "of the building's floor", 200, 1e6});
  visit(params.corridor_width, Field{"corridor_width", "m", "mean width of corridors", 1.6, 6});
  visit(params.room_depth, Field{"room_depth", "m", "mean depth of rooms", 3.5, 20});
  visit(params.room_width, Field{"room_width", "m", "mean width of rooms along the corridor", 2.8, 20});
  visit(params.open_doors, Field{"open_doors", "1", "share of the doors that stand open", 0, 1});
  visit(params.half_open_doors, Field{"half_open_doors", "1", "share of the doors that stand half open", 0, 1});
  visit(params.furniture, Field{"furniture", "1", "0: empty rooms, 1: crammed", 0, 1});
  visit(params.glass_fronts, Field{"glass_fronts", "1", "share of rooms with glass to corridor or outside", 0, 1});
  visit(params.twin_rooms, Field{"twin_rooms", "1", "share of rooms that repeat their neighbour", 0, 1});
  visit(params.seed, Field{"seed", "", "another seed, another building"});
  visit(params.changed, Field{"changed", "1", "share of furniture and doors moved: the same building later", 0, 1});
  visit(params.visit, Field{"visit", "", "another visit, other changes"});
}

/// The building, with the middle of each room and points along the corridors as places. What has `changed` was pushed
/// aside by a metre or less, turned, or carried away; walls, columns and places stay to the last bit. O(area).
[[nodiscard]] World make_office(const OfficeParams& params);

}  // namespace flirt
