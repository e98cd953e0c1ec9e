// flirt/arena/clique_matcher.hpp: CCDA (Bailey, PhD thesis, Sydney 2002): the largest set of pairs that all keep their
// distances to each other.
#pragma once

#include "flirt/arena/point_matches.hpp"
#include "flirt/core/fields.hpp"

#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

namespace flirt {

struct CliqueParams {
  double distance_tolerance{0.1};         ///< m, between the lengths of a segment in both scans; of a pair's residual
  double distance_min{0};                 ///< m, shorter segments say nothing
  std::uint32_t min_matches{2};           ///< fewer pairs are no match
  std::uint64_t max_branches{1'000'000};  ///< of the search for the largest set
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, CliqueParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.distance_tolerance,
        Field{"distance_tolerance", "m", "between a segment's lengths in both scans", 0.0, 10.0});
  visit(params.distance_min, Field{"distance_min", "m", "shorter segments say nothing", 0.0, 10.0});
  visit(params.min_matches, Field{"min_matches", "", "fewer pairs are no match", 2.0, 1e6});
  visit(params.max_branches, Field{"max_branches", "", "of the search for the largest set", 0.0, 1e12});
}

/// The motion of the largest set of `candidates` (distinct) that agree, fitted by least squares and once again without
/// the pairs that it leaves farther apart than the tolerance: a mirrored set ends there. Nothing when fewer than
/// min_matches remain. Deterministic; memory of candidates², time exponential at worst and bounded by max_branches.
[[nodiscard]] std::optional<PointAlignment> align_by_clique(const PointSets& points,
                                                            std::span<const IndexPair> candidates,
                                                            const CliqueParams& params = {});

}  // namespace flirt
