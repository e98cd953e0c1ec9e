// flirt/sim/station.hpp: two places of a railway station, as the navigation paper's figures 9 and 10 show them: a
// tunnel between platforms, and a round through hall, hallway and platform.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/sim/floor_plan.hpp"

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace flirt {

/// A straight passage with bare walls; at each end stairs, a round column, and where the way ends a convex corner and
/// a bin of three sides.
struct TunnelParams {
  double length{45};  ///< m
  double width{5};    ///< m
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, TunnelParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.length, Field{"length", "m", "of the bare walls", 5, 1000});
  visit(params.width, Field{"width", "m", "between the bare walls", 3, 20});
}

/// A hall, a hallway with shops, a platform beside a train, and a passage that joins their far ends: a round.
struct StationParams {
  double length{200};     ///< m, of hallway and platform; the round is some 2.4 times as long
  std::uint64_t seed{1};  ///< another seed, other shops
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, StationParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.length, Field{"length", "m", "of hallway and platform", 40, 1000});
  visit(params.seed, Field{"seed", "", "another seed, other shops"});
}

/// The tour leads from one end to the other. O(length).
[[nodiscard]] World make_tunnel(const TunnelParams& params);
/// The tour is one round from the hall to the hall. O(length).
[[nodiscard]] World make_station(const StationParams& params);

}  // namespace flirt
