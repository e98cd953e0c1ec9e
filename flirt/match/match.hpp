// flirt/match/match.hpp: candidate correspondences between the features of two scans.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/features/features.hpp"
#include "flirt/match/alignment.hpp"
#include "flirt/match/distance.hpp"
#include "flirt/match/nearest.hpp"

#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {

/// Which pairs of features become candidates. All ask for a distance below MatchParams::max_distance.
enum class MatchStrategy : std::uint8_t {
  nearest,    ///< for each query feature its nearest in the reference, one way (the papers')
  mutual,     ///< the same, where the query feature is also the nearest one of that reference feature
  ratio,      ///< the same, where the nearest is closer than `ratio` times the second nearest
  threshold,  ///< every pair
  top_k,      ///< for each query feature its `k` nearest
};

constexpr auto enum_names(MatchStrategy /*tag*/) {
  using enum MatchStrategy;
  return std::array<std::pair<MatchStrategy, std::string_view>, 5>{
      {{nearest, "nearest"}, {mutual, "mutual"}, {ratio, "ratio"}, {threshold, "threshold"}, {top_k, "top-k"}}};
}

struct MatchParams {
  Distance distance{Distance::chi_square};         ///< between descriptors
  MatchStrategy strategy{MatchStrategy::nearest};  ///< which pairs become candidates
  double max_distance{0.4};                        ///< candidates are closer than this (P1 §3.1: 0.4 for chi-square)
  double ratio{0.8};                               ///< of the nearest to the second nearest distance; ratio only
  std::uint32_t k{3};                              ///< candidates per query feature; top-k only
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, MatchParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.distance, Field{"distance", "", "distance between descriptors"});
  visit(params.strategy, Field{"strategy", "", "which pairs of features become candidates"});
  visit(params.max_distance, Field{"max_distance", "1", "candidates have a descriptor distance below this", 0.0, 1e9});
  visit(params.ratio, Field{"ratio", "1", "strategy ratio: largest nearest / second nearest distance", 0.0, 1.0});
  visit(params.k, Field{"k", "", "strategy top-k: candidates per query feature", 1.0, 1e6});
}

/// Candidates of one query among many references; its workspaces stay allocated from one reference to the next.
class Matcher {
 public:
  explicit Matcher(const MatchParams& params = {}) : params_(params) {}

  /// The rows must outlive the calls of `candidates`.
  void set_query(const DescriptorRows& query);

  /// Ordered by query feature, then by distance, then by reference feature; valid until the next call.
  /// O(query · reference · stride).
  [[nodiscard]] std::span<const Match> candidates(const DescriptorRows& reference);

  /// What the last call of candidates returned.
  [[nodiscard]] std::span<const Match> last_candidates() const { return candidates_; }

 private:
  void add_nearest(const DescriptorRows& reference);
  void add_from_table(const DescriptorRows& reference);

  MatchParams params_;
  DescriptorRows query_{};
  NearestRows nearest_rows_{};
  std::vector<float> table_{};  ///< query × reference distances, for all but nearest chi-square neighbours
  std::vector<std::uint32_t> nearest_query_{};  ///< of each reference feature
  std::vector<Match> row_{};
  std::vector<Match> candidates_{};
};

/// Candidate correspondences of two scans, ordered by query feature, then by distance, then by reference feature.
/// Both descriptor tables must come from the same descriptor. Empty when either scan has no features.
[[nodiscard]] std::vector<Match> match(const Features& query, const Features& reference,
                                       const MatchParams& params = {});

}  // namespace flirt
