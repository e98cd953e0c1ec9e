// flirt/match/rank.hpp: the order of a few numbers, found without branches that nobody can foresee.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace flirt {

/// ranks[i]: how many of the first `count` values come before value i in rising order, of equal ones the first first.
/// No NaN. Both have room for the count rounded up to 16. O(count²), vectorised: for some dozens.
void rank_ascending(std::span<const float> values, std::size_t count, std::span<std::uint32_t> ranks);

}  // namespace flirt
