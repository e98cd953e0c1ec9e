// flirt/features/describe_geometry.hpp: what both descriptors share: the polar tessellation around a keypoint and the
// beams of a scan that come near it.
//
// The tessellation (P1 §2.2, P2 §III) is linear in angle and distance. Angular bin a covers the directions
// [−π + a · 2π/n, −π + (a + 1) · 2π/n) relative to the keypoint's own, counter-clockwise; radial bin j the distances
// [inner + j · w, inner + (j + 1) · w) with w = (outer − inner) / radial bins. Flat index = a · radial bins + j.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/features/features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// How far a descriptor reaches. The papers say both: proportional to the scale (P1 §2.2) and 0.5 m (P2 §IV-C).
enum class RadiusRule : std::uint8_t {
  fixed,    ///< `radius`, whatever the keypoint's scale
  support,  ///< `radius_factor` times the keypoint's support radius
};
[[nodiscard]] constexpr auto enum_names(RadiusRule) {
  return std::array{std::pair{RadiusRule::fixed, std::string_view("fixed")},
                    std::pair{RadiusRule::support, std::string_view("support")}};
}

/// What a beam without return tells a descriptor.
enum class NoReturnMeaning : std::uint8_t {
  ignored,     ///< nothing
  free_space,  ///< that its path is free as far as the sensor sees
};
[[nodiscard]] constexpr auto enum_names(NoReturnMeaning) {
  return std::array{std::pair{NoReturnMeaning::ignored, std::string_view("ignored")},
                    std::pair{NoReturnMeaning::free_space, std::string_view("free-space")}};
}

/// The fields of the tessellation, which both parameter structs have by the same names.
template <class Params, class Visitor>
void visit_tessellation_fields(Params& params, Visitor&& visit) {
  visit(params.angular_bins, Field{"angular_bins", "", "bins around the keypoint", 4, 360});
  visit(params.radial_bins, Field{"radial_bins", "", "bins from the inner to the outer radius", 1, 64});
  visit(params.radius_rule, Field{"radius_rule", "", "radius the same for all or in proportion to the support region"});
  visit(params.radius, Field{"radius", "m", "outer radius when it is fixed", 0.01, 100.0});
  visit(params.radius_factor,
        Field{"radius_factor", "1", "outer radius over support radius when it is in proportion", 0.01, 100.0});
  visit(params.inner_radius,
        Field{"inner_radius", "m", "nearer than this belongs to no bin, as the keypoint itself", 0.001, 10.0});
}

/// m; not above `inner_radius` (no bin has an area then) or not finite when the keypoint's support region is so.
template <class Params>
[[nodiscard]] double outer_radius(const Params& params, const Keypoint& keypoint) {
  return params.radius_rule == RadiusRule::fixed ? params.radius
                                                 : params.radius_factor * static_cast<double>(keypoint.support_radius);
}

/// True when there is something to count: a finite pose and bins with an area.
template <class Params>
[[nodiscard]] bool can_describe(const Params& params, const Keypoint& keypoint) {
  const double outer = outer_radius(params, keypoint);
  return is_finite(keypoint.sensor_from_keypoint) && std::isfinite(outer) && outer > params.inner_radius;
}

/// One beam in the sensor frame.
struct FanBeam {
  Point2 direction{};      ///< unit length
  double length{0};        ///< m, known course; 0: says nothing
  bool has_return{false};  ///< ended on something at `length`
};

/// The beams of one scan, prepared for many questions of the kind: which come within a radius of a point?
class BeamFan {
 public:
  /// O(beams), without trigonometry when the scan before had the same beams. Keeps its memory.
  void assign(const Scan& scan, NoReturnMeaning no_return);

  /// visit(beam) for each beam that may come within `radius` of `centre` (sensor frame, finite), each once, in
  /// order: those within asin(radius / distance) of its bearing, and at most a few neighbours more.
  template <class Visitor>
  void for_each_near(Point2 centre, double radius, const Visitor& visit) const {
    const Window window = window_around(centre, radius);
    std::size_t next = 0;
    for (double shift = 0; next < beams_.size() && window.low + shift < static_cast<double>(beams_.size());
         shift += window.turn) {
      const std::size_t end = index_clamped(window.high + shift);
      for (next = std::max(next, index_clamped(window.low + shift)); next < end; ++next) { visit(beams_[next]); }
    }
  }

 private:
  /// Beams [low, high) and the same a whole turn on, and so on.
  struct Window {
    double low{0};
    double high{0};
    double turn{0};  ///< beams to a full turn
  };
  [[nodiscard]] Window window_around(Point2 centre, double radius) const;
  [[nodiscard]] std::size_t index_clamped(double index) const {
    return static_cast<std::size_t>(std::clamp(index, 0.0, static_cast<double>(beams_.size())));
  }

  Beams layout_{};
  std::vector<FanBeam> beams_{};
};

}  // namespace flirt
