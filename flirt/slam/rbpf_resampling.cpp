#include "flirt/slam/rbpf_resampling.hpp"

#include <algorithm>
#include <cmath>

namespace flirt {

std::vector<double> normalized_weights(std::span<const double> log_weights) {
  std::vector<double> weights;
  if (log_weights.empty()) { return weights; }
  const double top = std::ranges::max(log_weights);
  double sum = 0;
  for (const double log_weight : log_weights) {
    weights.push_back(std::exp(log_weight - top));
    sum += weights.back();
  }
  for (double& weight : weights) { weight /= sum; }
  return weights;
}

double effective_particles(std::span<const double> weights) {
  double squares = 0;
  for (const double weight : weights) { squares += weight * weight; }
  return 1 / squares;
}

std::vector<std::size_t> low_variance_draw(std::span<const double> weights, double start) {
  std::vector<std::size_t> parents;
  const auto n = static_cast<double>(weights.size());
  double cumulated = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    cumulated += weights[i];
    const bool last = i + 1 == weights.size();  // rounding leaves the sum of weights a little off 1
    while (parents.size() < weights.size() && (last || (static_cast<double>(parents.size()) + start) / n < cumulated)) {
      parents.push_back(i);
    }
  }
  return parents;
}

}  // namespace flirt
