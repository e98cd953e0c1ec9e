// flirt/map/solution_set.hpp: the papers' way of finding a scan in a map (P1 §4.1).
//
// The features of the scan are matched with those of every map scan; the matches with enough inliers are the solution
// set. Each is a sample of p(x | z, m), and the distinct places they agree on are its modes.
#pragma once

#include "flirt/core/aligned_vector.hpp"
#include "flirt/core/fields.hpp"
#include "flirt/core/scan_interval.hpp"
#include "flirt/features/features.hpp"
#include "flirt/map/hypotheses.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/map/verdict.hpp"
#include "flirt/match/match.hpp"
#include "flirt/match/pair_matcher.hpp"
#include "flirt/match/ransac.hpp"
#include "flirt/match/sketch.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace flirt {

struct SolutionSetParams {
  HypothesisOrder order{HypothesisOrder::residual};   ///< which match stands for a place, and comes first
  double distinct_distance{0.5};                      ///< m; poses farther apart are different places
  double distinct_heading{radians_from_degrees(10)};  ///< rad; poses turned farther apart are different places
  double half_support{4};       ///< map scans that must agree on a place for half of the confidence
  double min_confidence{0.15};  ///< 1; less is ambiguous
  MatchParams match{};
  RansacParams ransac{};  ///< min_inliers is the papers' n_I^min: what a match needs to join the solution set
};

/// The fields of `match` and `ransac` are visited on their own.
template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, SolutionSetParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.order, Field{"order", "", "which match stands for a place"});
  visit(params.distinct_distance,
        Field{"distinct_distance", "m", "poses farther apart are different places", 0.0, 1e3});
  visit(params.distinct_heading, Field{"distinct_heading", "rad", "poses turned more are different places", 0.0, 3.2});
  visit(params.half_support,
        Field{"half_support", "", "map scans that must agree for half of the confidence", 0.0, 1e6});
  visit(params.min_confidence, Field{"min_confidence", "1", "less confidence is ambiguous", 0.0, 1.0});
}

struct SolutionSet {
  Verdict verdict{Verdict::lost};
  Reason reason{Reason::no_match};
  /// Of the first place, in [0, 1): (1 − score of the second place / score of the first) · k / (k + half_support), k
  /// the map scans that agree on it; 0 when lost.
  double confidence{0};
  std::vector<Hypothesis> hypotheses{};  ///< the whole solution set, best match first
  std::vector<Place> places{};           ///< the distinct places among them, in the order of their best matches

  /// The best match, which stands for the first place; null when lost.
  [[nodiscard]] const Hypothesis* best() const {
    return places.empty() ? nullptr : &hypotheses[places.front().hypothesis];
  }
};

/// Matches many scans with one map; its workspaces stay allocated from one query to the next. Use one per thread, or
/// one with several threads.
class SolutionSetFinder {
 public:
  /// `threads` share the map scans of a query; 0 for one per processor. Results do not depend on them.
  explicit SolutionSetFinder(PlaceMap map, const SolutionSetParams& params = {}, std::size_t threads = 1);

  /// `features` made with the map's `feature_params`. Map scans in `excluded` do not take part, as if they weren't
  /// there: a map scan's match depends on nothing but the query, that scan and the seed.
  /// O(map scans · query keypoints · keypoints a map scan); the first call also makes a sketch of every map feature.
  [[nodiscard]] SolutionSet find(const Features& features, ScanInterval excluded = {});
  /// The same with `map_scans` alone, indices each once: an index's choice (word_index.hpp).
  [[nodiscard]] SolutionSet find_among(const Features& features, std::span<const std::uint32_t> map_scans);

 private:
  void sketch_map();
  [[nodiscard]] FeatureColumns map_features(std::size_t map_scan) const;

  PlaceMap map_;
  SolutionSetParams params_;
  SketchAxes sketch_axes_{};
  AlignedVector<std::int16_t> sketches_{};  ///< of all map features, once a query asked all map scans
  std::vector<PairMatcher> matchers_;       ///< one per thread
};

}  // namespace flirt
