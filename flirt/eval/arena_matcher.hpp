// flirt/eval/arena_matcher.hpp: one interface for the matchers of the arena, their answers counted alike.
#pragma once

#include "flirt/arena/clique_matcher.hpp"
#include "flirt/arena/hough_matcher.hpp"
#include "flirt/features/features.hpp"
#include "flirt/match/pair_matcher.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

enum class ArenaMatcher : std::uint8_t {
  ransac,  ///< ours, on candidates from descriptors
  clique,  ///< CCDA, on candidates from descriptors or on all pairs
  hough,   ///< AHT, the same
};
constexpr auto enum_names(ArenaMatcher /*tag*/) {
  return std::array{std::pair{ArenaMatcher::ransac, std::string_view("ransac")},
                    std::pair{ArenaMatcher::clique, std::string_view("clique")},
                    std::pair{ArenaMatcher::hough, std::string_view("hough")}};
}

struct ArenaMatcherParams {
  MatchParams match{};  ///< how descriptors make candidates
  RansacParams ransac{};
  CliqueParams clique{};
  HoughParams hough{};
};

/// The features of a scan in all the forms that matchers want.
struct ArenaScan {
  Features features{};  ///< without descriptor rows where the matcher looks at none
  KeypointTable table{};
  std::vector<Point2> points{};  ///< m, sensor frame

  [[nodiscard]] FeatureColumns columns() const { return {table.columns(), rows_of(features.descriptors)}; }
};
[[nodiscard]] ArenaScan arena_scan(Features features);

/// Where candidates come from.
enum class CandidateSource : std::uint8_t { descriptors, all_pairs };

/// One query against many references. One per thread.
class ContenderMatcher {
 public:
  ContenderMatcher(ArenaMatcher matcher, CandidateSource source, const ArenaMatcherParams& params)
      : matcher_(matcher), source_(source), params_(params), pairs_(params.match, params.ransac), rows_(params.match) {}

  /// `query` must outlive the calls of `align`.
  void set_query(const ArenaScan& query);

  /// Of every matcher the inliers and the residual are those of RANSAC's rule: query keypoints that come to lie near
  /// any reference keypoint. Nothing below ransac.min_inliers.
  [[nodiscard]] std::optional<PairAlignment> align(const ArenaScan& reference);

 private:
  [[nodiscard]] std::vector<IndexPair> candidates(const ArenaScan& reference);

  ArenaMatcher matcher_;
  CandidateSource source_;
  ArenaMatcherParams params_;
  PairMatcher pairs_;
  Matcher rows_;
  const ArenaScan* query_{nullptr};
};

}  // namespace flirt
