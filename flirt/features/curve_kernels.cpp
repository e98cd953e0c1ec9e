#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/features/curve_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for every target.
#include "flirt/features/curve_exp2-inl.hpp"
#include "flirt/features/curve_kernels.hpp"
#include "flirt/features/curve_lanes-inl.hpp"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flirt::curve_kernels::HWY_NAMESPACE {

// Rows of pairs are taken four at a time, i to i + 3, so that what belongs to a group of points is loaded and stored
// once for all. They start with the group of point i, in which lanes up to a row's own point are cleared. Rows after
// the last one are empty: their points are put beyond everything.

HWY_INLINE std::size_t begin_of(std::size_t i) {
  return i / padding * padding;
}

std::size_t find_ends(const Pairs& pairs) {
  std::size_t size = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < pairs.count; i += rows_at_once) {
    const std::size_t begin = begin_of(i);
    const std::size_t last = i + rows_at_once <= pairs.count ? i + rows_at_once - 1 : pairs.count - 1;
    const double limit = pairs.arc[last] + pairs.reach;
    end = end > begin + padding ? end : begin + padding;
    while (end < pairs.extended && pairs.arc[end] <= limit) { end += padding; }
    pairs.ends[i / rows_at_once] = static_cast<std::uint32_t>(end);
    size += rows_at_once * (end - begin);
  }
  return size;
}

/// What the rows have added up to is kept apart and joins the sums of their points at the end: a vector load right
/// after the store of one of its elements has to wait for that store.
HWY_INLINE void add_rows(const float* HWY_RESTRICT rows, std::size_t n, float* HWY_RESTRICT sums) {
  const FloatTag d;
  for (std::size_t i = 0; i < n; i += float_lanes) {
    hn::Store(hn::Add(hn::Load(d, sums + i), hn::Load(d, rows + i)), d, sums + i);
  }
}

/// Positions of four rows.
struct RowPositions {
  Two high[2];
  Two low[2];
};

HWY_INLINE RowPositions row_positions(const Pairs& pairs, std::size_t i) {
  const float* const high = pairs.row_high + i;
  const float* const low = pairs.row_low + i;
  return {{two_of(high[0], high[1]), two_of(high[2], high[3])}, {two_of(low[0], low[1]), two_of(low[2], low[3])}};
}

/// Kernels of four rows at one group of points, half way.
struct BegunGroup {
  Halfway half[2][two_parts];
};

HWY_INLINE BegunGroup begin_group(const Pairs& pairs, const RowPositions& rows, std::size_t j) {
  const Two high = load_for_both(pairs.arc_high, j);
  const Two low = load_for_both(pairs.arc_low, j);
  BegunGroup begun;
  for (std::size_t part = 0; part < two_parts; ++part) {
    for (std::size_t two = 0; two < 2; ++two) {
      begun.half[two][part] = begin_gaussian(hn::Add(hn::Sub(high.part[part], rows.high[two].part[part]),
                                                     hn::Sub(low.part[part], rows.low[two].part[part])));
    }
  }
  return begun;
}

/// Points of the group by their place in it; and those of its rows, two and two.
alignas(64) constexpr float places[2 * padding]{0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7};
alignas(64) constexpr float row_places[padding / 2][2 * padding]{{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1},
                                                                 {2, 2, 2, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3, 3},
                                                                 {4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 5, 5, 5, 5, 5},
                                                                 {6, 6, 6, 6, 6, 6, 6, 6, 7, 7, 7, 7, 7, 7, 7, 7}};

/// Leaves out what is no pair (i, j), i < j, in the group that holds the rows themselves, the first `first_row` of it.
HWY_INLINE void leave_out_own(std::size_t first_row, BegunGroup& begun) {
  const TwoTag d;
  for (std::size_t part = 0; part < two_parts; ++part) {
    const TwoPart place = hn::Load(d, places + part * two_lanes);
    for (std::size_t two = 0; two < 2; ++two) {
      const TwoPart row_place = hn::Load(d, row_places[first_row / 2 + two] + part * two_lanes);
      TwoPart& x = begun.half[two][part].x;
      x = hn::IfThenElse(hn::Gt(place, row_place), x, hn::Set(d, -beyond_everything));
    }
  }
}

/// The kernels themselves, to `kernel`; adds them to the sums of the rows and of the points.
HWY_INLINE void end_group(const BegunGroup& begun, const Two& reach, float* HWY_RESTRICT kernel, Two (&row_sums)[2],
                          float* HWY_RESTRICT sum) {
  const TwoTag d;
  Two k[2];
  for (std::size_t part = 0; part < two_parts; ++part) {
    for (std::size_t two = 0; two < 2; ++two) {
      k[two].part[part] = end_gaussian(begun.half[two][part], reach.part[part]);
      hn::Store(k[two].part[part], d, kernel + two * 2 * padding + part * two_lanes);
      row_sums[two].part[part] = hn::Add(row_sums[two].part[part], k[two].part[part]);
    }
  }
  const FloatTag f;
  for (const Two& two : k) {
    const Group first = row_of<0>(two);
    const Group second = row_of<1>(two);
    for (std::size_t part = 0; part < float_parts; ++part) {
      float* const at = sum + part * float_lanes;
      hn::Store(hn::Add(hn::Load(f, at), hn::Add(first.part[part], second.part[part])), f, at);
    }
  }
}

void gaussian_sums(const Pairs& pairs, float* HWY_RESTRICT kernel, float* HWY_RESTRICT sum, float* HWY_RESTRICT rows) {
  for (std::size_t i = 0; i < pairs.count; i += rows_at_once) {
    const RowPositions positions = row_positions(pairs, i);
    Two row_sums[2]{two_of(0.0F, 0.0F), two_of(0.0F, 0.0F)};
    const auto end_one = [&](const BegunGroup& begun, std::size_t j) HWY_ATTR {
      end_group(begun, load_for_both(pairs.reach_of, j), kernel, row_sums, sum + j);
      kernel += rows_at_once * padding;
    };
    std::size_t j = begin_of(i);
    BegunGroup begun = begin_group(pairs, positions, j);
    leave_out_own(i - j, begun);
    for (const std::size_t last = pairs.ends[i / rows_at_once] - padding; j < last; j += padding) {
      if constexpr (in_one) {
        const BegunGroup next = begin_group(pairs, positions, j + padding);
        end_one(begun, j);
        begun = next;
      } else {  // too few registers for two groups at a time
        end_one(begun, j);
        begun = begin_group(pairs, positions, j + padding);
      }
    }
    end_one(begun, j);
    store_sums({row_of<0>(row_sums[0]), row_of<1>(row_sums[0]), row_of<0>(row_sums[1]), row_of<1>(row_sums[1])},
               rows + i);
  }
  add_rows(rows, pairs.count, sum);
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
  Group weight_sum;
  Group x_sum;
  Group y_sum;
};

HWY_INLINE SumRow sum_row(const Columns& points, std::size_t i) {
  const FloatTag d;
  Group zero;
  for (Floats& part : zero.part) { part = hn::Zero(d); }
  return {hn::Set(d, points.weight[i]), hn::Set(d, points.x[i]), hn::Set(d, points.y[i]), zero, zero, zero};
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

HWY_INLINE void add_pairs(Floats kernel, std::size_t part, SumRow& row, SumVector& others) {
  const Floats x = hn::Sub(others.x, row.x);
  const Floats y = hn::Sub(others.y, row.y);
  const Floats to_row = hn::Mul(kernel, others.weight);
  row.weight_sum.part[part] = hn::Add(row.weight_sum.part[part], to_row);
  row.x_sum.part[part] = hn::MulAdd(to_row, x, row.x_sum.part[part]);
  row.y_sum.part[part] = hn::MulAdd(to_row, y, row.y_sum.part[part]);
  const Floats from_row = hn::Mul(kernel, row.weight);
  others.weight_sum = hn::Add(others.weight_sum, from_row);
  others.x_sum = hn::NegMulAdd(from_row, x, others.x_sum);
  others.y_sum = hn::NegMulAdd(from_row, y, others.y_sum);
}

void weighted_sums(const Pairs& pairs, const float* HWY_RESTRICT kernel, const Columns& points, const Columns& sums,
                   const Columns& rows) {
  const FloatTag d;
  for (std::size_t i = 0; i < pairs.count; i += rows_at_once) {
    SumRow row[rows_at_once];
    for (std::size_t k = 0; k < rows_at_once; ++k) { row[k] = sum_row(points, i + k); }
    const std::size_t end = pairs.ends[i / rows_at_once];
    for (std::size_t first = begin_of(i); first < end; first += padding, kernel += rows_at_once * padding) {
      for (std::size_t lane = 0; lane < padding; lane += float_lanes) {
        const std::size_t j = first + lane;
        SumVector others{hn::Load(d, points.weight + j), hn::Load(d, points.x + j), hn::Load(d, points.y + j),
                         hn::Load(d, sums.weight + j),   hn::Load(d, sums.x + j),   hn::Load(d, sums.y + j)};
        for (std::size_t k = 0; k < rows_at_once; ++k) {
          add_pairs(hn::Load(d, kernel + k * padding + lane), lane / float_lanes, row[k], others);
        }
        hn::Store(others.weight_sum, d, sums.weight + j);
        hn::Store(others.x_sum, d, sums.x + j);
        hn::Store(others.y_sum, d, sums.y + j);
      }
    }
    store_sums({row[0].weight_sum, row[1].weight_sum, row[2].weight_sum, row[3].weight_sum}, rows.weight + i);
    store_sums({row[0].x_sum, row[1].x_sum, row[2].x_sum, row[3].x_sum}, rows.x + i);
    store_sums({row[0].y_sum, row[1].y_sum, row[2].y_sum, row[3].y_sum}, rows.y + i);
  }
  add_rows(rows.weight, pairs.count, sums.weight);
  add_rows(rows.x, pairs.count, sums.x);
  add_rows(rows.y, pairs.count, sums.y);
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
  const std::size_t left = damp(hn::CappedTag<double, padding>(), curves, 0, n, factor, response);
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

void gaussian_sums(const Pairs& pairs, float* kernel, float* sum, float* rows) {
  HWY_DYNAMIC_DISPATCH(gaussian_sums)(pairs, kernel, sum, rows);
}

void invert(const float* density, std::size_t n, float* weight) {
  HWY_DYNAMIC_DISPATCH(invert)(density, n, weight);
}

void weighted_sums(const Pairs& pairs, const float* kernel, const Columns& points, const Columns& sums,
                   const Columns& rows) {
  HWY_DYNAMIC_DISPATCH(weighted_sums)(pairs, kernel, points, sums, rows);
}

void divide_columns(const Columns& sums, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(divide_columns)(sums, n);
}

void damped_displacement(const Curves& curves, std::size_t n, double factor, double* response) {
  HWY_DYNAMIC_DISPATCH(damped_displacement)(curves, n, factor, response);
}

}  // namespace flirt::curve_kernels
#endif
