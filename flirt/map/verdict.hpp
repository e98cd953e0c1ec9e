// flirt/map/verdict.hpp: what an answer to "where am I" is worth, from the distinct poses that explain a scan.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/registration/search.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

enum class Verdict : std::uint8_t {
  unique,     ///< one place explains the scan, and clearly better than any other
  ambiguous,  ///< several places explain it about equally well: see the hypotheses
  lost,       ///< no place explains it
};
constexpr auto enum_names(Verdict /*tag*/) {
  return std::array{std::pair{Verdict::unique, std::string_view("unique")},
                    std::pair{Verdict::ambiguous, std::string_view("ambiguous")},
                    std::pair{Verdict::lost, std::string_view("lost")}};
}

/// Why the verdict is what it is.
enum class Reason : std::uint8_t {
  clear_winner,            ///< unique
  second_place_too_close,  ///< ambiguous: a second place explains the scan nearly as well
  little_evidence,         ///< ambiguous: nothing speaks against the first place, but there is too little to be sure
  little_support,          ///< ambiguous (papers): the first place is ahead, but too few map scans agree on it
  empty_map,               ///< lost: the map has no scans left
  few_points,              ///< lost: too few end points to tell places apart
  contradicted_by_free_space,  ///< lost: at the best place many beams end in, or cross, what the map knows otherwise
  outside_map,                 ///< lost: at the best place most end points lie where the map has seen nothing
  poor_fit,                    ///< lost: at the best place too few end points lie on anything the map knows
  no_keypoints,                ///< lost (features, papers): nothing stands out in the scan
  few_keypoints,               ///< lost (papers): fewer keypoints than a match needs inliers
  no_match,                    ///< lost (features, papers): nothing in the map looks like any keypoint of the scan
  few_inliers,                 ///< lost (papers): keypoints have look-alikes, but too few agree on a pose
};
constexpr auto enum_names(Reason /*tag*/) {
  using enum Reason;
  return std::array<std::pair<Reason, std::string_view>, 13>{
      {{clear_winner, "clear_winner"},
       {second_place_too_close, "second_place_too_close"},
       {little_evidence, "little_evidence"},
       {little_support, "little_support"},
       {empty_map, "empty_map"},
       {few_points, "few_points"},
       {contradicted_by_free_space, "contradicted_by_free_space"},
       {outside_map, "outside_map"},
       {poor_fit, "poor_fit"},
       {no_keypoints, "no_keypoints"},
       {few_keypoints, "few_keypoints"},
       {no_match, "no_match"},
       {few_inliers, "few_inliers"}}};
}

/// How much of the scan is explained, and by how much evidence: score · √(points / 80).
double evidence_strength(const EvidenceScore& score, std::size_t points);

/// Confidence = 1 / (1 + exp(−(offset + margin·√m + strength·s + unknown·u + through·t))), with m the score's margin to
/// the second place, at most `largest_margin`; s = score · √(points / 80); u and t the score's terms of those names.
/// Fitted by maximum likelihood on the logs aces and fr101 and on simulated buildings: 3931 scans whose neighbourhood
/// had left the map, and 1810 scans of other buildings (docs/localization.md).
struct VerdictParams {
  double offset{-6.65};         ///< log odds
  double margin{3.12};          ///< log odds per root of a unit of margin
  double strength{0.394};       ///< log odds per unit of score · √(points / 80)
  double unknown{-1.9};         ///< log odds per share of end points in unseen space
  double through{-18};          ///< log odds per share of beams through something solid
  double largest_margin{9};     ///< a larger margin counts as this
  double pair_odds{1.8};        ///< log odds of one place against another per unit of score between them
  double min_confidence{0.9};   ///< less is ambiguous; of the scans used in the fit, .993 of those above were right
  double min_margin{0.6};       ///< less is ambiguous: through the grid's cells, exact twins differ by as much
  double min_score{4};          ///< less is lost
  double joined_points{0.25};   ///< of a point; what one of an earlier scan counts when scans are joined
  std::uint32_t min_points{8};  ///< end points; fewer are lost
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, VerdictParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.offset, Field{"offset", "", "log odds of the first place, less what follows", -100, 100});
  visit(params.margin, Field{"margin", "", "log odds per root of a unit of margin to the second place", 0, 100});
  visit(params.strength, Field{"strength", "", "log odds per unit of score and evidence", 0, 100});
  visit(params.unknown, Field{"unknown", "", "log odds per share of end points in unseen space", -100, 0});
  visit(params.through, Field{"through", "", "log odds per share of beams through something solid", -100, 0});
  visit(params.largest_margin, Field{"largest_margin", "", "a larger margin counts as this", 0, 100});
  visit(params.pair_odds, Field{"pair_odds", "", "log odds of two places per unit of score between them", 0, 100});
  visit(params.min_confidence, Field{"min_confidence", "1", "less confidence is not unique", 0, 1});
  visit(params.min_margin, Field{"min_margin", "", "less margin to the second place is not unique", 0, 100});
  visit(params.min_score, Field{"min_score", "", "a best place with less is none", -100, 100});
  visit(params.joined_points,
        Field{"joined_points", "1", "of a point, what one of an earlier scan counts in a joined one", 0, 1});
  visit(params.min_points, Field{"min_points", "", "scans with fewer end points are lost", 1, 100000});
}

/// End points as evidence. Those of earlier scans, joined to the last one by odometry, see the same walls again, and
/// have no beams that could speak against a place: with full weight joined scans were called unique in twins of their
/// corridor.
[[nodiscard]] std::size_t points_of_evidence(const ScanPoints& points, const VerdictParams& params = {});

/// Probability that the first of the distinct poses (best first, at least one) is the right one, (0, 1).
[[nodiscard]] double confidence_of(std::span<const ScoredPose> distinct_poses, std::size_t points,
                                   const VerdictParams& params = {});

struct Judgement {
  Verdict verdict{Verdict::lost};
  Reason reason{Reason::few_points};
  double confidence{0};  ///< 0 when there is no pose
};

/// The verdict on distinct poses (best first) of a scan with `points` end points.
[[nodiscard]] Judgement judge_answer(std::span<const ScoredPose> distinct_poses, std::size_t points,
                                     const VerdictParams& params = {});

/// Why a place is none, lost: the term that costs most of the score of a perfect fit.
[[nodiscard]] Reason why_not(const EvidenceScore& score);

/// Relative probability of each pose, in their order, summing to 1: samples of p(x | z, m) for a particle filter.
[[nodiscard]] std::vector<double> weights_of(std::span<const ScoredPose> distinct_poses,
                                             const VerdictParams& params = {});

}  // namespace flirt
