// flirt/features/curve_exp2-inl.hpp: powers of two. Included once per instruction set by curve_kernels.cpp.
#if defined(FLIRT_FEATURES_CURVE_EXP2_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef FLIRT_FEATURES_CURVE_EXP2_INL
#undef FLIRT_FEATURES_CURVE_EXP2_INL
#else
#define FLIRT_FEATURES_CURVE_EXP2_INL
#endif

#include "flirt/features/curve_lanes-inl.hpp"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flirt::curve_kernels::HWY_NAMESPACE {

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

/// 2^(−x²) half way: −x² as an integer and a fraction in [−½, ½]. The rest takes long, each step waiting for the one
/// before: one begins the next before ending this.
struct Halfway {
  TwoPart x;
  TwoPart shifted;  ///< the integer + 0x1.8p23
  TwoPart fraction;
};

HWY_INLINE Halfway begin_gaussian(TwoPart x) {
  const TwoTag d;
  const auto round = hn::Set(d, 0x1.8p23F);
  const TwoPart shifted = hn::NegMulAdd(x, x, round);
  return {x, shifted, hn::NegMulSub(x, x, hn::Sub(shifted, round))};
}

/// 2^(−x²), or 0 where x is above `reach`, which is at most `farthest`: as exp2_of_rounded, in single precision.
HWY_INLINE TwoPart end_gaussian(const Halfway& half, TwoPart reach) {
  const TwoTag d;
  const TwoPart f = half.fraction;
  // Interpolation of 2^f at the six Chebyshev nodes of [−½, ½]: within 1.1e-7.
  TwoPart power = hn::MulAdd(f, hn::Set(d, 0.0013390863364533504F), hn::Set(d, 0.009676031918326564F));
  power = hn::MulAdd(f, power, hn::Set(d, 0.05550357114219461F));
  power = hn::MulAdd(f, power, hn::Set(d, 0.24022107485308208F));
  power = hn::MulAdd(f, power, hn::Set(d, 0.6931471880262287F));
  power = hn::MulAdd(f, power, hn::Set(d, 1.0F));
  const hn::RebindToUnsigned<TwoTag> bits;
  const auto exponent = hn::ShiftLeft<23>(hn::BitCast(bits, half.shifted));
  const TwoPart scaled = hn::BitCast(d, hn::Add(hn::BitCast(bits, power), exponent));
  return hn::IfThenElseZero(hn::Le(half.x, reach), scaled);
}

}  // namespace flirt::curve_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
