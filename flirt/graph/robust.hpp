// flirt/graph/robust.hpp: losses that keep a few wrong edges from bending the map.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

namespace flirt {

enum class RobustLoss : std::uint8_t {
  none,           ///< least squares
  huber,          ///< linear beyond the width
  cauchy,         ///< logarithmic beyond the width
  geman_mcclure,  ///< bounded: an edge far beyond the width has no pull
};
constexpr auto enum_names(RobustLoss /*tag*/) {
  using enum RobustLoss;
  return std::array<std::pair<RobustLoss, std::string_view>, 4>{
      {{none, "none"}, {huber, "huber"}, {cauchy, "cauchy"}, {geman_mcclure, "geman-mcclure"}}};
}

/// A loss ρ of a squared error s, with its first two derivatives by s. ρ′ is the weight of the edge.
struct LossValue {
  double value{0};
  double first{1};
  double second{0};
};

/// ρ(s) of squared error s ≥ 0; `width` is the (unsquared) error at which the loss begins to bend. ρ(s) ≈ s near 0.
[[nodiscard]] inline LossValue robust_loss(RobustLoss loss, double width, double s) {
  const double w2 = width * width;
  switch (loss) {
    case RobustLoss::none:
      break;
    case RobustLoss::huber: {
      if (s <= w2) { break; }
      const double r = std::sqrt(s);
      return {2 * width * r - w2, width / r, -width / (2 * s * r)};
    }
    case RobustLoss::cauchy: {
      const double weight = w2 / (w2 + s);
      return {w2 * std::log1p(s / w2), weight, -weight * weight / w2};
    }
    case RobustLoss::geman_mcclure: {
      const double share = w2 / (w2 + s);
      return {s * share, share * share, -2 * share * share * share / w2};
    }
  }
  return {s, 1, 0};
}

}  // namespace flirt
