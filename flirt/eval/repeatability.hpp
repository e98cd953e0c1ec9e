// flirt/eval/repeatability.hpp: are the interest points of a scan found again in a changed scan (P2 §IV-A.1)?
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/features/features.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// The support region of an interest point: a disc.
struct Region {
  Point2 centre{};   ///< m
  double radius{0};  ///< m
};

/// 1 − |A ∩ B| / |A ∪ B| (P2 eq. 18), the intersection of the discs being a lens in closed form. 0: the same disc; 1:
/// no common area. Two discs without any area: 0 when they coincide, else 1.
[[nodiscard]] double overlap_error(const Region& a, const Region& b);

/// (1/N') Σ_{p ∈ A} min_{q ∈ B} |p − q| (P2 eq. 19), m: directed, from the points `from` within `region` to the points
/// `to` within it. Infinite when either side has no point there. O(from + to + product of those within).
[[nodiscard]] double modified_hausdorff(const Region& region, std::span<const Point2> from, std::span<const Point2> to);

struct RepeatabilityParams {
  double overlap_error{0.6};  ///< regions with less correspond (P2 §IV-B)
  double presence{0.1};       ///< m, a shape less than this away is present in both scans (P2 §IV-B)
};

struct RegionPair {
  std::uint32_t reference{0};
  std::uint32_t other{0};

  friend bool operator==(const RegionPair&, const RegionPair&) = default;
};

/// All pairs of regions with an overlap error below the bound, in order of the reference, then of the other.
/// O(reference · other).
[[nodiscard]] std::vector<RegionPair> overlapping_pairs(std::span<const Region> reference,
                                                        std::span<const Region> other, double max_error);

/// Of those, the ones that remain when pairs are taken by rising error and no region serves twice; ties in order.
[[nodiscard]] std::vector<RegionPair> one_to_one_pairs(std::span<const Region> reference, std::span<const Region> other,
                                                       double max_error);

/// One pair of scans. The repeatability score is corresponding / present.
struct RepeatabilityCounts {
  std::uint32_t keypoints{0};      ///< of the reference
  std::uint32_t present{0};        ///< of them, those whose shape is in both scans
  std::uint32_t corresponding{0};  ///< of the present, those that were found again
  std::uint32_t scans{0};          ///< pairs of scans in this count

  RepeatabilityCounts& operator+=(const RepeatabilityCounts& other);
};

/// What is compared of one scan: regions and end points, all in the reference's frame.
struct RegionScan {
  std::vector<Region> regions{};
  std::vector<Point2> points{};  ///< m
};

/// Counts of one pair of scans. O(regions · points + regions²).
[[nodiscard]] RepeatabilityCounts repeatability(const RegionScan& reference, const RegionScan& other,
                                                const RepeatabilityParams& params = {});

/// Which region an interest point gets.
enum class RegionRule : std::uint8_t {
  native,  ///< its own support region
  common,  ///< a disc of the same radius for all detectors, so that large regions do not overlap more easily
};
constexpr auto enum_names(RegionRule /*tag*/) {
  return std::array{std::pair{RegionRule::native, std::string_view("native")},
                    std::pair{RegionRule::common, std::string_view("common")}};
}
inline constexpr std::array region_rules{RegionRule::native, RegionRule::common};

/// Regions of keypoints, moved by `reference_from_sensor`.
[[nodiscard]] std::vector<Region> regions_of(std::span<const Keypoint> keypoints, const Pose2& reference_from_sensor,
                                             RegionRule rule, double common_radius);

}  // namespace flirt
