#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/features/curve_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for every target.
#include "flirt/features/curve_kernels.hpp"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flirt::curve_kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, padding>;
using Vector = hn::Vec<Tag>;

constexpr double round_to_integer = 0x1.8p52;  // adding it leaves an integer in the low bits
constexpr double smallest_exponent = -1000.0;

/// 2^(n + f) with a relative error below 1e-10: a polynomial for 2^f, |f| ≤ ½, and n added to its exponent. `shifted`
/// is n + round_to_integer. Wrong for n < smallest_exponent.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V exp2_of_rounded(D d, V f, V shifted) {
  const V f2 = hn::Mul(f, f);
  const V f4 = hn::Mul(f2, f2);
  // Interpolation of 2^f at the eight Chebyshev nodes of [−½, ½].
  const V a = hn::MulAdd(f, hn::Set(d, 0.6931471805568324), hn::Set(d, 0.9999999999595618));
  const V b = hn::MulAdd(f, hn::Set(d, 0.055504109063258665), hn::Set(d, 0.24022651213498092));
  const V c = hn::MulAdd(f, hn::Set(d, 0.0013333478473685416), hn::Set(d, 0.009618025613318034));
  const V e = hn::MulAdd(f, hn::Set(d, 1.5303700711365693e-05), hn::Set(d, 0.00015469729214118296));
  const V power = hn::MulAdd(f4, hn::MulAdd(f2, e, c), hn::MulAdd(f2, b, a));
  const hn::RebindToUnsigned<D> bits;
  return hn::BitCast(d, hn::Add(hn::BitCast(bits, power), hn::ShiftLeft<52>(hn::BitCast(bits, shifted))));
}

/// 2^y for y ≤ 0; 2^−1000 for anything smaller.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V exp2_of_negative(D d, V y) {
  y = hn::Max(y, hn::Set(d, smallest_exponent));
  const V shifted = hn::Add(y, hn::Set(d, round_to_integer));
  return exp2_of_rounded(d, hn::Sub(y, hn::Sub(shifted, hn::Set(d, round_to_integer))), shifted);
}

/// 2^(−x²), or 0 where x is above `reach`, which is at most `farthest`.
HWY_INLINE Vector gaussian(Tag d, Vector x, Vector reach) {
  const Vector round = hn::Set(d, round_to_integer);
  const Vector shifted = hn::NegMulAdd(x, x, round);
  const Vector f = hn::NegMulSub(x, x, hn::Sub(shifted, round));
  return hn::IfThenElseZero(hn::Le(x, reach), exp2_of_rounded(d, f, shifted));
}
constexpr double farthest = 31.0;  // 2^(−31²) is nothing

HWY_INLINE double sum_of_lanes(Tag d, Vector v) {
  return hn::GetLane(hn::SumOfLanes(d, v));
}

// Rows of pairs are taken two at a time, i and i + 1, so that what belongs to a vector of points is loaded and stored
// once for both. They start with the vector of point i + 1, in which lanes up to a row's own point are cleared. The row
// after an odd last one is empty: its point is put beyond everything.

constexpr double beyond_everything = -1e300;  // so far before the others that none is within reach

HWY_INLINE std::size_t begin_of(std::size_t i, std::size_t lanes) {
  return (i + 1) / lanes * lanes;
}

std::size_t find_ends(const Pairs& pairs) {
  const std::size_t lanes = hn::Lanes(Tag());
  std::size_t size = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < pairs.count; i += 2) {
    const std::size_t begin = begin_of(i, lanes);
    const double limit = pairs.arc[i + 1 < pairs.count ? i + 1 : i] + pairs.reach;
    end = end > begin + lanes ? end : begin + lanes;
    while (end < pairs.extended && pairs.arc[end] <= limit) { end += lanes; }
    pairs.ends[i / 2] = static_cast<std::uint32_t>(end);
    size += 2 * (end - begin);
  }
  return size;
}

void gaussian_sums(const Pairs& pairs, double* HWY_RESTRICT kernel, double* HWY_RESTRICT sum) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vector reach = hn::Set(d, pairs.reach < farthest ? pairs.reach : farthest);
  for (std::size_t i = 0; i < pairs.count; i += 2) {
    const Vector arc_0 = hn::Set(d, pairs.arc[i]);
    const Vector arc_1 = hn::Set(d, i + 1 < pairs.count ? pairs.arc[i + 1] : beyond_everything);
    std::size_t j = begin_of(i, lanes);
    const Vector first = hn::Load(d, pairs.arc + j);
    Vector k_0 = hn::IfThenZeroElse(hn::FirstN(d, i + 1 - j), gaussian(d, hn::Sub(first, arc_0), reach));
    Vector k_1 = hn::IfThenZeroElse(hn::FirstN(d, i + 2 - j), gaussian(d, hn::Sub(first, arc_1), reach));
    Vector row_sum_0 = k_0;
    Vector row_sum_1 = k_1;
    while (true) {
      hn::Store(k_0, d, kernel);
      hn::Store(k_1, d, kernel + lanes);
      hn::Store(hn::Add(hn::Load(d, sum + j), hn::Add(k_0, k_1)), d, sum + j);
      kernel += 2 * lanes;
      j += lanes;
      if (j >= pairs.ends[i / 2]) { break; }
      const Vector arc_j = hn::Load(d, pairs.arc + j);
      k_0 = gaussian(d, hn::Sub(arc_j, arc_0), reach);
      k_1 = gaussian(d, hn::Sub(arc_j, arc_1), reach);
      row_sum_0 = hn::Add(row_sum_0, k_0);
      row_sum_1 = hn::Add(row_sum_1, k_1);
    }
    sum[i] += sum_of_lanes(d, row_sum_0);
    sum[i + 1] += sum_of_lanes(d, row_sum_1);
  }
}

void prepare_columns(const double* HWY_RESTRICT x, const double* HWY_RESTRICT y, const double* HWY_RESTRICT density,
                     std::size_t n, const Columns& columns) {
  const Tag d;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const Vector weight = hn::Div(hn::Set(d, 1.0), hn::Load(d, density + i));
    hn::Store(weight, d, columns.weight + i);
    hn::Store(hn::Mul(weight, hn::Load(d, x + i)), d, columns.weighted_x + i);
    hn::Store(hn::Mul(weight, hn::Load(d, y + i)), d, columns.weighted_y + i);
  }
}

void weighted_sums(const Pairs& pairs, const double* HWY_RESTRICT kernel, const Columns& columns, const Columns& sums) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < pairs.count; i += 2) {
    const Vector weight_0 = hn::Set(d, columns.weight[i]);
    const Vector weight_1 = hn::Set(d, columns.weight[i + 1]);
    const Vector x_0 = hn::Set(d, columns.weighted_x[i]);
    const Vector x_1 = hn::Set(d, columns.weighted_x[i + 1]);
    const Vector y_0 = hn::Set(d, columns.weighted_y[i]);
    const Vector y_1 = hn::Set(d, columns.weighted_y[i + 1]);
    Vector row_weight_0 = hn::Zero(d);
    Vector row_weight_1 = hn::Zero(d);
    Vector row_x_0 = hn::Zero(d);
    Vector row_x_1 = hn::Zero(d);
    Vector row_y_0 = hn::Zero(d);
    Vector row_y_1 = hn::Zero(d);
    for (std::size_t j = begin_of(i, lanes); j < pairs.ends[i / 2]; j += lanes, kernel += 2 * lanes) {
      const Vector k_0 = hn::Load(d, kernel);
      const Vector k_1 = hn::Load(d, kernel + lanes);
      const Vector weight_j = hn::Load(d, columns.weight + j);
      row_weight_0 = hn::MulAdd(k_0, weight_j, row_weight_0);
      row_weight_1 = hn::MulAdd(k_1, weight_j, row_weight_1);
      const Vector weight_sum = hn::MulAdd(k_0, weight_0, hn::Load(d, sums.weight + j));
      hn::Store(hn::MulAdd(k_1, weight_1, weight_sum), d, sums.weight + j);
      const Vector x_j = hn::Load(d, columns.weighted_x + j);
      row_x_0 = hn::MulAdd(k_0, x_j, row_x_0);
      row_x_1 = hn::MulAdd(k_1, x_j, row_x_1);
      const Vector x_sum = hn::MulAdd(k_0, x_0, hn::Load(d, sums.weighted_x + j));
      hn::Store(hn::MulAdd(k_1, x_1, x_sum), d, sums.weighted_x + j);
      const Vector y_j = hn::Load(d, columns.weighted_y + j);
      row_y_0 = hn::MulAdd(k_0, y_j, row_y_0);
      row_y_1 = hn::MulAdd(k_1, y_j, row_y_1);
      const Vector y_sum = hn::MulAdd(k_0, y_0, hn::Load(d, sums.weighted_y + j));
      hn::Store(hn::MulAdd(k_1, y_1, y_sum), d, sums.weighted_y + j);
    }
    sums.weight[i] += sum_of_lanes(d, row_weight_0);
    sums.weight[i + 1] += sum_of_lanes(d, row_weight_1);
    sums.weighted_x[i] += sum_of_lanes(d, row_x_0);
    sums.weighted_x[i + 1] += sum_of_lanes(d, row_x_1);
    sums.weighted_y[i] += sum_of_lanes(d, row_y_0);
    sums.weighted_y[i + 1] += sum_of_lanes(d, row_y_1);
  }
}

void divide_columns(const Columns& sums, std::size_t n) {
  const Tag d;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const Vector weight = hn::Load(d, sums.weight + i);
    hn::Store(hn::Div(hn::Load(d, sums.weighted_x + i), weight), d, sums.weighted_x + i);
    hn::Store(hn::Div(hn::Load(d, sums.weighted_y + i), weight), d, sums.weighted_y + i);
  }
}

/// Displacement of the points [i, end) as far as whole vectors of `d` fit; returns the first that is left.
template <class D>
HWY_INLINE std::size_t damp(D d, const Curves& curves, std::size_t i, std::size_t end, double factor,
                            double* HWY_RESTRICT response) {
  const auto minus_log2_e = hn::Set(d, -1.4426950408889634);
  for (; i + hn::Lanes(d) <= end; i += hn::Lanes(d)) {
    const auto dx = hn::Sub(hn::LoadU(d, curves.x + i), hn::LoadU(d, curves.smoothed_x + i));
    const auto dy = hn::Sub(hn::LoadU(d, curves.y + i), hn::LoadU(d, curves.smoothed_y + i));
    const auto z = hn::Mul(hn::Set(d, factor), hn::Sqrt(hn::MulAdd(dx, dx, hn::Mul(dy, dy))));
    hn::StoreU(hn::Mul(z, exp2_of_negative(d, hn::Mul(z, minus_log2_e))), d, response + i);
  }
  return i;
}

void damped_displacement(const Curves& curves, std::size_t n, double factor, double* response) {
  const std::size_t left = damp(Tag(), curves, 0, n, factor, response);
  damp(hn::CappedTag<double, 1>(), curves, left, n, factor, response);
}

}  // namespace flirt::curve_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt::curve_kernels {

HWY_EXPORT(find_ends);
HWY_EXPORT(gaussian_sums);
HWY_EXPORT(prepare_columns);
HWY_EXPORT(weighted_sums);
HWY_EXPORT(divide_columns);
HWY_EXPORT(damped_displacement);

std::size_t find_ends(const Pairs& pairs) {
  return HWY_DYNAMIC_DISPATCH(find_ends)(pairs);
}

void gaussian_sums(const Pairs& pairs, double* kernel, double* sum) {
  HWY_DYNAMIC_DISPATCH(gaussian_sums)(pairs, kernel, sum);
}

void prepare_columns(const double* x, const double* y, const double* density, std::size_t n, const Columns& columns) {
  HWY_DYNAMIC_DISPATCH(prepare_columns)(x, y, density, n, columns);
}

void weighted_sums(const Pairs& pairs, const double* kernel, const Columns& columns, const Columns& sums) {
  HWY_DYNAMIC_DISPATCH(weighted_sums)(pairs, kernel, columns, sums);
}

void divide_columns(const Columns& sums, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(divide_columns)(sums, n);
}

void damped_displacement(const Curves& curves, std::size_t n, double factor, double* response) {
  HWY_DYNAMIC_DISPATCH(damped_displacement)(curves, n, factor, response);
}

}  // namespace flirt::curve_kernels
#endif
