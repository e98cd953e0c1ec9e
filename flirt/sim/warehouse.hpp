// flirt/sim/warehouse.hpp: halls with rows of racks, in which pallets come and go.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/sim/floor_plan.hpp"

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace flirt {

/// One hall: walls with pillars, dock doors in the long wall at y = 0, an office in a far corner, and double rows of
/// racks along x with a cross aisle in the middle. Aisles look alike; what tells them apart are the pallets, some of
/// which another visit finds elsewhere.
struct WarehouseParams {
  double length{60};       ///< m, along the racks
  double width{40};        ///< m, across
  double aisle{3};         ///< m, between racks
  double filled{0.55};     ///< share of the pallet places that are taken
  double changed{0};       ///< share of the pallet places and of the goods on the floor that are drawn anew
  std::uint64_t seed{1};   ///< another seed, another building
  std::uint64_t visit{1};  ///< another visit, other changes
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, WarehouseParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.length, Field{"length", "m", "of the hall, along the racks", 20, 1000});
  visit(params.width, Field{"width", "m", "of the hall, across the racks", 15, 1000});
  visit(params.aisle, Field{"aisle", "m", "between racks", 2, 8});
  visit(params.filled, Field{"filled", "1", "share of the pallet places that are taken", 0, 1});
  visit(params.changed, Field{"changed", "1", "share of pallet places and floor goods drawn anew: later on", 0, 1});
  visit(params.seed, Field{"seed", "", "another seed, another building"});
  visit(params.visit, Field{"visit", "", "another visit, other changes"});
}

/// Places are points along the aisles, the cross aisle, both ends and the edge of the dock zone, none nearer than
/// 0.6 m to anything. Each pallet place and each of the goods on the floor has a stream of random numbers to itself, so
/// that what is not drawn anew stays bit for bit. O(area).
[[nodiscard]] World make_warehouse(const WarehouseParams& params);

}  // namespace flirt
