// flirt/arena/falko.hpp: FALKO keypoints (Kallasi, Lodi Rizzini and Caselli, RA-L 2016): corners whose two sides are
// straight.
#pragma once

#include "flirt/arena/polar_scan.hpp"
#include "flirt/core/fields.hpp"
#include "flirt/features/features.hpp"

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace flirt {

/// The defaults of its authors' library.
struct FalkoParams {
  ReturnLimits limits{};
  ReachParams reach{};
  double base_ratio{2.5};            ///< the triangle's base and height are more than the reach over this
  double min_score{50};              ///< %, of the worst raw score of the scan, that a candidate must be better by
  double suppression_radius{0.1};    ///< m
  std::uint32_t min_side_points{2};  ///< neighbours on either side
  std::uint32_t sectors{16};         ///< of directions, a full turn
  bool between_beams{true};          ///< move the point to where the lines through both sides meet
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, FalkoParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit_fields(params.limits, visit);
  visit_fields(params.reach, visit);
  visit(params.base_ratio, Field{"base_ratio", "1", "reach over the smallest base and height", 0.1, 1e3});
  visit(params.min_score, Field{"min_score", "%", "of the worst score that a candidate must be better by", 0.0, 100.0});
  visit(params.suppression_radius, Field{"suppression_radius", "m", "no two keypoints this close", 0.0, 10.0});
  visit(params.min_side_points, Field{"min_side_points", "", "neighbours on either side", 1, 1000});
  visit(params.sectors, Field{"sectors", "", "of directions", 2, 1024});
  visit(params.between_beams, Field{"between_beams", "", "move the point to where both sides meet"});
}

/// As its authors' benchmark sets it.
[[nodiscard]] FalkoParams tuned_falko();
/// For scanners with a beam a degree.
[[nodiscard]] FalkoParams sparse_falko();

/// A return with both sides around it, before the scores are compared.
struct FalkoCandidate {
  std::uint32_t element{0};  ///< of the polar scan
  double reach{0};           ///< m
  double direction{0};       ///< rad, (−π, π], into the corner's opening
  std::uint32_t raw{0};      ///< unevenness of the directions on both sides: 0 is a corner of two straight sides
  Neighbours sides{};
};

/// In order of angle. O(beams · neighbours²).
[[nodiscard]] std::vector<FalkoCandidate> falko_candidates(const PolarScan& scan, const FalkoParams& params);

/// Keypoints in order of angle. `scale` and `support_radius` are the reach, `response` the lead over the worst raw
/// score of the scan, `beam` the return that descriptors are made around. The threshold is relative: candidates that
/// are all equally uneven, or a lone one, give nothing, as published. O(beams · neighbours²).
[[nodiscard]] std::vector<Keypoint> detect_falko(const Scan& scan, const FalkoParams& params = {});

}  // namespace flirt
