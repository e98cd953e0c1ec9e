// tests/support/room_map.hpp: the furnished room of scenes.hpp as a place map, and scans of it.
#pragma once

#include "flirt/map/place_map.hpp"

#include "tests/support/scenes.hpp"

namespace flirt {

/// Made of eight scans around the room's middle.
[[nodiscard]] inline const PlaceMap& room_map() {
  static const PlaceMap map = build_place_map(log_of(furnished_room(), poses_around(1.2, 8))).value();
  return map;
}

[[nodiscard]] inline Scan room_scan(const Pose2& map_from_sensor) {
  return scan_of(furnished_room(), map_from_sensor, turn_beams(), turn_beam_count);
}

[[nodiscard]] inline bool is_near(const Pose2& pose, const Pose2& truth, double max_distance, double max_heading) {
  return distance(pose, truth) <= max_distance && heading_difference(pose, truth) <= max_heading;
}

}  // namespace flirt
