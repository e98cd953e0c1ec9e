// flirt/registration/window_search.hpp: all poses of a scan in a window of a local map, tried exhaustively.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/registration/local_map.hpp"
#include "flirt/registration/surface_points.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// Where to search.
struct SearchWindow {
  Pose2 map_from_robot{};                            ///< the middle
  double half_extent{0.5};                           ///< m, in x and in y
  double half_turn{radians_from_degrees(24)};        ///< rad, up to half a turn: all headings
  double heading_step{radians_from_degrees(2)};      ///< rad
  std::size_t most_points{100};                      ///< used of the scan, evenly picked
  std::size_t candidates{8};                         ///< kept at most
  double keep{0};                                    ///< share of the best value; poses worth less may be left out
  double distinct_distance{0.25};                    ///< m, of two poses nearer than this
  double distinct_heading{radians_from_degrees(5)};  ///< rad, and turned less than this only the better one is kept
};

/// A pose of the search grid with its mean value over the points.
struct WindowPose {
  Pose2 map_from_robot{};
  double value{0};  ///< 0..1: 1 when all points lie in cells with end points
};

/// Best poses first: of each 4 × 4 places at three neighbouring headings the best, and of those the distinct ones.
/// Sums of bytes, a row of 32 places at a time (Olson 2009); in large windows only where bounds at a quarter of the
/// resolution promise `keep` of the best. Integers, so the same on every processor. O(headings · places · points / 32).
[[nodiscard]] std::vector<WindowPose> search_window(const LocalMap& map, std::span<const SurfacePoints> scans,
                                                    const SearchWindow& window);

}  // namespace flirt
