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

/// 2^y for y ≤ 0 with a relative error below 2e-12; 2^−1000 for anything smaller. y = n + f with n an integer and
/// |f| ≤ ½: a polynomial for 2^f, n added to its exponent. The integer is taken from the low bits of y + 1.5 · 2^52.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V exp2_of_negative(D d, V y) {
  const hn::RebindToUnsigned<D> bits;
  const V round_to_integer = hn::Set(d, 0x1.8p52);
  y = hn::Max(y, hn::Set(d, -1000.0));
  const V shifted = hn::Add(y, round_to_integer);
  const V f = hn::Sub(y, hn::Sub(shifted, round_to_integer));
  const V f2 = hn::Mul(f, f);
  const V f4 = hn::Mul(f2, f2);
  // Interpolation of 2^f at the nine Chebyshev nodes of [−½, ½].
  const V a = hn::MulAdd(f, hn::Set(d, 0.6931471805459335), hn::Set(d, 1.0));
  const V b = hn::MulAdd(f, hn::Set(d, 0.05550410941205933), hn::Set(d, 0.2402265069581299));
  const V c = hn::MulAdd(f, hn::Set(d, 0.0013333450568000645), hn::Set(d, 0.009618129159402558));
  const V e = hn::MulAdd(f, hn::Set(d, 1.5310079402249296e-05), hn::Set(d, 0.00015403455852453838));
  const V low = hn::MulAdd(f2, b, a);
  const V high = hn::MulAdd(f2, e, c);
  const V power = hn::MulAdd(f4, hn::MulAdd(f4, hn::Set(d, 1.3255224878668817e-06), high), low);
  const auto exponent = hn::ShiftLeft<52>(hn::BitCast(bits, shifted));
  return hn::BitCast(d, hn::Add(hn::BitCast(bits, power), exponent));
}

HWY_INLINE double sum_of_lanes(Tag d, Vector v) {
  return hn::GetLane(hn::SumOfLanes(d, v));
}

void gaussian_rows(const Rows& rows, double rate, double* HWY_RESTRICT kernel, double* HWY_RESTRICT sum) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vector minus_rate = hn::Set(d, -rate);
  for (std::size_t i = 0; i < rows.count; ++i) {
    const std::size_t end = rows.end[i];
    if (end == i + 1) { continue; }
    const Vector arc_i = hn::Set(d, rows.arc[i]);
    Vector row_sum = hn::Zero(d);
    std::size_t j = (i + 1) / lanes * lanes;
    const auto value = [&]() HWY_ATTR {
      const Vector distance = hn::Sub(hn::Load(d, rows.arc + j), arc_i);
      return exp2_of_negative(d, hn::Mul(hn::Mul(distance, distance), minus_rate));
    };
    const auto add = [&](Vector k) HWY_ATTR {
      hn::Store(k, d, kernel);
      hn::Store(hn::Add(hn::Load(d, sum + j), k), d, sum + j);
      row_sum = hn::Add(row_sum, k);
      kernel += lanes;
      j += lanes;
    };
    const auto up_to_i = hn::FirstN(d, i + 1 - j);
    if (j + lanes >= end) {
      add(hn::IfThenZeroElse(up_to_i, hn::IfThenElseZero(hn::FirstN(d, end - j), value())));
    } else {
      add(hn::IfThenZeroElse(up_to_i, value()));
      while (j + lanes < end) { add(value()); }
      add(hn::IfThenElseZero(hn::FirstN(d, end - j), value()));
    }
    sum[i] += sum_of_lanes(d, row_sum);
  }
}

void weighted_rows(const Rows& rows, const double* HWY_RESTRICT kernel, const Columns& columns, const Sums& sums) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < rows.count; ++i) {
    const std::size_t end = rows.end[i];
    if (end == i + 1) { continue; }
    const Vector weight = hn::Set(d, columns.weight[i]);
    const Vector weighted_x = hn::Set(d, columns.weighted_x[i]);
    const Vector weighted_y = hn::Set(d, columns.weighted_y[i]);
    Vector row_weight = hn::Zero(d);
    Vector row_x = hn::Zero(d);
    Vector row_y = hn::Zero(d);
    for (std::size_t j = (i + 1) / lanes * lanes; j < end; j += lanes, kernel += lanes) {
      const Vector k = hn::Load(d, kernel);
      row_weight = hn::MulAdd(k, hn::Load(d, columns.weight + j), row_weight);
      row_x = hn::MulAdd(k, hn::Load(d, columns.weighted_x + j), row_x);
      row_y = hn::MulAdd(k, hn::Load(d, columns.weighted_y + j), row_y);
      hn::Store(hn::MulAdd(k, weight, hn::Load(d, sums.weight + j)), d, sums.weight + j);
      hn::Store(hn::MulAdd(k, weighted_x, hn::Load(d, sums.weighted_x + j)), d, sums.weighted_x + j);
      hn::Store(hn::MulAdd(k, weighted_y, hn::Load(d, sums.weighted_y + j)), d, sums.weighted_y + j);
    }
    sums.weight[i] += sum_of_lanes(d, row_weight);
    sums.weighted_x[i] += sum_of_lanes(d, row_x);
    sums.weighted_y[i] += sum_of_lanes(d, row_y);
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

HWY_EXPORT(gaussian_rows);
HWY_EXPORT(weighted_rows);
HWY_EXPORT(damped_displacement);

std::size_t kernel_size(const Rows& rows) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < rows.count; ++i) { size += rows.end[i] - i + 2 * padding; }
  return size;
}

void gaussian_rows(const Rows& rows, double rate, double* kernel, double* sum) {
  HWY_DYNAMIC_DISPATCH(gaussian_rows)(rows, rate, kernel, sum);
}

void weighted_rows(const Rows& rows, const double* kernel, const Columns& columns, const Sums& sums) {
  HWY_DYNAMIC_DISPATCH(weighted_rows)(rows, kernel, columns, sums);
}

void damped_displacement(const Curves& curves, std::size_t n, double factor, double* response) {
  HWY_DYNAMIC_DISPATCH(damped_displacement)(curves, n, factor, response);
}

}  // namespace flirt::curve_kernels
#endif
