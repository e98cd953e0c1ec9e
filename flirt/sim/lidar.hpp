// flirt/sim/lidar.hpp: what a laser scanner makes of the distances around it.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/rng.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/sim/ray_caster.hpp"

#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

enum class BeamOrder : std::uint8_t {
  counter_clockwise,
  clockwise,
};
constexpr auto enum_names(BeamOrder) {
  using enum BeamOrder;
  return std::array<std::pair<BeamOrder, std::string_view>, 2>{
      {{counter_clockwise, "counter-clockwise"}, {clockwise, "clockwise"}}};
}

/// A scanner. Beam i points to ∓field_of_view/2 ± i · field_of_view/beams: 360 beams over half a turn are those of a
/// SICK LMS at half a degree, −90° to +89.5°.
struct LidarParams {
  std::uint32_t beams{360};                            ///< readings in a scan
  double field_of_view{3.141592653589793};             ///< rad, beams times the angle between them
  BeamOrder beam_order{BeamOrder::counter_clockwise};  ///< in which the beams of a scan follow each other
  double range_min{0.05};                              ///< m, shorter readings are invalid
  double range_max{30.0};                              ///< m, no reading is longer
  double scan_rate{10.0};                              ///< Hz, scans are taken at multiples of its inverse
  double mount_x{0.1};                                 ///< m, of the scanner on the robot, forward
  double mount_y{0.0};                                 ///< m, to the left
  double mount_theta{0.0};                             ///< rad, counter-clockwise
  double noise{0.008};                                 ///< m, standard deviation of a reading at distance 0
  double noise_per_metre{0.001};                       ///< 1, its growth with distance
  double resolution{0.01};                             ///< m, readings are multiples of it; 0: not rounded
  double dropouts{0.002};                              ///< share of the readings lost, given as "no return"
  double mixed_pixels{0.3};                            ///< share of the edges at which a reading falls in between
  double glass_returns{0.1};                           ///< share of the beams that return from glass
  double glass_glare{0.09};                            ///< rad to a pane's normal, within which all beams return
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, LidarParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.beams, Field{"beams", "", "readings in a scan", 1, 20000});
  visit(params.field_of_view,
        Field{"field_of_view", "rad", "beams times the angle between them", 1e-6, 6.2831853071796});
  visit(params.beam_order, Field{"beam_order", "", "in which the beams of a scan follow each other"});
  visit(params.range_min, Field{"range_min", "m", "shorter readings are invalid", 0.001, 10});
  visit(params.range_max, Field{"range_max", "m", "no reading is longer", 0.1, 1000});
  visit(params.scan_rate, Field{"scan_rate", "Hz", "scans are taken at multiples of its inverse", 0.01, 1000});
  visit(params.mount_x, Field{"mount_x", "m", "of the scanner on the robot, forward", -10, 10});
  visit(params.mount_y, Field{"mount_y", "m", "of the scanner on the robot, to the left", -10, 10});
  visit(params.mount_theta, Field{"mount_theta", "rad", "of the scanner on the robot, counter-clockwise", -3.15, 3.15});
  visit(params.noise, Field{"noise", "m", "standard deviation of a reading at distance 0", 0, 1});
  visit(params.noise_per_metre, Field{"noise_per_metre", "1", "growth of the noise with distance", 0, 1});
  visit(params.resolution, Field{"resolution", "m", "readings are multiples of it; 0: not rounded", 0, 1});
  visit(params.dropouts, Field{"dropouts", "1", "share of the readings lost, given as no return", 0, 1});
  visit(params.mixed_pixels, Field{"mixed_pixels", "1", "share of edges at which a reading falls in between", 0, 1});
  visit(params.glass_returns, Field{"glass_returns", "1", "share of the beams that return from glass", 0, 1});
  visit(params.glass_glare, Field{"glass_glare", "rad", "to a pane's normal, within which all beams return", 0, 1.6});
}

/// A scanner ready to measure: the directions of its beams are worked out once.
class Lidar {
 public:
  explicit Lidar(const LidarParams& params);

  [[nodiscard]] const Beams& beams() const { return beams_; }
  [[nodiscard]] Pose2 robot_from_sensor() const { return {params_.mount_x, params_.mount_y, params_.mount_theta}; }

  /// One scan, m, `params.beams` readings; range_max stands for "no return". `moving` are discs besides the plan's, in
  /// the map frame. The scan is taken at one instant. O(beams + moving).
  [[nodiscard]] std::vector<double> measure(const RayCaster& caster, std::span<const PlanDisc> moving,
                                            const Pose2& map_from_sensor, Rng& rng) const;

 private:
  [[nodiscard]] double true_range(const RayCaster& caster, Point2 origin, Point2 direction, double limit,
                                  Rng& rng) const;
  void cover_by(const PlanDisc& disc, const Pose2& map_from_sensor, std::vector<double>& limits) const;
  void mix_at_edges(std::vector<double>& ranges, Rng& rng) const;
  [[nodiscard]] double reading(double range, double noise, Rng& rng) const;

  LidarParams params_;
  Beams beams_;
  std::vector<Point2> sensor_directions_;
};

}  // namespace flirt
