// flirt/sim/odometry.hpp: dead reckoning that drifts.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"

#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {

enum class OdometryMode : std::uint8_t {
  drifting,
  none,  ///< scans carry no odometry at all
};
constexpr auto enum_names(OdometryMode) {
  using enum OdometryMode;
  return std::array<std::pair<OdometryMode, std::string_view>, 2>{{{drifting, "drifting"}, {none, "none"}}};
}

/// Errors of wheel odometry. Deviations grow with the root of the way, so that they do not depend on how often it is
/// read. The defaults are those of a fair robot: some 2 % of the way and 10° in 100 m.
struct OdometryParams {
  OdometryMode mode{OdometryMode::drifting};
  double translation_noise{0.02};  ///< m per √m driven
  double rotation_noise{0.02};     ///< rad per √rad turned
  double heading_noise{0.01};      ///< rad per √m driven
  double translation_bias{0.01};   ///< 1, share by which ways are read too long
  double rotation_bias{0.01};      ///< 1, share by which turns are read too large
  double heading_bias{0.0005};     ///< rad per m driven, a steady pull to the left
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, OdometryParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.mode, Field{"mode", "", "what the scans carry"});
  visit(params.translation_noise, Field{"translation_noise", "m/sqrt(m)", "random error of the way driven", 0, 10});
  visit(params.rotation_noise, Field{"rotation_noise", "rad/sqrt(rad)", "random error of turns", 0, 10});
  visit(params.heading_noise,
        Field{"heading_noise", "rad/sqrt(m)", "random error of the heading per way driven", 0, 10});
  visit(params.translation_bias, Field{"translation_bias", "1", "share by which ways are read too long", -0.9, 10});
  visit(params.rotation_bias, Field{"rotation_bias", "1", "share by which turns are read too large", -0.9, 10});
  visit(params.heading_bias, Field{"heading_bias", "rad/m", "steady pull to the left", -1, 1});
}

/// What the wheels would say at each of the true poses: odom_from_robot, one per pose, starting at the first true pose.
/// Without noise and bias the truth itself (to rounding). `seed` picks the errors.
[[nodiscard]] std::vector<Pose2> drifting_odometry(std::span<const Pose2> map_from_robot, const OdometryParams& params,
                                                   std::uint64_t seed);

}  // namespace flirt
