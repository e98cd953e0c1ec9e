#include "flirt/match/rank.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

namespace flirt {
namespace {

std::vector<std::uint32_t> ranks_of(std::vector<float> values) {
  const std::size_t count = values.size();
  values.resize((count + 15) / 16 * 16, -1e30F);  // padding must not count
  std::vector<std::uint32_t> ranks(values.size());
  rank_ascending(values, count, ranks);
  ranks.resize(count);
  return ranks;
}

TEST(RankAscending, IsTheRankOfAStableSort) {
  Rng rng(1);
  for (const std::uint32_t count : {1U, 2U, 15U, 16U, 17U, 26U, 64U, 100U}) {
    for (const std::uint32_t different : {3U, 1000U}) {  // many equal ones, hardly any
      std::vector<float> values(count);
      for (float& value : values) { value = 0.001F * static_cast<float>(rng.below(different)) - 0.3F; }
      std::vector<std::uint32_t> order(count);
      std::iota(order.begin(), order.end(), 0U);
      std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return values[i]; });
      const std::vector<std::uint32_t> ranks = ranks_of(values);
      for (std::uint32_t place = 0; place < count; ++place) { EXPECT_EQ(ranks[order[place]], place); }
    }
  }
}

TEST(RankAscending, BothZerosAreEqualAndInfinityIsLast) {
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(ranks_of({infinity, 0.0F, -0.0F, -infinity}), (std::vector<std::uint32_t>{3, 1, 2, 0}));
}

}  // namespace
}  // namespace flirt
