// flirt/features/beta_grid.hpp: the β-grid, a polar grid of occupancy probabilities learnt from hits and passing beams
// (P1 §2.2, P2 §III-B).
#pragma once

#include "flirt/core/aligned_vector.hpp"
#include "flirt/features/beta_grid_kernel.hpp"
#include "flirt/features/describe_geometry.hpp"

#include <concepts>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace flirt {

/// The point estimate that becomes the descriptor's entry, before normalisation.
enum class OccupancyEstimate : std::uint8_t {
  posterior,  ///< mean of the Beta posterior, (hits + α0) / (hits + misses + α0 + β0) (P1 eq 9, P2 eq 16)
  raw_ratio,  ///< hits / (hits + misses), 0.5 where no beam came: as the authors' library computes it
};
[[nodiscard]] constexpr auto enum_names(OccupancyEstimate) {
  return std::array{std::pair{OccupancyEstimate::posterior, std::string_view("posterior")},
                    std::pair{OccupancyEstimate::raw_ratio, std::string_view("raw-ratio")}};
}

struct BetaGridParams {
  std::uint32_t angular_bins{12};             ///< (P2 §IV-C)
  std::uint32_t radial_bins{4};               ///< (P2 §IV-C)
  RadiusRule radius_rule{RadiusRule::fixed};  ///< see there
  double radius{0.5};                         ///< m; outer radius when it is fixed (P2 §IV-C)
  double radius_factor{1.0};                  ///< outer radius over support radius when it is in proportion
  double inner_radius{0.02};                  ///< m; nearer than this belongs to no bin, as the keypoint itself
  double angular_inflation{0.0};  ///< rad; bins reach this far over both of their sides, so that neighbours overlap
  double radial_inflation{0.0};   ///< m; the same for both arcs, but never below the inner radius
  NoReturnMeaning no_return{NoReturnMeaning::ignored};       ///< see there
  OccupancyEstimate estimate{OccupancyEstimate::posterior};  ///< see there
  double prior_hits{1.0};    ///< α0 of the Beta prior of the posterior; 1, 1 is uniform (P1 eq 8, P2 eq 15)
  double prior_misses{1.0};  ///< β0
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, BetaGridParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit_tessellation_fields(params, visit);
  visit(params.angular_inflation,
        Field{"angular_inflation", "rad", "how far bins reach over their sides", 0.0, std::numbers::pi / 8.0});
  visit(params.radial_inflation, Field{"radial_inflation", "m", "how far bins reach over their arcs", 0.0, 10.0});
  visit(params.no_return, Field{"no_return", "", "what beams without return say"});
  visit(params.estimate, Field{"estimate", "", "posterior mean or plain ratio of hits"});
  visit(params.prior_hits, Field{"prior_hits", "1", "hits before the first beam, of the posterior", 0.001, 1000.0});
  visit(params.prior_misses,
        Field{"prior_misses", "1", "misses before the first beam, of the posterior", 0.001, 1000.0});
}

/// What is known of one bin's probability to be occupied.
struct Occupancy {
  double mean{0};
  double variance{0};
};

/// Mean and variance of one bin (P1 eq 9 and 10, P2 eq 16 and 17); variance αβ / ((α + β)² (α + β + 1)), with the prior
/// for the posterior, without it for the raw ratio, where an unobserved bin has the variance of the uniform
/// distribution, 1/12.
[[nodiscard]] inline Occupancy occupancy(std::uint32_t hits, std::uint32_t misses, const BetaGridParams& params) {
  const bool with_prior = params.estimate == OccupancyEstimate::posterior;
  const double alpha = hits + (with_prior ? params.prior_hits : 0.0);
  const double beta = misses + (with_prior ? params.prior_misses : 0.0);
  const double sum = alpha + beta;
  if (sum == 0) { return {0.5, 1.0 / 12.0}; }
  return {alpha / sum, alpha * beta / (sum * sum * (sum + 1.0))};
}

/// Counts, per bin of one keypoint's tessellation, the beams that end in it (hits) and those that pass (misses). A beam
/// passes a bin if the part of its course that lies in the bin has a positive length and it does not end in the bin; a
/// beam that ends before the bin says nothing about it. A beam that runs along the line between two bins counts for
/// both. The course is intersected exactly; no sampling, and no trigonometry per beam.
class BetaGrid {
 public:
  explicit BetaGrid(const BetaGridParams& params);

  /// Replaces the counts. All zero when the keypoint is not finite or its radius is not above the inner one.
  /// O(beams near the keypoint · bins).
  void count(const BeamFan& fan, const Keypoint& keypoint);

  [[nodiscard]] const BetaGridParams& params() const { return params_; }
  [[nodiscard]] std::uint32_t dimension() const { return params_.angular_bins * params_.radial_bins; }
  [[nodiscard]] std::span<const std::uint32_t> hits() const { return hits_; }
  [[nodiscard]] std::span<const std::uint32_t> misses() const { return misses_; }

 private:
  void place(const Keypoint& keypoint);
  void follow(const FanBeam& beam);
  void count_radial(const beta_grid_kernel::Course& course);

  BetaGridParams params_;
  std::size_t stride_;         ///< angular bins, padded
  std::vector<Point2> lower_;  ///< clockwise side of each angular bin, inflated, relative to the keypoint
  std::vector<Point2> upper_;  ///< counter-clockwise side
  AlignedVector<double>
      placed_sides_;                 ///< the same in the sensor frame: x, y of the lower, x, y of the upper; 4 × stride
  std::vector<double> low_squared_;  ///< m², inner arc of each radial bin, inflated
  std::vector<double> high_squared_;  ///< m², outer arc
  Point2 keypoint_from_sensor_{};     ///< where the sensor is, seen from the keypoint, axes of the sensor frame
  std::vector<beta_grid_kernel::Course> courses_;
  AlignedVector<double> hit_counts_;   ///< radial bins × stride
  AlignedVector<double> miss_counts_;  ///< radial bins × stride
  std::vector<std::uint32_t> hits_;
  std::vector<std::uint32_t> misses_;
};

}  // namespace flirt
