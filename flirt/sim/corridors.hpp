// flirt/sim/corridors.hpp: long corridors that cross, with nothing but closed doors along them.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/sim/floor_plan.hpp"

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace flirt {

/// Three corridors along, four across, around six blocks without rooms. The doors are shut and stand back a hand's
/// breadth: all that tells how far a robot went. Loops are hundreds of metres long.
struct CorridorParams {
  double length{240};     ///< m, of the corridors along; those across are half as long
  double width{2.4};      ///< m, between the walls
  std::uint64_t seed{1};  ///< another seed, other doors
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, CorridorParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.length, Field{"length", "m", "of the corridors along; those across are half as long", 40, 2000});
  visit(params.width, Field{"width", "m", "between the walls", 1.2, 6});
  visit(params.seed, Field{"seed", "", "another seed, other doors"});
}

/// Places are the crossings and points between them. O(length).
[[nodiscard]] World make_corridors(const CorridorParams& params);

}  // namespace flirt
