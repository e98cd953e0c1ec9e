#include "flirt/slam/rbpf_resampling.hpp"

#include "flirt/core/rng.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

TEST(RbpfResampling, WeightsSumToOneHoweverSmallTheyWere) {
  EXPECT_THAT(normalized_weights(std::vector<double>{-5000, -5000 + std::log(3.0)}),
              ElementsAre(DoubleNear(0.25, 1e-9), DoubleNear(0.75, 1e-9)));
  EXPECT_TRUE(normalized_weights({}).empty());
}

TEST(RbpfResampling, CountsEffectiveParticles) {
  EXPECT_NEAR(effective_particles(std::vector<double>(8, 0.125)), 8, 1e-12);
  EXPECT_NEAR(effective_particles(std::vector<double>{0, 1, 0}), 1, 1e-12);
}

TEST(RbpfResampling, ContinuesEachParticleAsOftenAsItsWeightSays) {
  Rng rng(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> log_weights;
    for (int i = 0; i < 20; ++i) { log_weights.push_back(rng.uniform(-6, 0)); }
    const std::vector<double> weights = normalized_weights(log_weights);
    const std::vector<std::size_t> parents = low_variance_draw(weights, rng.uniform());
    ASSERT_EQ(parents.size(), weights.size());
    EXPECT_TRUE(std::ranges::is_sorted(parents));
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const auto times = static_cast<double>(std::ranges::count(parents, i));
      EXPECT_LT(std::abs(times - 20 * weights[i]), 1 + 1e-9);
    }
  }
}

TEST(RbpfResampling, LeavesEqualWeightsAlone) {
  EXPECT_THAT(low_variance_draw(std::vector<double>(4, 0.25), 0.5), ElementsAre(0, 1, 2, 3));
}

}  // namespace
}  // namespace flirt
