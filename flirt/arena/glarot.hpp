// flirt/arena/glarot.hpp: GLAROT, a signature of a whole set of keypoints (after GLARE, Himstedt et al., IROS 2014, in
// the rotation-invariant form of Lodi Rizzini, Galasso and Caselli, RA-L 2019): which scans are worth matching at all.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace flirt {

struct GlarotParams {
  std::uint32_t directions{8};     ///< bins over half a turn
  std::uint32_t distances{80};     ///< bins
  double distance_step{0.1};       ///< m, pairs farther apart than all bins don't count
  std::uint32_t min_keypoints{5};  ///< fewer have no signature
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, GlarotParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.directions, Field{"directions", "", "bins over half a turn", 1, 64});
  visit(params.distances, Field{"distances", "", "bins", 1, 1000});
  visit(params.distance_step, Field{"distance_step", "m", "of a bin", 1e-3, 10.0});
  visit(params.min_keypoints, Field{"min_keypoints", "", "fewer have no signature", 0, 1e6});
}

/// Pairs of keypoints by direction (modulo half a turn) and distance, spread by a Gaussian of one bin; largest bin 1.
struct GlarotSignature {
  std::uint32_t directions{0};
  std::uint32_t distances{0};
  std::vector<float> bins{};  ///< directions × distances; empty: too few keypoints

  friend bool operator==(const GlarotSignature&, const GlarotSignature&) = default;
};

/// Turning and moving the keypoints, and listing them in another order, changes it by a turn of its rows only, as far
/// as the bins allow. Not invariant under reflection. O(keypoints²).
[[nodiscard]] GlarotSignature glarot_signature(std::span<const Point2> keypoints, const GlarotParams& params = {});

struct GlarotDistance {
  double value{0};  ///< L1 at the best turn; infinite when either signature is empty
  double turn{0};   ///< rad in [0, π), of the second set relative to the first, modulo half a turn
};

/// Over all turns by whole bins. O(directions² · distances).
[[nodiscard]] GlarotDistance glarot_distance(const GlarotSignature& a, const GlarotSignature& b);

}  // namespace flirt
