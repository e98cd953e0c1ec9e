// flirt/arena/hough_matcher.hpp: AHT, the rigid motion that most pairs of points vote for.
#pragma once

#include "flirt/arena/point_matches.hpp"
#include "flirt/core/fields.hpp"

#include <concepts>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace flirt {

struct HoughParams {
  double cell{0.1};                   ///< m, of both coordinates of the motion
  double turn_step{0.04};             ///< rad
  double shift_max{5};                ///< m, motions reach less than this along either axis
  double turn_max{std::numbers::pi};  ///< rad, motions turn by this at most
  std::uint32_t min_votes{3};         ///< fewer are no match
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, HoughParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.cell, Field{"cell", "m", "of both coordinates of the motion", 0.02, 10.0});
  visit(params.turn_step, Field{"turn_step", "rad", "of the motion", 1e-3, 1.0});
  visit(params.shift_max, Field{"shift_max", "m", "motions reach less than this along either axis", 0.1, 50.0});
  visit(params.turn_max, Field{"turn_max", "rad", "motions turn by this at most", 0.0, std::numbers::pi});
  visit(params.min_votes, Field{"min_votes", "", "fewer are no match", 2.0, 1e6});
}

/// Motions that count as the same, and who votes for them.
struct HoughCell {
  std::int32_t turn{0};  ///< in steps
  std::int32_t x{0};     ///< in cells, from the lower edge
  std::int32_t y{0};
  std::uint32_t votes{0};          ///< the smaller of the numbers of query and of reference points
  std::vector<IndexPair> pairs{};  ///< one to one, by the distance that the middle of the cell leaves
  Pose2 reference_from_query{};    ///< their fit
};

/// The cell of most votes; of several the one whose fit leaves the least distance, then the lowest turn, x, y. Every
/// candidate votes once for each turn. Nothing below min_votes, or where no fit exists. O(candidates · turns).
[[nodiscard]] std::optional<HoughCell> most_voted_cell(const PointSets& points, std::span<const IndexPair> candidates,
                                                       const HoughParams& params = {});

/// The motion of that cell.
[[nodiscard]] std::optional<PointAlignment> align_by_votes(const PointSets& points,
                                                           std::span<const IndexPair> candidates,
                                                           const HoughParams& params = {});

}  // namespace flirt
