// flirt/eval/bootstrap.hpp: intervals by drawing cases again, with replacement.
#pragma once

#include "flirt/eval/statistics.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// Row d: the `cases` indices of draw d. Equal arguments give equal draws, so that two methods can be compared on the
/// same cases, draw by draw.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> bootstrap_draws(std::size_t cases, std::size_t draws,
                                                                      std::uint64_t seed);

/// The middle 95 % of the values; [0, 0] for none.
[[nodiscard]] Interval middle_95(const std::vector<double>& values);

/// A mean over cases with its 95 % bootstrap interval.
struct Mean {
  double value{0};
  Interval interval{};
  std::size_t cases{0};  ///< that had a value
};

/// Mean of the finite values, one per case: other cases do not count. Without any: 0, interval [0, 0].
/// O(draws · cases).
[[nodiscard]] Mean bootstrap_mean(std::span<const double> values, std::uint64_t seed, std::size_t draws = 1000);

/// Mean of a[i] − b[i] over the cases where both are finite: zero outside of the interval means a difference.
[[nodiscard]] Mean bootstrap_difference(std::span<const double> a, std::span<const double> b, std::uint64_t seed,
                                        std::size_t draws = 1000);

/// The same mean, but whole blocks are drawn: neighbours are not independent. block[i] numbers the block of value i.
[[nodiscard]] Mean block_bootstrap_mean(std::span<const std::uint32_t> block, std::span<const double> values,
                                        std::uint64_t seed, std::size_t draws = 1000);

}  // namespace flirt
