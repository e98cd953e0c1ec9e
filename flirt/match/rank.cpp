#include "flirt/match/rank.hpp"

#include "flirt/core/assert.hpp"

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/match/rank.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include "flirt/match/lanes-inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

void rank_ascending(const float* values, std::size_t count, std::uint32_t* ranks) {
  const Floats d;
  const hn::RebindToSigned<Floats> integers;
  const hn::RebindToUnsigned<Floats> unsigned_integers;
  for (std::size_t first = 0; first < count; first += lanes) {
    const auto value = hn::LoadU(d, values + first);
    const auto index = hn::Iota(integers, static_cast<std::int32_t>(first));
    auto rank = hn::Zero(integers);
    for (std::size_t j = 0; j < count; ++j) {
      const auto other = hn::Set(d, values[j]);
      const auto later = hn::RebindMask(d, hn::Gt(index, hn::Set(integers, static_cast<std::int32_t>(j))));
      const auto behind = hn::Or(hn::Lt(other, value), hn::And(hn::Eq(other, value), later));
      rank = hn::IfThenElse(hn::RebindMask(integers, behind), hn::Add(rank, hn::Set(integers, 1)), rank);
    }
    hn::StoreU(hn::BitCast(unsigned_integers, rank), unsigned_integers, ranks + first);
  }
}

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt {
namespace {

HWY_EXPORT(rank_ascending);

}  // namespace

void rank_ascending(std::span<const float> values, std::size_t count, std::span<std::uint32_t> ranks) {
  [[maybe_unused]] const std::size_t padded = (count + 15) / 16 * 16;
  FLIRT_ASSERT(values.size() >= padded && ranks.size() >= padded);
  HWY_DYNAMIC_DISPATCH(rank_ascending)(values.data(), count, ranks.data());
}

}  // namespace flirt
#endif
