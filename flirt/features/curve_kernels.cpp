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

using FloatTag = hn::CappedTag<float, padding>;
using Floats = hn::Vec<FloatTag>;
constexpr std::size_t float_lanes = hn::MaxLanes(FloatTag());
constexpr std::size_t float_parts = padding / float_lanes;  // vectors in a group of points

/// 2^(−x²), or 0 where x is above `reach`, which is at most `farthest`: as exp2_of_rounded, in single precision.
HWY_INLINE Floats gaussian(FloatTag d, Floats x, Floats reach) {
  const auto round = hn::Set(d, 0x1.8p23F);
  const Floats shifted = hn::NegMulAdd(x, x, round);
  const Floats f = hn::NegMulSub(x, x, hn::Sub(shifted, round));
  // Interpolation of 2^f at the six Chebyshev nodes of [−½, ½]: within 1.1e-7.
  Floats power = hn::MulAdd(f, hn::Set(d, 0.0013390863364533504F), hn::Set(d, 0.009676031918326564F));
  power = hn::MulAdd(f, power, hn::Set(d, 0.05550357114219461F));
  power = hn::MulAdd(f, power, hn::Set(d, 0.24022107485308208F));
  power = hn::MulAdd(f, power, hn::Set(d, 0.6931471880262287F));
  power = hn::MulAdd(f, power, hn::Set(d, 1.0F));
  const hn::RebindToUnsigned<FloatTag> bits;
  const auto exponent = hn::ShiftLeft<23>(hn::BitCast(bits, shifted));
  const Floats scaled = hn::BitCast(d, hn::Add(hn::BitCast(bits, power), exponent));
  return hn::IfThenElseZero(hn::Le(x, reach), scaled);
}

template <class D>
HWY_INLINE auto sum_of_lanes(D d, hn::Vec<D> v) {
  return hn::GetLane(hn::SumOfLanes(d, v));
}

// Rows of pairs are taken two at a time, i and i + 1, so that what belongs to a group of points is loaded and stored
// once for both. They start with the group of point i + 1, in which lanes up to a row's own point are cleared. The row
// after an odd last one is empty: its point is put beyond everything.

constexpr float beyond_everything = -1e30F;  // so far before the others that none is within reach

HWY_INLINE std::size_t begin_of(std::size_t i) {
  return (i + 1) / padding * padding;
}

std::size_t find_ends(const Pairs& pairs) {
  std::size_t size = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < pairs.count; i += 2) {
    const std::size_t begin = begin_of(i);
    const double limit = pairs.arc[i + 1 < pairs.count ? i + 1 : i] + pairs.reach;
    end = end > begin + padding ? end : begin + padding;
    while (end < pairs.extended && pairs.arc[end] <= limit) { end += padding; }
    pairs.ends[i / 2] = static_cast<std::uint32_t>(end);
    size += 2 * (end - begin);
  }
  return size;
}

/// A point that has a row of pairs.
struct RowPoint {
  Floats high;
  Floats low;
};

/// Kernel of one row at the points from j, a vector of them.
HWY_INLINE Floats kernel_of(const Pairs& pairs, const RowPoint& point, std::size_t j) {
  const FloatTag d;
  const Floats x =
      hn::Add(hn::Sub(hn::Load(d, pairs.arc_high + j), point.high), hn::Sub(hn::Load(d, pairs.arc_low + j), point.low));
  return gaussian(d, x, hn::Load(d, pairs.reach_of + j));
}

void gaussian_sums(const Pairs& pairs, float* HWY_RESTRICT kernel, float* HWY_RESTRICT sum) {
  const FloatTag d;
  for (std::size_t i = 0; i < pairs.count; i += 2) {
    const bool has_second = i + 1 < pairs.count;
    const RowPoint point_0{hn::Set(d, pairs.arc_high[i]), hn::Set(d, pairs.arc_low[i])};
    const RowPoint point_1{hn::Set(d, has_second ? pairs.arc_high[i + 1] : beyond_everything),
                           hn::Set(d, has_second ? pairs.arc_low[i + 1] : 0.0F)};
    Floats row_sum_0 = hn::Zero(d);
    Floats row_sum_1 = hn::Zero(d);
    const auto add = [&](std::size_t j, std::size_t part, Floats k_0, Floats k_1) HWY_ATTR {
      hn::Store(k_0, d, kernel + part * float_lanes);
      hn::Store(k_1, d, kernel + padding + part * float_lanes);
      hn::Store(hn::Add(hn::Load(d, sum + j), hn::Add(k_0, k_1)), d, sum + j);
      row_sum_0 = hn::Add(row_sum_0, k_0);
      row_sum_1 = hn::Add(row_sum_1, k_1);
    };
    const std::size_t begin = begin_of(i);
    const std::size_t end = pairs.ends[i / 2];
    for (std::size_t part = 0; part < float_parts; ++part) {
      const std::size_t j = begin + part * float_lanes;
      const Floats index = hn::Iota(d, static_cast<float>(j));
      const auto after_0 = hn::Gt(index, hn::Set(d, static_cast<float>(i)));
      const auto after_1 = hn::Gt(index, hn::Set(d, static_cast<float>(i + 1)));
      add(j, part, hn::IfThenElseZero(after_0, kernel_of(pairs, point_0, j)),
          hn::IfThenElseZero(after_1, kernel_of(pairs, point_1, j)));
    }
    kernel += 2 * padding;
    for (std::size_t first = begin + padding; first < end; first += padding, kernel += 2 * padding) {
      for (std::size_t part = 0; part < float_parts; ++part) {
        const std::size_t j = first + part * float_lanes;
        add(j, part, kernel_of(pairs, point_0, j), kernel_of(pairs, point_1, j));
      }
    }
    sum[i] += sum_of_lanes(d, row_sum_0);
    sum[i + 1] += sum_of_lanes(d, row_sum_1);
  }
}

void invert(const float* HWY_RESTRICT density, std::size_t n, float* HWY_RESTRICT weight) {
  const FloatTag d;
  for (std::size_t i = 0; i < n; i += float_lanes) {
    hn::Store(hn::Div(hn::Set(d, 1.0F), hn::Load(d, density + i)), d, weight + i);
  }
}

/// A point that has a row of pairs, and what its row has added up to.
struct SumRow {
  Floats weight;
  Floats x;
  Floats y;
  Floats weight_sum;
  Floats x_sum;
  Floats y_sum;
};

HWY_INLINE SumRow sum_row(const Columns& points, std::size_t i) {
  const FloatTag d;
  return {hn::Set(d, points.weight[i]),
          hn::Set(d, points.x[i]),
          hn::Set(d, points.y[i]),
          hn::Zero(d),
          hn::Zero(d),
          hn::Zero(d)};
}

/// A vector of points that are second of pairs, and what they have got.
struct SumVector {
  Floats weight;
  Floats x;
  Floats y;
  Floats weight_sum;
  Floats x_sum;
  Floats y_sum;
};

HWY_INLINE void add_pairs(Floats kernel, SumRow& row, SumVector& others) {
  const Floats x = hn::Sub(others.x, row.x);
  const Floats y = hn::Sub(others.y, row.y);
  const Floats to_row = hn::Mul(kernel, others.weight);
  row.weight_sum = hn::Add(row.weight_sum, to_row);
  row.x_sum = hn::MulAdd(to_row, x, row.x_sum);
  row.y_sum = hn::MulAdd(to_row, y, row.y_sum);
  const Floats from_row = hn::Mul(kernel, row.weight);
  others.weight_sum = hn::Add(others.weight_sum, from_row);
  others.x_sum = hn::NegMulAdd(from_row, x, others.x_sum);
  others.y_sum = hn::NegMulAdd(from_row, y, others.y_sum);
}

void weighted_sums(const Pairs& pairs, const float* HWY_RESTRICT kernel, const Columns& points, const Columns& sums) {
  const FloatTag d;
  const auto add_row = [&](const SumRow& row, std::size_t i) HWY_ATTR {
    sums.weight[i] += sum_of_lanes(d, row.weight_sum);
    sums.x[i] += sum_of_lanes(d, row.x_sum);
    sums.y[i] += sum_of_lanes(d, row.y_sum);
  };
  for (std::size_t i = 0; i < pairs.count; i += 2) {
    SumRow row_0 = sum_row(points, i);
    SumRow row_1 = sum_row(points, i + 1);
    const std::size_t end = pairs.ends[i / 2];
    for (std::size_t first = begin_of(i); first < end; first += padding, kernel += 2 * padding) {
      for (std::size_t lane = 0; lane < padding; lane += float_lanes) {
        const std::size_t j = first + lane;
        SumVector others{hn::Load(d, points.weight + j), hn::Load(d, points.x + j), hn::Load(d, points.y + j),
                         hn::Load(d, sums.weight + j),   hn::Load(d, sums.x + j),   hn::Load(d, sums.y + j)};
        add_pairs(hn::Load(d, kernel + lane), row_0, others);
        add_pairs(hn::Load(d, kernel + padding + lane), row_1, others);
        hn::Store(others.weight_sum, d, sums.weight + j);
        hn::Store(others.x_sum, d, sums.x + j);
        hn::Store(others.y_sum, d, sums.y + j);
      }
    }
    add_row(row_0, i);
    add_row(row_1, i + 1);
  }
}

void divide_columns(const Columns& sums, std::size_t n) {
  const FloatTag d;
  for (std::size_t i = 0; i < n; i += float_lanes) {
    const Floats weight = hn::Load(d, sums.weight + i);
    hn::Store(hn::Div(hn::Load(d, sums.x + i), weight), d, sums.x + i);
    hn::Store(hn::Div(hn::Load(d, sums.y + i), weight), d, sums.y + i);
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
HWY_EXPORT(invert);
HWY_EXPORT(weighted_sums);
HWY_EXPORT(divide_columns);
HWY_EXPORT(damped_displacement);

std::size_t find_ends(const Pairs& pairs) {
  return HWY_DYNAMIC_DISPATCH(find_ends)(pairs);
}

void gaussian_sums(const Pairs& pairs, float* kernel, float* sum) {
  HWY_DYNAMIC_DISPATCH(gaussian_sums)(pairs, kernel, sum);
}

void invert(const float* density, std::size_t n, float* weight) {
  HWY_DYNAMIC_DISPATCH(invert)(density, n, weight);
}

void weighted_sums(const Pairs& pairs, const float* kernel, const Columns& points, const Columns& sums) {
  HWY_DYNAMIC_DISPATCH(weighted_sums)(pairs, kernel, points, sums);
}

void divide_columns(const Columns& sums, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(divide_columns)(sums, n);
}

void damped_displacement(const Curves& curves, std::size_t n, double factor, double* response) {
  HWY_DYNAMIC_DISPATCH(damped_displacement)(curves, n, factor, response);
}

}  // namespace flirt::curve_kernels
#endif
