// flirt/registration/evidence_score.hpp: how well a whole scan, taken at a pose, agrees with all that a map knows.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/registration/map_fields.hpp"
#include "flirt/registration/scan_points.hpp"

#include <array>
#include <concepts>

namespace flirt {

/// Weights of the terms of a score.
struct EvidenceWeights {
  double likelihood{0};  ///< of the mean likelihood
  double free{0};        ///< of the share of end points in space known to be free
  double unknown{0};     ///< of the share of end points where the map saw nothing
  double through{0};     ///< of the share of beams that cross something solid
};

/// Whether a scan was taken at a place, and at which of several, are different questions. Where the map ends, a place
/// elsewhere that the map shows whole often explains more of the scan than the right one, and is given away by what
/// contradicts it alone.
struct EvidenceScoreParams {
  double sigma{0.1};           ///< m, of the likelihood of an end point's distance to the nearest occupied cell
  double through_margin{0.3};  ///< m before a beam's end where a solid cell no longer counts as crossed
  double moved_width{2.0};     ///< m, solid things that are narrower may have been moved: doors, cabinets; 0: nothing
  double moved_share{0.05};    ///< of the beams, what one such thing counts at most in `through_fixed`
  EvidenceWeights fit{14.7, -11.7, 1.0, -16.5};  ///< fitted on the logs aces and fr101 only
  /// Half of the way from `fit` to the conditional logit of the right place among all others (4.18, −12.75, −0.92,
  /// −19.35, in units of 1 / VerdictParams::pair_odds) of aces, fr101 and nine simulated buildings, scans whose
  /// surroundings the map shows in part among them. All of the way loses in crowds (docs/localization.md).
  EvidenceWeights preference{9.4, -12.2, 0.0, -17.9};
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, EvidenceScoreParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.sigma, Field{"sigma", "m", "width of the likelihood of an end point's distance", 0.01, 1.0});
  visit(params.fit.likelihood, Field{"likelihood", "", "weight of the mean likelihood of end points", -100, 100});
  visit(params.fit.free, Field{"free", "", "weight of the share of end points in free space", -100, 100});
  visit(params.fit.unknown, Field{"unknown", "", "weight of the share of end points in unseen space", -100, 100});
  visit(params.fit.through, Field{"through", "", "weight of the share of beams through something solid", -100, 100});
  visit(params.preference.likelihood, Field{"preferred_likelihood", "", "the same between two places", -100, 100});
  visit(params.preference.free, Field{"preferred_free", "", "the same between two places", -100, 100});
  visit(params.preference.unknown, Field{"preferred_unknown", "", "the same between two places", -100, 100});
  visit(params.preference.through, Field{"preferred_through", "", "the same between two places", -100, 100});
  visit(params.through_margin, Field{"through_margin", "m", "part of a beam before its end that may be solid", 0, 5});
  visit(params.moved_width, Field{"moved_width", "m", "solid things that are narrower may have been moved", 0, 100});
  visit(params.moved_share, Field{"moved_share", "1", "of the beams, what one moved thing counts at most", 0, 1});
}

/// The terms, each a mean over the end points, and their weighted sums.
struct EvidenceScore {
  double total{0};          ///< how well the scan fits here
  double preference{0};     ///< the larger of two is the likelier place
  double likelihood{0};     ///< 0..1
  double free{0};           ///< 0..1
  double unknown{0};        ///< 0..1
  double through{0};        ///< 0..1
  double through_fixed{0};  ///< 0..1, `through` where narrow things may have been moved; see if_things_moved
  double near{0};           ///< 0..1, share of end points within 0.1 m of something occupied; has no weight
  double residual{0};       ///< m², mean squared distance to something occupied, each at most (0.4 m)²; has no weight
};

/// Weighted sum of the terms of anything that has all four.
[[nodiscard]] inline double weighted(const auto& terms, const EvidenceWeights& weights) {
  return weights.likelihood * terms.likelihood + weights.free * terms.free + weights.unknown * terms.unknown +
         weights.through * terms.through;
}

/// The score if what is narrow may have been moved since the map was made, so that beams cross its place.
[[nodiscard]] EvidenceScore if_things_moved(EvidenceScore score, const EvidenceScoreParams& params);

/// Scores poses of scans in one map. Immutable after construction; tables for the parameters inside.
class EvidenceScorer {
 public:
  EvidenceScorer(const MapFields& fields, const EvidenceScoreParams& params);

  /// Score of the scan at a pose. O(points + cells that beams pass close to walls).
  [[nodiscard]] EvidenceScore score(const ScanPoints& points, const Pose2& map_from_sensor) const;

  /// The same of the end points alone: `through` is 0.
  [[nodiscard]] EvidenceScore score_of_end_points(const ScanPoints& points, const Pose2& map_from_sensor) const;

  /// Share of every `stride`-th beam that crosses something solid more than the margin before its end. Once it is sure
  /// to exceed `most`, 1 is returned. Points without a beam (ScanPoints::range 0) don't count.
  [[nodiscard]] double through(const ScanPoints& points, const Pose2& map_from_sensor, std::size_t stride = 1,
                               double most = 1) const;

 private:
  /// Calls `visit(crosses, x, y)` for each of these beams in turn until it returns false; (x, y) is where the beam
  /// meets something solid, cells from the map's origin.
  template <class Visit>
  void for_each_beam(const ScanPoints& points, const Pose2& map_from_sensor, std::size_t stride,
                     const Visit& visit) const;
  void add_crossings(EvidenceScore& score, const ScanPoints& points, const Pose2& map_from_sensor) const;

  const MapFields* fields_;
  EvidenceScoreParams params_;
  std::array<float, 256> likelihood_of_{};
};

}  // namespace flirt
