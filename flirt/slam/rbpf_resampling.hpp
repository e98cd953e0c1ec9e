// flirt/slam/rbpf_resampling.hpp: which particles live on.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace flirt {

/// Weights of sum 1 from their logs (up to a common constant). Empty for none.
[[nodiscard]] std::vector<double> normalized_weights(std::span<const double> log_weights);

/// 1 / Σ w²: n for n equal weights, 1 when one has it all (Doucet's measure; equation 20). `weights` sum to 1.
[[nodiscard]] double effective_particles(std::span<const double> weights);

/// For each new particle the old one that it continues, ascending: i/n + start/n, i = 0 …, on the cumulated weights,
/// with `start` in [0, 1). An old one of weight w is continued ⌊n w⌋ or ⌈n w⌉ times. (Low-variance resampling.)
[[nodiscard]] std::vector<std::size_t> low_variance_draw(std::span<const double> weights, double start);

}  // namespace flirt
