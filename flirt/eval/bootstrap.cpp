#include "flirt/eval/bootstrap.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/rng.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flirt {

std::vector<std::vector<std::uint32_t>> bootstrap_draws(std::size_t cases, std::size_t draws, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<std::vector<std::uint32_t>> rows(draws, std::vector<std::uint32_t>(cases));
  for (auto& row : rows) {
    for (std::uint32_t& index : row) { index = rng.below(static_cast<std::uint32_t>(cases)); }
  }
  return rows;
}

Interval middle_95(const std::vector<double>& values) {
  return {quantile(values, 0.025), quantile(values, 0.975)};
}

Mean bootstrap_mean(std::span<const double> values, std::uint64_t seed, std::size_t draws) {
  std::vector<std::uint32_t> block(values.size());
  std::iota(block.begin(), block.end(), 0U);
  return block_bootstrap_mean(block, values, seed, draws);
}

Mean bootstrap_difference(std::span<const double> a, std::span<const double> b, std::uint64_t seed, std::size_t draws) {
  FLIRT_ASSERT(a.size() == b.size());
  std::vector<double> differences;
  differences.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) { differences.push_back(a[i] - b[i]); }
  return bootstrap_mean(differences, seed, draws);
}

Mean block_bootstrap_mean(std::span<const std::uint32_t> block, std::span<const double> values, std::uint64_t seed,
                          std::size_t draws) {
  FLIRT_ASSERT(block.size() == values.size());
  struct Sum {
    double value{0};
    std::size_t cases{0};
  };
  std::vector<Sum> blocks;
  Sum all;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) { continue; }
    blocks.resize(std::max<std::size_t>(blocks.size(), block[i] + 1));
    for (Sum* sum : {&blocks[block[i]], &all}) {
      sum->value += values[i];
      ++sum->cases;
    }
  }
  std::erase_if(blocks, [](const Sum& sum) { return sum.cases == 0; });
  if (blocks.empty()) { return {}; }

  Rng rng(seed);
  std::vector<double> means;
  means.reserve(draws);
  for (std::size_t draw = 0; draw < draws; ++draw) {
    Sum sum;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const Sum& picked = blocks[rng.below(static_cast<std::uint32_t>(blocks.size()))];
      sum.value += picked.value;
      sum.cases += picked.cases;
    }
    means.push_back(sum.value / static_cast<double>(sum.cases));
  }
  return {all.value / static_cast<double>(all.cases), middle_95(means), all.cases};
}

}  // namespace flirt
