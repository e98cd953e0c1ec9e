// flirt/features/curve_lanes-inl.hpp: groups of points in vectors as long as there are, and sums over them in an order
// that does not depend on that length. Included once per instruction set by curve_kernels.cpp.
#if defined(FLIRT_FEATURES_CURVE_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef FLIRT_FEATURES_CURVE_LANES_INL
#undef FLIRT_FEATURES_CURVE_LANES_INL
#else
#define FLIRT_FEATURES_CURVE_LANES_INL
#endif

#include "flirt/features/curve_kernels.hpp"

#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace flirt::curve_kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, padding>;
using Floats = hn::Vec<FloatTag>;
constexpr std::size_t float_lanes = hn::MaxLanes(FloatTag());
constexpr std::size_t float_parts = padding / float_lanes;  // vectors in a group of points

/// What belongs to a group of points in one row.
struct Group {
  Floats part[float_parts];
};

using TwoTag = hn::CappedTag<float, 2 * padding>;
using TwoPart = hn::Vec<TwoTag>;
constexpr std::size_t two_lanes = hn::MaxLanes(TwoTag());
constexpr std::size_t two_parts = 2 * padding / two_lanes;
constexpr bool in_one = two_parts == 1;

/// What belongs to a group of points in two rows: all of the first, then all of the second.
struct Two {
  TwoPart part[two_parts];
};

/// A number for each of two rows.
HWY_INLINE Two two_of(float first, float second) {
  const TwoTag d;
  Two two;
  for (std::size_t part = 0; part < two_parts; ++part) {
    if constexpr (in_one) {
      two.part[part] = hn::IfThenElse(hn::FirstN(d, padding), hn::Set(d, first), hn::Set(d, second));
    } else {
      two.part[part] = hn::Set(d, part < two_parts / 2 ? first : second);
    }
  }
  return two;
}

/// The group of points from j for both rows, from an array that holds each group twice (see first_copy).
HWY_INLINE Two load_for_both(const float* values, std::size_t j) {
  constexpr std::size_t different = in_one ? 1 : two_parts / 2;  // beyond are the same again: not loaded
  Two two;
  for (std::size_t part = 0; part < two_parts; ++part) {
    two.part[part] = hn::Load(TwoTag(), values + 2 * j + part % different * two_lanes);
  }
  return two;
}

#if HWY_TARGET == HWY_SCALAR
template <std::size_t Row>
HWY_INLINE Group row_of(const Two& two) {
  Group group;
  for (std::size_t part = 0; part < float_parts; ++part) { group.part[part] = two.part[Row * float_parts + part]; }
  return group;
}
#else
/// A template over its argument so that the branch for another vector length need not compile.
template <std::size_t Row, class D = TwoTag, class Vectors = Two>
HWY_INLINE Group row_of(const Vectors& two) {
  Group group;
  if constexpr (in_one) {
    const hn::Half<D> half;
    group.part[0] = Row == 0 ? hn::LowerHalf(half, two.part[0]) : hn::UpperHalf(half, two.part[0]);
  } else {
    for (std::size_t part = 0; part < float_parts; ++part) { group.part[part] = two.part[Row * float_parts + part]; }
  }
  return group;
}

/// Lanes 0 + 4, 1 + 5, 2 + 6 and 3 + 7.
template <class D = FloatTag>
HWY_INLINE auto sum_of_halves(const Group& group) {
  if constexpr (float_parts == 1) {
    const hn::Half<D> d;
    return hn::Add(hn::LowerHalf(d, group.part[0]), hn::UpperHalf(d, group.part[0]));
  } else {
    return hn::Add(group.part[0], group.part[1]);
  }
}
#endif

/// Sums of the groups of four rows to out[0] .. out[3], each ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7)) of its points.
HWY_INLINE void store_sums(const Group (&groups)[rows_at_once], float* out) {
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t k = 0; k < rows_at_once; ++k) {
    const auto lane = [&](std::size_t i) { return hn::GetLane(groups[k].part[i]); };
    out[k] = ((lane(0) + lane(4)) + (lane(2) + lane(6))) + ((lane(1) + lane(5)) + (lane(3) + lane(7)));
  }
#else
  const hn::CappedTag<float, 4> d;
  hn::Vec<decltype(d)> halves[rows_at_once];
  for (std::size_t k = 0; k < rows_at_once; ++k) { halves[k] = sum_of_halves(groups[k]); }
  const auto of_two = [&](std::size_t k) HWY_ATTR {
    return hn::Add(hn::InterleaveLower(d, halves[k], halves[k + 1]), hn::InterleaveUpper(d, halves[k], halves[k + 1]));
  };
  const auto first = of_two(0);
  const auto second = of_two(2);
  hn::Store(hn::Add(hn::ConcatLowerLower(d, second, first), hn::ConcatUpperUpper(d, second, first)), d, out);
#endif
}

}  // namespace flirt::curve_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
