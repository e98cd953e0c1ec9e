// flirt/map/localize.hpp: where a scan was taken, from the scan and a map alone: no prior pose, no odometry (P1 §4.1).
//
// The features of the scan are matched with those of every map scan; the matches with enough inliers are the solution
// set. Each is a sample of p(x | z, m), and the distinct places they agree on are its modes.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/core/scan_interval.hpp"
#include "flirt/features/describe.hpp"
#include "flirt/features/detect.hpp"
#include "flirt/features/features.hpp"
#include "flirt/map/hypotheses.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/match/match.hpp"
#include "flirt/match/pair_matcher.hpp"
#include "flirt/match/ransac.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {

struct LocalizeParams {
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
  requires std::same_as<std::remove_const_t<Params>, LocalizeParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.order, Field{"order", "", "which match stands for a place"});
  visit(params.distinct_distance,
        Field{"distinct_distance", "m", "poses farther apart are different places", 0.0, 1e3});
  visit(params.distinct_heading, Field{"distinct_heading", "rad", "poses turned more are different places", 0.0, 3.2});
  visit(params.half_support,
        Field{"half_support", "", "map scans that must agree for half of the confidence", 0.0, 1e6});
  visit(params.min_confidence, Field{"min_confidence", "1", "less confidence is ambiguous", 0.0, 1.0});
}

/// What the answer is worth. This version judges by the solution set alone, so it says "ambiguous" of many scans that
/// evidence from the whole scan, which is to come, can decide. Where all scans within 10 m of travel had left the map,
/// 300 of 300 "unique" answers were right on fr079 and mit-csail, but only half and a sixth of all were "unique".
enum class Verdict : std::uint8_t {
  unique,     ///< one place explains the scan clearly better than any other
  ambiguous,  ///< several places explain it about equally well: see LocalizationResult::places
  lost,       ///< no place
};
constexpr auto enum_names(Verdict /*tag*/) {
  return std::array{std::pair{Verdict::unique, std::string_view("unique")},
                    std::pair{Verdict::ambiguous, std::string_view("ambiguous")},
                    std::pair{Verdict::lost, std::string_view("lost")}};
}

/// Why the verdict is what it is.
enum class Reason : std::uint8_t {
  clear_winner,            ///< unique: no second place explains the scan nearly as well, and several map scans agree
  second_place_too_close,  ///< ambiguous: a second place explains the scan nearly as well
  little_support,          ///< ambiguous: the first place is ahead, but too few map scans agree on it
  empty_map,               ///< lost: the map has no scans left to match
  no_keypoints,            ///< lost: nothing stands out in the scan (no returns, or a bare wall)
  few_keypoints,           ///< lost: fewer keypoints than a match needs inliers
  no_match,                ///< lost: nothing in the map looks like any keypoint of the scan
  few_inliers,             ///< lost: single keypoints have look-alikes in the map, but too few agree on a pose
};
constexpr auto enum_names(Reason /*tag*/) {
  using enum Reason;
  return std::array<std::pair<Reason, std::string_view>, 8>{{{clear_winner, "clear_winner"},
                                                             {second_place_too_close, "second_place_too_close"},
                                                             {little_support, "little_support"},
                                                             {empty_map, "empty_map"},
                                                             {no_keypoints, "no_keypoints"},
                                                             {few_keypoints, "few_keypoints"},
                                                             {no_match, "no_match"},
                                                             {few_inliers, "few_inliers"}}};
}

struct LocalizationResult {
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

/// Where the time went.
struct LocalizeTimes {
  double detect_us{0};    ///< µs
  double describe_us{0};  ///< µs
  double match_us{0};     ///< µs, all map scans, and the grouping into places
};

/// Localizes many scans in one map; its workspaces stay allocated from one query to the next. Use one per thread, or
/// one with several threads.
class Localizer {
 public:
  /// `threads` share the map scans of a query; 0 for one per processor. Results do not depend on them.
  explicit Localizer(PlaceMap map, const LocalizeParams& params = {}, std::size_t threads = 1);

  /// Map scans in `excluded` do not take part, as if they weren't there: a map scan's match depends on nothing but the
  /// query, that scan and the seed. O(map scans · query keypoints · keypoints a map scan).
  [[nodiscard]] LocalizationResult localize(const Scan& scan, ScanInterval excluded = {},
                                            LocalizeTimes* times = nullptr);

  /// The same for features that were made with the map's `feature_params`.
  [[nodiscard]] LocalizationResult localize(const Features& features, ScanInterval excluded = {},
                                            LocalizeTimes* times = nullptr);

 private:
  PlaceMap map_;
  LocalizeParams params_;
  Detector detector_;
  Describer describer_;
  std::vector<PairMatcher> matchers_;  ///< one per thread
};

/// Where `scan` was taken. One thread; for many queries or several threads keep a Localizer.
[[nodiscard]] LocalizationResult localize(const PlaceMap& map, const Scan& scan, const LocalizeParams& params = {},
                                          LocalizeTimes* times = nullptr);

}  // namespace flirt
