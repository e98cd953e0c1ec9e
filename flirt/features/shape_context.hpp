// flirt/features/shape_context.hpp: linear local shape context, the polar histogram of the scan points around a
// keypoint (P2 §III-A).
#pragma once

#include "flirt/features/describe_geometry.hpp"

#include <concepts>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace flirt {

struct ShapeContextParams {
  std::uint32_t angular_bins{12};             ///< (P2 §IV-C)
  std::uint32_t radial_bins{4};               ///< (P2 §IV-C)
  RadiusRule radius_rule{RadiusRule::fixed};  ///< see there
  double radius{0.5};                         ///< m; outer radius when it is fixed (P2 §IV-C)
  double radius_factor{1.0};                  ///< outer radius over support radius when it is in proportion
  double inner_radius{0.02};                  ///< m; nearer than this belongs to no bin, as the keypoint itself
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, ShapeContextParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit_tessellation_fields(params, visit);
}

/// Counts the scan points in each bin of one keypoint's tessellation (P2 eq 13).
class ShapeContext {
 public:
  explicit ShapeContext(const ShapeContextParams& params);

  /// Replaces the counts. All zero when the keypoint is not finite or its radius is not above the inner one.
  /// O(beams near the keypoint).
  void count(const BeamFan& fan, const Keypoint& keypoint);

  [[nodiscard]] const ShapeContextParams& params() const { return params_; }
  [[nodiscard]] std::uint32_t dimension() const { return params_.angular_bins * params_.radial_bins; }
  [[nodiscard]] std::span<const std::uint32_t> points() const { return points_; }

 private:
  ShapeContextParams params_;
  std::vector<std::uint32_t> points_;
};

}  // namespace flirt
