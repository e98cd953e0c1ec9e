// flirt/features/curve_kernels.hpp: the inner loops of curve smoothing, compiled for every vector width at hand and
// chosen at run time. Only for curve_smoothing.cpp.
#pragma once

#include <cstddef>
#include <cstdint>

namespace flirt::curve_kernels {

/// All arrays but those of `damped_displacement` start on a cache line and reach this many doubles beyond their last
/// element.
inline constexpr std::size_t padding{8};

/// The pairs (i, j), i < j, i < count, of points no further apart than `reach` along a curve.
struct Pairs {
  const double* arc;     ///< positions along the curve, increasing; `extended` of them, the padding infinite
  std::size_t count;     ///< points that have a row of pairs
  std::size_t extended;  ///< points that can be the second of a pair, ≥ count
  double reach;          ///< in the unit of `arc`
  std::uint32_t* ends;   ///< written by `find_ends`: one per two rows, beyond their last point
};

/// Fills pairs.ends. Returns the number of doubles that the kernel of these pairs needs.
std::size_t find_ends(const Pairs& pairs);

/// kernel = 2^−(arc_i − arc_j)² for all pairs, in an order that only `weighted_sums` knows; adds each to sum[i] and to
/// sum[j]. Relative error below 1e-10.
void gaussian_sums(const Pairs& pairs, double* kernel, double* sum);

/// Three values per point.
struct Columns {
  double* weight;
  double* weighted_x;
  double* weighted_y;
};

/// columns_i = (1, x_i, y_i) / density_i, i < n.
void prepare_columns(const double* x, const double* y, const double* density, std::size_t n, const Columns& columns);

/// For all pairs: sums[i] += kernel_ij · columns[j] and sums[j] += kernel_ij · columns[i], in each of the columns.
void weighted_sums(const Pairs& pairs, const double* kernel, const Columns& columns, const Columns& sums);

/// weighted_x_i and weighted_y_i divided by weight_i, in place, i < n.
void divide_columns(const Columns& sums, std::size_t n);

/// Coordinates of the points and of their smoothed counterparts.
struct Curves {
  const double* x;
  const double* y;
  const double* smoothed_x;
  const double* smoothed_y;
};

/// response_i = z e^−z with z = factor · |(x_i, y_i) − (smoothed_x_i, smoothed_y_i)|, i < n.
void damped_displacement(const Curves& curves, std::size_t n, double factor, double* response);

}  // namespace flirt::curve_kernels
