// flirt/arena/orthogonal_corners.hpp: OC keypoints (Kallasi, Lodi Rizzini and Caselli, RA-L 2016): corners of walls
// along a scan's two main directions.
#pragma once

#include "flirt/arena/polar_scan.hpp"
#include "flirt/core/fields.hpp"
#include "flirt/features/features.hpp"

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace flirt {

/// As its authors' benchmark sets it: with their library's reach of 0.1 m hardly any return has a neighbour across.
struct OrthogonalCornerParams {
  ReturnLimits limits{};
  ReachParams reach{.reach = 0.4};
  double wall_thickness{0.1};        ///< m, a neighbour on the same wall is at most this far across
  double angle_step{0.5};            ///< degrees, of the search for the main directions
  double distance_step{0.02};        ///< m, of the same
  double distance_max{10};           ///< m, farther walls have no say in it
  double suppression_radius{0.1};    ///< m
  double evenness{0.1};              ///< added to the difference of both walls' counts
  std::uint32_t min_side_points{2};  ///< neighbours on either side
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, OrthogonalCornerParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit_fields(params.limits, visit);
  visit_fields(params.reach, visit);
  visit(params.wall_thickness,
        Field{"wall_thickness", "m", "neighbours this far across are of the same wall", 0.0, 10.0});
  visit(params.angle_step, Field{"angle_step", "deg", "of the search for the main directions", 0.05, 45.0});
  visit(params.distance_step, Field{"distance_step", "m", "of the search for the main directions", 1e-3, 10.0});
  visit(params.distance_max, Field{"distance_max", "m", "farther walls have no say in it", 0.1, 1e3});
  visit(params.suppression_radius, Field{"suppression_radius", "m", "no two keypoints this close", 0.0, 10.0});
  visit(params.evenness, Field{"evenness", "1", "added to the difference of both walls' counts", 1e-6, 1e3});
  visit(params.min_side_points, Field{"min_side_points", "", "neighbours on either side", 1, 1000});
}

/// rad, [0, π/2): the direction along which, and across which, most returns line up. 0 without any return.
/// O(angles · (beams + distances)).
[[nodiscard]] double main_direction(const PolarScan& scan, const OrthogonalCornerParams& params);

/// Keypoints in order of angle, at the corner of both walls and directed into its opening. `scale` and
/// `support_radius` are the reach, `response` the score, `beam` the return that descriptors are made around.
[[nodiscard]] std::vector<Keypoint> detect_orthogonal_corners(const Scan& scan,
                                                              const OrthogonalCornerParams& params = {});

}  // namespace flirt
