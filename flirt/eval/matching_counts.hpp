// flirt/eval/matching_counts.hpp: right and wrong matches of descriptors over a threshold of their distance, and the
// precision-recall curve that they make (P2 §IV-A.2).
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/eval/repeatability.hpp"
#include "flirt/match/distance.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// Which pairs of descriptors can match.
enum class PairRule : std::uint8_t {
  all,      ///< every pair (P2 §IV-A.2)
  nearest,  ///< for each interest point of the reference its nearest in the other scan (as for localization, P2 §IV-D)
};
constexpr auto enum_names(PairRule /*tag*/) {
  return std::array{std::pair{PairRule::all, std::string_view("all")},
                    std::pair{PairRule::nearest, std::string_view("nearest")}};
}

inline constexpr std::size_t threshold_count = 100;

/// Threshold k (0 .. threshold_count − 1) of a distance, rising by squares: dense where descriptors of the same place
/// lie. The last one is above every distance.
[[nodiscard]] double distance_threshold(Distance distance, std::size_t k);

/// Matches by the first threshold above their distance; sums of several pairs of scans are sums of these.
struct MatchingCounts {
  std::array<std::uint32_t, threshold_count> matches{};
  std::array<std::uint32_t, threshold_count> correct{};
  std::uint32_t correspondences{0};  ///< pairs that could have been matched rightly

  MatchingCounts& operator+=(const MatchingCounts& other);
};

/// Counts of one pair of scans. `distances` has a row of `others` per interest point of the reference; `overlapping`
/// are the pairs that are right, as overlapping_pairs gives them. With PairRule::nearest an interest point of the
/// reference that overlaps with any is one correspondence; with PairRule::all each overlapping pair is.
/// O(reference · other).
[[nodiscard]] MatchingCounts count_matches(std::span<const float> distances, std::size_t others,
                                           std::span<const RegionPair> overlapping, Distance distance, PairRule rule);

struct MatchingPoint {
  std::size_t threshold{0};  ///< its number
  double precision{0};       ///< correct / matches, below the threshold
  double recall{0};          ///< correct / correspondences
};
/// The points at which there is any match. O(thresholds).
[[nodiscard]] std::vector<MatchingPoint> matching_curve(const MatchingCounts& counts);

/// Σ (recall_k − recall_(k−1)) · precision_k: the area below the curve.
[[nodiscard]] double average_precision(const MatchingCounts& counts);

}  // namespace flirt
