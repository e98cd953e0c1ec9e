// tests/sim/closed_room.hpp: the simplest floor plan.
#pragma once

#include "flirt/sim/floor_plan.hpp"

namespace flirt {

/// Four walls, m; one corner is the origin.
inline FloorPlan closed_room(double width, double height) {
  return {{{{0, 0}, {width, 0}}, {{width, 0}, {width, height}}, {{width, height}, {0, height}}, {{0, height}, {0, 0}}},
          {},
          {}};
}

}  // namespace flirt
