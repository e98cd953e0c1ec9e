// flirt/registration/byte_sums-inl.hpp: sums of bytes carried on in words. Included once per instruction set.
#if defined(FLIRT_REGISTRATION_BYTE_SUMS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef FLIRT_REGISTRATION_BYTE_SUMS_INL_HPP
#undef FLIRT_REGISTRATION_BYTE_SUMS_INL_HPP
#else
#define FLIRT_REGISTRATION_BYTE_SUMS_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

/// sums[i] += bytes[i]
template <class Bytes>
void add_to_words(Bytes d8, hwy::HWY_NAMESPACE::Vec<Bytes> bytes, std::uint16_t* sums) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::Half<Bytes> d8_half;
  const hn::Rebind<std::uint16_t, decltype(d8_half)> d16;
  constexpr std::size_t lanes = hn::MaxLanes(Bytes());
  constexpr std::size_t half_lanes = hn::MaxLanes(hn::Half<Bytes>());
  alignas(64) std::uint8_t stored[lanes];
  hn::Store(bytes, d8, stored);
  for (std::size_t i = 0; i < lanes; i += half_lanes) {
    const auto more = hn::PromoteTo(d16, hn::LoadU(d8_half, stored + i));
    hn::StoreU(hn::Add(hn::LoadU(d16, sums + i), more), d16, sums + i);
  }
}

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
