// flirt/arena/point_histograms.hpp: the descriptors BSC and CGH of the returns around a keypoint (Kallasi, Lodi Rizzini
// and Caselli, RA-L 2016), as rows that χ² compares.
#pragma once

#include "flirt/arena/polar_scan.hpp"
#include "flirt/core/fields.hpp"
#include "flirt/features/features.hpp"

#include <concepts>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace flirt {

/// Binary shape context: one bit per ring and sector, set where any return lies.
struct BscParams {
  ReturnLimits limits{};
  std::uint32_t sectors{16};
  std::uint32_t rings{8};
  double radius{0};  ///< m; 0: the keypoint's support radius
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, BscParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit_fields(params.limits, visit);
  visit(params.sectors, Field{"sectors", "", "of directions", 1, 1024});
  visit(params.rings, Field{"rings", "", "of distances", 1, 1024});
  visit(params.radius, Field{"radius", "m", "of the descriptor; 0: the keypoint's support radius", 0.0, 100.0});
}

/// Cumulative Gaussian histogram: returns by direction, each with a seventh of itself in both sectors beside.
struct CghParams {
  ReturnLimits limits{};
  std::uint32_t sectors{16};
  double radius{0};  ///< m; 0: the keypoint's support radius
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, CghParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit_fields(params.limits, visit);
  visit(params.sectors, Field{"sectors", "", "of directions", 1, 1024});
  visit(params.radius, Field{"radius", "m", "of the descriptor; 0: the keypoint's support radius", 0.0, 100.0});
}

/// What is around a keypoint: a disc, and the direction that sectors are counted from.
struct Surroundings {
  std::vector<Point2> offsets{};  ///< m, sensor axes, from the keypoint
  double radius{0};               ///< m
  double direction{0};            ///< rad
};

/// Bits by ring, then by sector; points outside of the radius, and on the keypoint itself, set none. O(points).
[[nodiscard]] std::vector<char> bsc_bits(const Surroundings& around, const BscParams& params);

/// Hamming distance, the least over turns by up to `max_shift` sectors, all rings together.
[[nodiscard]] std::uint32_t bsc_distance(std::span<const char> a, std::span<const char> b, std::uint32_t sectors,
                                         std::uint32_t max_shift = 0);

/// Sum 1, or all zero without any point.
[[nodiscard]] std::vector<double> cgh_bins(const Surroundings& around, const CghParams& params);

/// χ², and 1 when either is all zero: in [0, 1].
[[nodiscard]] double cgh_distance(std::span<const double> a, std::span<const double> b);

/// One row per keypoint, made around the return of its beam and turned by its direction. Distance::chi_square between
/// two rows is the share of bits that differ: an entry is 2 / bits or 0, so that the rows do not sum to 1 and must not
/// be searched by MatchStrategy::nearest, which relies on it (top-k with k = 1 does the same). O(keypoints · beams near
/// each).
[[nodiscard]] Descriptors describe_bsc(const Scan& scan, std::span<const Keypoint> keypoints,
                                       const BscParams& params = {});

/// The same for CGH; Distance::chi_square is its distance. A keypoint with nothing around it has all its mass in a
/// spare entry: at distance 1 from all others, but equal to another such.
[[nodiscard]] Descriptors describe_cgh(const Scan& scan, std::span<const Keypoint> keypoints,
                                       const CghParams& params = {});

}  // namespace flirt
