// flirt/match/verify.hpp: do two whole scans agree with an alignment that was found from their keypoints alone?
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/scan.hpp"

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace flirt {

struct VerifyParams {
  double near_distance{0.1};     ///< m, query points this close to a reference point agree with it
  double line_distance{0.3};     ///< m, query points this close to a reference point have a point-to-line residual
  double free_margin{0.2};       ///< m, a beam that goes on this much farther has seen a place free
  std::uint32_t line_window{2};  ///< neighbouring beams on each side that make the line at a reference point
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, VerifyParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.near_distance,
        Field{"near_distance", "m", "query points this close to a reference point agree", 0.0, 10.0});
  visit(params.line_distance,
        Field{"line_distance", "m", "largest distance to a point with a line residual", 0.0, 10.0});
  visit(params.free_margin,
        Field{"free_margin", "m", "a beam going on this much farther has seen free space", 0.0, 10.0});
  visit(params.line_window, Field{"line_window", "", "beams on each side that make a line", 1.0, 100.0});
}

/// How a query scan fits a reference scan. Shares are 0 and residuals 0 where nothing could be compared: look at the
/// counts first.
struct Verification {
  std::uint32_t query_points{0};   ///< end points of the query
  std::uint32_t near_points{0};    ///< of them, those within near_distance of an end point of the reference
  std::uint32_t free_points{0};    ///< of them, those in space that the reference has seen free
  std::uint32_t line_points{0};    ///< of them, those with a point-to-line residual
  double near_share{0};            ///< near_points / query_points
  double free_share{0};            ///< free_points / query_points
  double median_line_residual{0};  ///< m, of the distances of query points to the line at their nearest reference point
  double mean_line_residual{0};    ///< m
};

/// The full-scan check of an alignment (the reprojection error of P1 §3.2). A query point lies in free space when both
/// reference beams beside it ended on something more than free_margin farther away. The other direction is had by
/// exchanging the scans and inverting the pose. O(beams · window), the window being the beams within line_distance.
[[nodiscard]] Verification verify(const Scan& query, const Scan& reference, const Pose2& reference_from_query,
                                  const VerifyParams& params = {});

}  // namespace flirt
