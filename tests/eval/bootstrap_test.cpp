#include "flirt/eval/bootstrap.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace flirt {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

TEST(BootstrapMean, LeavesOutCasesWithoutValue) {
  const std::vector<double> values{1, no_value, 3, no_value};
  const Mean mean = bootstrap_mean(values, 1);
  EXPECT_EQ(mean.value, 2);
  EXPECT_EQ(mean.cases, 2U);
  EXPECT_EQ(mean.interval.low, 1);
  EXPECT_EQ(mean.interval.high, 3);
  EXPECT_EQ(bootstrap_mean(std::vector<double>{no_value}, 1).cases, 0U);
}

TEST(BootstrapMean, IntervalIsThatOfTheNormalApproximation) {
  Rng rng(3);
  std::vector<double> values(400);
  for (double& value : values) { value = rng.normal(5, 2); }
  const Mean mean = bootstrap_mean(values, 1);
  EXPECT_NEAR(mean.interval.high - mean.interval.low, 2 * 1.96 * 2 / 20.0, 0.06);
  EXPECT_LT(mean.interval.low, mean.value);
  EXPECT_GT(mean.interval.high, mean.value);
}

TEST(BootstrapDifference, SeesASmallStepThatCasesHide) {
  // Cases differ by much more than the two methods do.
  Rng rng(5);
  std::vector<double> a(60);
  std::vector<double> b(60);
  for (std::size_t i = 0; i < a.size(); ++i) {
    b[i] = rng.uniform(0, 1);
    a[i] = b[i] + 0.02 + rng.normal(0, 0.01);
  }
  a[7] = no_value;
  const Mean lead = bootstrap_difference(a, b, 1);
  EXPECT_EQ(lead.cases, 59U);
  EXPECT_GT(lead.interval.low, 0.01);
  EXPECT_LT(lead.interval.high, 0.03);
  EXPECT_GT(bootstrap_mean(a, 1).interval.high - bootstrap_mean(a, 1).interval.low, 0.1);
}

TEST(BlockBootstrapMean, IsWiderWhenNeighboursAgree) {
  std::vector<double> values;
  std::vector<std::uint32_t> block;
  Rng rng(6);
  for (std::uint32_t b = 0; b < 20; ++b) {
    const double value = rng.uniform();
    for (int i = 0; i < 10; ++i) {
      values.push_back(value);
      block.push_back(b);
    }
  }
  const Interval blocks = block_bootstrap_mean(block, values, 1).interval;
  const Interval cases = bootstrap_mean(values, 1).interval;
  EXPECT_GT(blocks.high - blocks.low, 2 * (cases.high - cases.low));
}

TEST(BlockBootstrapMean, OfDifferencesSeesWhatTheSpreadOfTheSharesHides) {
  // Blocks are all right or all wrong by the first; the second loses the last case of each block that was right.
  std::vector<double> first;
  std::vector<double> gain;
  std::vector<std::uint32_t> block;
  for (std::uint32_t i = 0; i < 400; ++i) {
    first.push_back((i / 10) % 2 == 0 ? 1 : 0);
    gain.push_back(first.back() == 1 && i % 10 == 9 ? -1 : 0);
    block.push_back(i / 10);
  }
  const Interval alone = block_bootstrap_mean(block, first, 1).interval;
  const Interval paired = block_bootstrap_mean(block, gain, 1).interval;
  EXPECT_LT(paired.high, 0);
  EXPECT_LT(paired.low, -0.05);
  EXPECT_GT(paired.low, -0.1);
  EXPECT_GT(alone.high - alone.low, 4 * (paired.high - paired.low));
}

TEST(BootstrapDraws, AreTheSameForEveryoneWhoAsks) {
  const auto draws = bootstrap_draws(5, 3, 9);
  ASSERT_EQ(draws.size(), 3U);
  EXPECT_EQ(draws, bootstrap_draws(5, 3, 9));
  EXPECT_NE(draws, bootstrap_draws(5, 3, 10));
  for (const auto& draw : draws) {
    ASSERT_EQ(draw.size(), 5U);
    for (const std::uint32_t index : draw) { EXPECT_LT(index, 5U); }
  }
}

}  // namespace
}  // namespace flirt
