// flirt/map/localize.hpp: where a scan was taken, from the scan and a map alone: no prior pose, no odometry.
//
//   const LocalizationResult found = localize(map, scan);
//   if (found.verdict == Verdict::unique) { drive_from(found.hypotheses.front().map_from_sensor); }
//
// Candidates come from a dense search over the whole map or from votes of oriented keypoints; each is drawn onto the
// map's walls and scored by all beams of the scan against the evidence of all map scans; the margin to the second
// distinct place decides the verdict.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/core/scan_interval.hpp"
#include "flirt/features/describe.hpp"
#include "flirt/features/detect.hpp"
#include "flirt/map/evidence_without.hpp"
#include "flirt/map/landmarks.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/map/solution_set.hpp"
#include "flirt/map/verdict.hpp"
#include "flirt/registration/search.hpp"

#include <Eigen/Core>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {

/// Where candidate poses come from.
enum class LocalizeMethod : std::uint8_t {
  automatic,  ///< dense, or where the map is too large for it features
  dense,      ///< every heading at every place where a robot can have been
  features,   ///< places and headings that keypoints vote for
  papers,     ///< matches with single map scans, judged by their keypoints alone (P1 §4.1): for comparison
};
constexpr auto enum_names(LocalizeMethod /*tag*/) {
  return std::array{std::pair{LocalizeMethod::automatic, std::string_view("auto")},
                    std::pair{LocalizeMethod::dense, std::string_view("dense")},
                    std::pair{LocalizeMethod::features, std::string_view("features")},
                    std::pair{LocalizeMethod::papers, std::string_view("papers")}};
}

struct LocalizeParams {
  LocalizeMethod method{LocalizeMethod::automatic};
  MapFieldParams fields{};
  SearchParams search{};
  LandmarkParams landmarks{};  ///< of the method `features`
  /// m² that a dense search may run over; a larger map is searched where features vote, with `automatic`.
  double largest_dense{1e6};
  /// Share of the end points that may lie on legs for a scan to be read a second time, legs and all, when the first
  /// answer is not unique: where so few stand about they are more likely furniture than people. 0: never.
  double few_legs{0.1};
  VerdictParams verdict{};
  SolutionSetParams papers{};  ///< of the method `papers`
};

/// What is no parameter of a part.
template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, LocalizeParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.largest_dense,
        Field{"largest_dense", "m2", "that a dense search may run over before auto asks the features", 0.0, 1e12});
  visit(params.few_legs, Field{"few_legs", "1",
                               "share of a scan on legs up to which it is read again with them when it is not unique "
                               "without; 0: never",
                               0.0, 1.0});
}

/// A distinct place that explains the scan.
struct PoseHypothesis {
  Pose2 map_from_sensor{};
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};  ///< of (x, y, theta), map frame: m², m·rad, rad²
  double score{0};           ///< by the evidence (EvidenceScore::total); `papers`: score_from_residual
  double weight{0};          ///< relative probability; all hypotheses sum to 1
  EvidenceScore evidence{};  ///< terms of the score; zero for `papers`
};

struct LocalizationResult {
  Verdict verdict{Verdict::lost};
  Reason reason{Reason::few_points};
  double confidence{0};                       ///< probability that the first hypothesis is right; 0 without any
  std::vector<PoseHypothesis> hypotheses{};   ///< distinct places, best first
  std::uint32_t points{0};                    ///< end points that were used, after thinning
  std::optional<SolutionSet> solution_set{};  ///< of the method `papers`

  /// The best hypothesis; null when there is none.
  [[nodiscard]] const PoseHypothesis* best() const { return hypotheses.empty() ? nullptr : &hypotheses.front(); }
};

/// Where the time went, µs.
struct LocalizeTimes {
  double detect_us{0};    ///< features and papers only, as the next
  double describe_us{0};  ///< features and papers
  double match_us{0};     ///< papers: keypoints against all map scans; features: votes
  double search_us{0};    ///< coarse candidates
  double rank_us{0};      ///< heats: which candidates are refined to the end
  double refine_us{0};    ///< refinement, score, verdict
  double prepare_us{0};   ///< evidence without the excluded scans: a cost of evaluation, not in the total

  [[nodiscard]] double total_us() const { return detect_us + describe_us + match_us + search_us + rank_us + refine_us; }
};

/// Localizes many scans in one map; its workspaces stay allocated from one query to the next. One per thread.
class Localizer {
 public:
  /// `threads` share the map scans of a query of the method `papers`; 0 for one per processor.
  explicit Localizer(const PlaceMap& map, const LocalizeParams& params = {}, std::size_t threads = 1);

  /// Map scans in `excluded` do not take part, as if they weren't there.
  [[nodiscard]] LocalizationResult localize(const Scan& scan, ScanInterval excluded = {},
                                            LocalizeTimes* times = nullptr);
  /// The same with `points` as the end points of the scan, for example of the last few scans together (join_scans).
  /// Not for the method `papers`.
  [[nodiscard]] LocalizationResult localize_points(const Scan& scan, const ScanPoints& points,
                                                   ScanInterval excluded = {}, LocalizeTimes* times = nullptr);
  /// The map's evidence without the scans in `excluded`, which queries are scored by; valid until the next call.
  [[nodiscard]] const MapFields& fields(ScanInterval excluded = {}) { return evidence_.fields(excluded); }

 private:
  [[nodiscard]] bool votes_needed(const MapFields& fields) const;
  [[nodiscard]] std::vector<Pose2> voted_places(const Scan& scan, ScanInterval excluded, LocalizeTimes& times);
  [[nodiscard]] LocalizationResult by_evidence(const Scan& scan, std::span<const ScanPoints> readings,
                                               ScanInterval excluded, LocalizeTimes& times);
  [[nodiscard]] Features features_of(const Scan& scan, LocalizeTimes& times);
  [[nodiscard]] LocalizationResult by_papers(const Scan& scan, ScanInterval excluded, LocalizeTimes& times);

  PlaceMap map_;
  LocalizeParams params_;
  Detector detector_;
  Describer describer_;
  EvidenceWithout evidence_;
  SolutionSetFinder finder_;
  std::optional<Landmarks> landmarks_{};  ///< without the scans of `excluded_`, once votes were needed
  ScanInterval excluded_{};
};

/// Where `scan` was taken. For many queries keep a Localizer: making one costs as much as several queries.
[[nodiscard]] LocalizationResult localize(const PlaceMap& map, const Scan& scan, const LocalizeParams& params = {},
                                          LocalizeTimes* times = nullptr);

}  // namespace flirt
