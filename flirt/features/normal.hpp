// flirt/features/normal.hpp: the direction of the surface under each beam.
#pragma once

#include <span>
#include <vector>

namespace flirt {

/// Direction of the surface normal at each point, rad in (−π, π], sensor frame: the total least squares line through a
/// window of `window` points centred on it, α = ½ atan2(−2 S_xy, S_yy − S_xx) of the Hesse form x cos α + y sin α = ρ
/// with ρ ≥ 0, so that normals point away from the sensor (P2 §II-B). The outermost points of an open curve take the
/// normal of the nearest full window; a `closed` curve goes around. `window` counts as the odd number below when even.
/// O(n · window).
void estimate_normals(std::span<const double> x, std::span<const double> y, int window, bool closed,
                      std::vector<double>& normals);

/// Adds multiples of 2π so that no two neighbours differ by more than π. Returns the multiple of 2π by which the angle
/// has grown after one turn, from the first sample around to itself.
double unwrap(std::span<double> angles);

}  // namespace flirt
