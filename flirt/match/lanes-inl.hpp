// flirt/match/lanes-inl.hpp: sums over rows of 16·n floats, in an order that does not depend on the vector length.
// Included once per instruction set by the files that use Highway's run-time dispatch.
#if defined(FLIRT_MATCH_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef FLIRT_MATCH_LANES_INL
#undef FLIRT_MATCH_LANES_INL
#else
#define FLIRT_MATCH_LANES_INL
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using FloatVector = hn::Vec<Floats>;
constexpr std::size_t lanes = hn::MaxLanes(Floats{});  ///< floats per vector
constexpr std::size_t parts = 16 / lanes;              ///< vectors per group of 16 floats

/// Halves are added until one number is left: ((a0 + a8) + (a4 + a12)) + …
template <class Tag>
HWY_INLINE float sum_of_lanes(Tag /*d*/, hn::Vec<Tag> v) {
#if HWY_TARGET == HWY_SCALAR
  return hn::GetLane(v);
#else
  if constexpr (hn::MaxLanes(Tag{}) > 4) {
    const hn::Half<Tag> half;
    return sum_of_lanes(half, hn::Add(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  } else {
    const auto pairs = hn::Add(v, hn::Shuffle1032(v));
    return hn::GetLane(hn::Add(pairs, hn::Shuffle2301(pairs)));
  }
#endif
}

/// Sum of 16 running sums, spread over `parts` vectors.
HWY_INLINE float sum_of_group(FloatVector (&sum)[parts]) {
  for (std::size_t half = parts / 2; half > 0; half /= 2) {
    for (std::size_t part = 0; part < half; ++part) { sum[part] = hn::Add(sum[part], sum[part + half]); }
  }
  return sum_of_lanes(Floats{}, sum[0]);
}

/// Σ term(k) for k = 0, lanes, 2·lanes, …; `term` gives the summands of one vector that starts at column k.
template <class Term>
HWY_INLINE float sum_over_row(std::size_t stride, const Term& term) {
  const Floats d;
  FloatVector sum[parts];
  for (FloatVector& part : sum) { part = hn::Zero(d); }
  for (std::size_t k = 0; k < stride; k += 16) {
    for (std::size_t part = 0; part < parts; ++part) { sum[part] = hn::Add(sum[part], term(k + part * lanes)); }
  }
  return sum_of_group(sum);
}

/// Bits of the 16 lanes of a group, from the masks of its vectors: mask(part).
template <class Mask>
HWY_INLINE std::uint16_t bits_of_group(const Mask& mask) {
  std::uint32_t bits = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(Floats{}, mask(part), bytes);
    bits |= (std::uint32_t{bytes[0]} | (lanes > 8 ? std::uint32_t{bytes[1]} << 8U : 0U)) << (part * lanes);
  }
  return static_cast<std::uint16_t>(bits);
}

/// Symmetric χ², ½ Σ (p−q)²/(p+q). The smallest normal number turns 0/0 into 0 and vanishes in any other sum.
HWY_INLINE float chi_square(const float* p_row, const float* q_row, std::size_t stride) {
  const Floats d;
  const auto tiny = hn::Set(d, 1.17549435e-38F);
  return 0.5F * sum_over_row(stride, [=](std::size_t k) HWY_ATTR {
           const auto p = hn::LoadU(d, p_row + k);
           const auto q = hn::LoadU(d, q_row + k);
           const auto difference = hn::Sub(p, q);
           return hn::Div(hn::Mul(difference, difference), hn::Add(hn::Add(p, q), tiny));
         });
}

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
