// flirt/sim/office_room.hpp: one room of a made-up office: walls, door, furniture.
#pragma once

#include "flirt/core/rng.hpp"
#include "flirt/sim/floor_plan.hpp"
#include "flirt/sim/office.hpp"

#include <cstdint>

namespace flirt::office {

inline constexpr double wall = 0.16;  ///< m, thickness of all inner walls

enum class RoomKind : std::uint8_t {
  study,     ///< desks, cabinets
  meeting,   ///< one large table with chairs
  workshop,  ///< benches, shelves, columns
  storage,   ///< shelves, small
  lounge,    ///< open to the corridor
};

enum class Outside : std::uint8_t { no, yes };

/// A room seen from its corridor: local x runs along the corridor to the right of someone looking in, y into the room,
/// the origin is the left end of the room's front on the corridor's side.
struct RoomSite {
  Point2 origin{};            ///< m, plan frame
  double right{1};            ///< plan x per local x, ±1
  double inwards{1};          ///< plan y per local y, ±1
  double width{0};            ///< m, between the middles of the side walls
  double depth{0};            ///< m, from the corridor to the middle of the back wall
  Outside back{Outside::no};  ///< the back wall is one of the building's own
  RoomKind kind{RoomKind::study};
  std::uint64_t seed{0};    ///< equal kinds, sizes and seeds: twins
  std::uint64_t number{0};  ///< of the room in the building
};

/// Adds the room to the world, its middle as a place.
void add_room(const RoomSite& site, const OfficeParams& params, World& world);

/// The four sides of a box turned by `angle` about its centre, in plan coordinates.
void add_box(FloorPlan& plan, Point2 center, double width, double depth, double angle = 0);

}  // namespace flirt::office
