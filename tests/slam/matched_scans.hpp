// tests/slam/matched_scans.hpp: scans with keypoints made by hand, so that it is known which of them agree.
#pragma once

#include "flirt/core/rng.hpp"
#include "flirt/features/extract.hpp"
#include "flirt/slam/slam_scan.hpp"

#include "tests/match/random_features.hpp"
#include "tests/support/scenes.hpp"

#include <cstddef>
#include <vector>

namespace flirt::test {

/// `scan` as mapping keeps it, with its own keypoints.
inline SlamScan with_keypoints(const Scan& scan) {
  SlamScan kept{.points = surface_points(scan, {}), .odom_from_robot = scan.odom_from_robot, .scan = scan};
  kept.features = extract(scan);
  kept.keypoints = table_of(kept.features.keypoints);
  return kept;
}

/// What a robot at this pose sees of a furnished room.
inline Scan seen_in_room(const Pose2& map_from_robot) {
  return scan_of(furnished_room(), map_from_robot, turn_beams(), turn_beam_count);
}

/// `agreeing` keypoints around the origin of the map, the same in all scans, and four that are in no other scan.
inline void put_keypoints(SlamScan& scan, const Pose2& map_from_sensor, std::size_t agreeing, std::uint64_t seed) {
  constexpr std::size_t bins = 48;
  constexpr std::size_t lone = 4;
  Rng shared(7);
  Rng own(seed, 1);
  scan.features = {};
  for (std::size_t i = 0; i < agreeing + lone; ++i) {
    Rng& rng = i < agreeing ? shared : own;
    const Point2 at = i < agreeing ? random_point(rng, 5) : random_point(rng, 5) + Point2{1000.0 * own.uniform(), 500};
    const Pose2 map_from_keypoint{at.x, at.y, rng.uniform(-3.0, 3.0)};
    scan.features.keypoints.push_back({.sensor_from_keypoint = inverse(map_from_sensor) * map_from_keypoint});
    const Descriptors one = random_descriptors(rng, 1, bins, 0.7);
    append_row(scan.features.descriptors, {one.row(0).begin(), one.row(0).end()});
  }
  scan.keypoints = table_of(scan.features.keypoints);
}

}  // namespace flirt::test
