#include "flirt/core/parallel.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace flirt {
namespace {

TEST(ParallelFor, VisitsEachItemOnceOnAnyNumberOfThreads) {
  for (const std::size_t threads : {1U, 2U, 7U}) {
    std::vector<int> visits(1000);
    parallel_for(
        visits.size(), threads,
        [&](std::size_t item, std::size_t thread) {
          ++visits[item];
          ASSERT_LT(thread, threads);
        },
        {}, 7);
    EXPECT_EQ(visits, std::vector<int>(1000, 1));
  }
}

TEST(ParallelFor, DoesNothingWithoutItems) {
  parallel_for(0, 4, [](std::size_t, std::size_t) { FAIL(); });
}

TEST(Rng, StreamsAreRepeatableAndDiffer) {
  Rng a(5, 1);
  Rng b(5, 1);
  Rng c(5, 2);
  EXPECT_EQ(a.bits(), b.bits());
  EXPECT_NE(a.bits(), c.bits());
}

TEST(Rng, NormalHasMeanZeroAndVarianceOne) {
  Rng rng(3);
  double sum = 0;
  double squares = 0;
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double draw = rng.normal();
    sum += draw;
    squares += draw * draw;
  }
  EXPECT_NEAR(sum / n, 0, 0.015);
  EXPECT_NEAR(squares / n, 1, 0.02);
}

}  // namespace
}  // namespace flirt
