#include "flirt/arena/glarot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace flirt {
namespace {

constexpr std::ptrdiff_t kernel_reach = 3;  // bins, of standard deviation 1

/// The Gaussian of all offsets, u by v.
std::array<std::array<double, 2 * kernel_reach + 1>, 2 * kernel_reach + 1> kernel() {
  std::array<std::array<double, 2 * kernel_reach + 1>, 2 * kernel_reach + 1> values{};
  for (std::ptrdiff_t u = -kernel_reach; u <= kernel_reach; ++u) {
    for (std::ptrdiff_t v = -kernel_reach; v <= kernel_reach; ++v) {
      values[static_cast<std::size_t>(u + kernel_reach)][static_cast<std::size_t>(v + kernel_reach)] =
          std::exp(-static_cast<double>(u * u + v * v) / 2);
    }
  }
  return values;
}

/// L1 distance of all rows of a to those of b `shift` further on; stops when it cannot be below `give_up`.
double distance_at(const GlarotSignature& a, const GlarotSignature& b, std::uint32_t shift, double give_up) {
  double sum = 0;
  for (std::uint32_t u = 0; u < a.directions && sum < give_up; ++u) {
    const float* row = a.bins.data() + std::size_t{u} * a.distances;
    const float* other = b.bins.data() + std::size_t{(u + shift) % a.directions} * a.distances;
    std::array<float, 16> parts{};  // as many sums as the widest vectors hold: the same order on all of them
    std::uint32_t v = 0;
    for (; v + parts.size() <= a.distances; v += static_cast<std::uint32_t>(parts.size())) {
      for (std::size_t k = 0; k < parts.size(); ++k) { parts[k] += std::abs(row[v + k] - other[v + k]); }
    }
    for (; v < a.distances; ++v) { parts[0] += std::abs(row[v] - other[v]); }
    for (const float part : parts) { sum += double{part}; }
  }
  return sum;
}

}  // namespace

GlarotSignature glarot_signature(std::span<const Point2> keypoints, const GlarotParams& params) {
  GlarotSignature signature{.directions = params.directions, .distances = params.distances};
  if (keypoints.size() < params.min_keypoints) { return signature; }
  const auto directions = static_cast<std::ptrdiff_t>(params.directions);
  const auto distances = static_cast<std::ptrdiff_t>(params.distances);
  std::vector<double> bins(std::size_t{params.directions} * params.distances);
  const auto weights = kernel();
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    for (std::size_t j = i + 1; j < keypoints.size(); ++j) {
      const Point2 along = keypoints[j] - keypoints[i];
      const double bin = std::round(norm(along) / params.distance_step);
      if (!(bin < params.distances)) { continue; }
      double direction = std::atan2(along.y, along.x);
      if (direction < 0) { direction += std::numbers::pi; }
      const std::ptrdiff_t u = std::lround(direction * params.directions / std::numbers::pi) % directions;
      const auto v = static_cast<std::ptrdiff_t>(bin);
      for (std::ptrdiff_t du = -kernel_reach; du <= kernel_reach; ++du) {
        const std::ptrdiff_t row = (((u + du) % directions) + directions) % directions;
        for (std::ptrdiff_t dv = std::max(-kernel_reach, -v); dv <= kernel_reach && v + dv < distances; ++dv) {
          bins[static_cast<std::size_t>(row * distances + v + dv)] +=
              weights[static_cast<std::size_t>(du + kernel_reach)][static_cast<std::size_t>(dv + kernel_reach)];
        }
      }
    }
  }
  const double largest = bins.empty() ? 0.0 : *std::ranges::max_element(bins);
  for (const double bin : bins) { signature.bins.push_back(static_cast<float>(largest > 0 ? bin / largest : 0.0)); }
  return signature;
}

GlarotDistance glarot_distance(const GlarotSignature& a, const GlarotSignature& b) {
  GlarotDistance best{.value = std::numeric_limits<double>::infinity()};
  if (a.bins.empty() || b.bins.size() != a.bins.size()) { return best; }
  for (std::uint32_t shift = 0; shift < a.directions; ++shift) {
    const double distance = distance_at(a, b, shift, best.value);
    if (!(distance < best.value)) { continue; }
    best = {distance, shift * std::numbers::pi / a.directions};
  }
  return best;
}

}  // namespace flirt
