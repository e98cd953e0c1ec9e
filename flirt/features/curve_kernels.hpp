// flirt/features/curve_kernels.hpp: the inner loops of curve smoothing, compiled for every vector width at hand and
// chosen at run time. Only for curve_smoothing.cpp.
#pragma once

#include <cstddef>
#include <cstdint>

namespace flirt::curve_kernels {

/// Arrays that the loops touch reach this many doubles beyond their last element.
inline constexpr std::size_t padding{8};

/// The pairs (i, j) of a curve: j = i + 1 .. end[i] − 1 in row i.
struct Rows {
  const double* arc;         ///< m, increasing
  const std::uint32_t* end;  ///< one per row
  std::size_t count;         ///< number of rows
};

/// Number of doubles that `gaussian_rows` may write to `kernel`.
[[nodiscard]] std::size_t kernel_size(const Rows& rows);

/// kernel = 2^(−rate (arc_i − arc_j)²) for all pairs, row after row; adds each to sum[i] and to sum[j].
void gaussian_rows(const Rows& rows, double rate, double* kernel, double* sum);

struct Columns {
  const double* weight;
  const double* weighted_x;
  const double* weighted_y;
};
struct Sums {
  double* weight;
  double* weighted_x;
  double* weighted_y;
};

/// For all pairs: sums[i] += kernel_ij · columns[j] and sums[j] += kernel_ij · columns[i], in each of three columns.
void weighted_rows(const Rows& rows, const double* kernel, const Columns& columns, const Sums& sums);

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
