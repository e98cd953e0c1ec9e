// flirt/features/curve_smoothing.hpp: the curve of a scan at several scales, independent of how densely it is sampled.
#pragma once

#include "flirt/core/aligned_vector.hpp"
#include "flirt/features/geodesic.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// A smoothed curve.
struct SmoothedCurve {
  std::vector<double> x;  ///< m
  std::vector<double> y;  ///< m
};

/// Geodesic distance outside of which a Gaussian of standard deviation 1 has `lost_mass`; infinite for 0.
[[nodiscard]] double gaussian_reach(double lost_mass);

/// Smooths a curve along its geodesic coordinate with a Gaussian of standard deviation t, normalised by the density of
/// the samples so that the result belongs to the curve and not to its sampling:
///
///   k_ij = exp(−d_ij² / 2t²)                      (P1 eq. 2, P2 eq. 8; d_ij the geodesic distance)
///   p_i  = Σ_j k_ij                               (P1 eq. 4, P2 eq. 10; the samples themselves carry p(u) du)
///   S̃_i  = Σ_j k_ij/p_j · α_j / Σ_j k_ij/p_j      (P1 eq. 3 and 5, P2 eq. 9 and 11, divided by the sum of the weights;
///                                                  p_i cancels)
///
/// computed as α_i plus the mean of the offsets α_j − α_i, which are short and can be floats.
/// Here d_ij = |arc_i − arc_j|, or the shorter way around a closed curve. The object keeps its buffers: no allocation
/// once it has seen a curve of the same size.
class CurveSmoother {
 public:
  /// The points of the curve, their arc lengths (m, increasing) and, when the curve is closed, its whole length (m).
  void set_curve(std::span<const double> x, std::span<const double> y, std::span<const double> arc, bool closed,
                 double length);

  /// The curve at scale t (m); pairs further apart than reach · t are left out. O(n · points within reach), each pair
  /// evaluated once, SIMD. Single precision for kernels and for offsets from point to point: the smoothed curve is
  /// within 2e-6 m of the one without rounding, on curves within some 30 m (a float's precision there).
  void smooth(double t, double reach, SmoothedCurve& out);

 private:
  void lay_out(double unit, double reach);
  void split_positions(double reach);
  void append_ghosts(AlignedVector<float>& values) const;
  void fold_ghosts(AlignedVector<float>& sums) const;

  std::size_t points_{0};
  std::size_t extended_{0};  ///< points, and ghosts: points met again after one turn
  bool closed_{false};
  double length_{0};                    ///< m, of a closed curve
  std::vector<double> exact_x_;         ///< m
  std::vector<double> exact_y_;         ///< m
  AlignedVector<float> x_;              ///< m, of points and ghosts
  AlignedVector<float> y_;              ///< m
  AlignedVector<double> arc_;           ///< m
  AlignedVector<double> position_;      ///< arc lengths in the unit of the scale, of points and ghosts
  AlignedVector<float> row_high_;       ///< `position_` in single precision, of points
  AlignedVector<float> row_low_;        ///< the rest of it
  AlignedVector<float> position_high_;  ///< the same of points and ghosts, each group twice
  AlignedVector<float> position_low_;   ///< the rest of it, each group twice
  AlignedVector<float> reach_of_;       ///< of each point that can be second of a pair, each group twice
  std::vector<std::uint32_t> ends_;     ///< of the rows of pairs
  AlignedVector<float> kernel_;         ///< k_ij of all pairs
  AlignedVector<float> density_;        ///< p_i = Σ k_ij
  AlignedVector<float> weight_;         ///< 1 / p_j
  AlignedVector<float> sum_;            ///< Σ k_ij / p_j
  AlignedVector<float> sum_x_;          ///< Σ k_ij (x_j − x_i) / p_j, m; then the offset of the smoothed point
  AlignedVector<float> sum_y_;          ///< the same in y, m
  AlignedVector<float> rows_;           ///< working memory of the sums, three columns
};

/// The same over any geodesic distances; pairs further apart than reach · t are left out. O(neighbours).
void smooth_over(const GeodesicNeighbours& neighbours, std::span<const double> x, std::span<const double> y, double t,
                 double reach, SmoothedCurve& out);

/// response_i = z e^−z with z = 2 |x_i − S̃_i| / t (P1 eq. 6, P2 eq. 12). O(n), SIMD.
void damped_displacement(std::span<const double> x, std::span<const double> y, const SmoothedCurve& smoothed, double t,
                         std::vector<double>& response);

}  // namespace flirt
