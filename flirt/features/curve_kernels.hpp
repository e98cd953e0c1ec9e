// flirt/features/curve_kernels.hpp: the inner loops of curve smoothing, compiled for every vector width at hand and
// chosen at run time. Only for curve_smoothing.cpp.
#pragma once

#include <cstddef>
#include <cstdint>

namespace flirt::curve_kernels {

/// Points are taken in groups of so many. All arrays but those of `damped_displacement` start on a cache line and reach
/// this many elements beyond their last.
inline constexpr std::size_t padding{8};

/// Rows of pairs are taken so many at a time.
inline constexpr std::size_t rows_at_once{4};

/// Where in an array that holds each group twice, for two rows at once, the first copy of point i is; the other follows
/// after `padding`.
constexpr std::size_t first_copy(std::size_t i) {
  return i + i / padding * padding;
}

/// Position of a row that stands for no point: so far before the others that none is within reach.
inline constexpr float beyond_everything = -1e30F;

/// The pairs (i, j), i < j, i < count, of points no further apart than `reach` along a curve.
struct Pairs {
  const double* arc;      ///< positions along the curve, increasing; `extended` of them, the padding infinite
  const float* row_high;  ///< `arc` in single precision, of the first points of pairs, then `beyond_everything`
  const float* row_low;   ///< the rest of it, then zeros
  const float* arc_high;  ///< the same of the second points, each group twice; the padding infinite
  const float* arc_low;   ///< the rest of it, each group twice; the padding finite
  const float* reach_of;  ///< a point is second of pairs no further apart than this, each group twice: `reach`, but for
                          ///< ties
  std::size_t count;      ///< points that have a row of pairs
  std::size_t extended;   ///< points that can be the second of a pair, ≥ count
  double reach;           ///< in the unit of `arc`, at most `farthest`, no less than any `reach_of`
  std::uint32_t* ends;    ///< written by `find_ends`: one per `rows_at_once`, beyond their last point
};
inline constexpr double farthest = 11.0;  ///< 2^(−11²) is nothing, and still a float

/// Fills pairs.ends. Returns the number of floats that the kernel of these pairs needs.
std::size_t find_ends(const Pairs& pairs);

/// kernel = 2^−(arc_i − arc_j)² for all pairs, in an order that only `weighted_sums` knows; adds each to sum[i] and to
/// sum[j]. In single precision: relative error of the kernel below 2e-6. `rows`: a zero for each point.
void gaussian_sums(const Pairs& pairs, float* kernel, float* sum, float* rows);

/// Three values per point.
struct Columns {
  float* weight;
  float* x;
  float* y;
};

/// weight_i = 1 / density_i, i < n.
void invert(const float* density, std::size_t n, float* weight);

/// For all pairs: what point j adds to the smoothed point i, as an offset from point i, and the other way around.
/// sums.weight[i] += kernel_ij · weight_j, sums.x[i] += kernel_ij · weight_j · (x_j − x_i), likewise y. `rows`: working
/// memory, zero beyond the points.
void weighted_sums(const Pairs& pairs, const float* kernel, const Columns& points, const Columns& sums,
                   const Columns& rows);

/// x_i and y_i divided by weight_i, in place, i < n.
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
