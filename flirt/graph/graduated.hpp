// flirt/graph/graduated.hpp: weights of graduated non-convexity. Internal to flirt/graph; use flirt/graph/optimize.hpp.
#pragma once

#include "flirt/graph/optimize.hpp"

#include <algorithm>
#include <cmath>

namespace flirt {

/// A loss between convex and bounded (Yang et al. 2020, §IV). `control` is μ, `limit` the squared error c̄² beyond which
/// an edge counts as wrong.
struct Graduation {
  Graduated kind{Graduated::truncated};
  double limit{1};
  double control{1};

  /// The start, from the largest squared error there is (remark 5).
  static Graduation from(Graduated kind, double limit, double worst) {
    const double control = kind == Graduated::geman_mcclure ? std::max(1.0, 2 * worst / limit)
                                                            : limit / std::max(2 * worst - limit, 1e-3 * limit);
    return {kind, limit, control};
  }
  /// Equations 12 and 14.
  [[nodiscard]] double weight(double error2) const {
    if (kind == Graduated::geman_mcclure) {
      const double share = control * limit / (error2 + control * limit);
      return share * share;
    }
    if (error2 <= control / (control + 1) * limit) { return 1; }
    if (error2 >= (control + 1) / control * limit) { return 0; }
    return std::sqrt(limit / error2 * control * (control + 1)) - control;
  }
  /// The loss is as bounded as it gets.
  [[nodiscard]] bool is_last() const { return kind == Graduated::geman_mcclure ? control <= 1 : control >= 1e4; }
  [[nodiscard]] Graduation next() const {
    constexpr double factor = 1.4;  // remark 5
    return {kind, limit, kind == Graduated::geman_mcclure ? std::max(1.0, control / factor) : control * factor};
  }
};

}  // namespace flirt
