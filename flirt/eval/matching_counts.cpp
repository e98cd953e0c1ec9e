#include "flirt/eval/matching_counts.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

namespace flirt {
namespace {

/// Beyond which no match is of interest.
double largest_threshold(Distance distance) {
  switch (distance) {
    case Distance::euclidean:
      return std::numbers::sqrt2;
    case Distance::bhattacharyya:
    case Distance::kullback_leibler:
      return 5.0;
    case Distance::chi_square:
    case Distance::variance_chi_square:
    case Distance::hellinger:
    case Distance::jensen_shannon:
      return 1.0;
  }
  return 1.0;
}

class Thresholds {
 public:
  explicit Thresholds(Distance distance) {
    for (std::size_t k = 0; k < threshold_count; ++k) { edges_[k] = distance_threshold(distance, k); }
  }
  /// Number of the first threshold above the distance.
  [[nodiscard]] std::size_t first_above(double distance) const {
    const auto* const edge = std::upper_bound(edges_.begin(), edges_.end() - 1, distance);
    return static_cast<std::size_t>(edge - edges_.begin());
  }

 private:
  std::array<double, threshold_count> edges_{};
};

}  // namespace

double distance_threshold(Distance distance, std::size_t k) {
  if (k + 1 == threshold_count) { return std::numeric_limits<double>::infinity(); }
  const double share = static_cast<double>(k + 1) / static_cast<double>(threshold_count - 1);
  return largest_threshold(distance) * share * share;
}

MatchingCounts& MatchingCounts::operator+=(const MatchingCounts& other) {
  for (std::size_t k = 0; k < threshold_count; ++k) {
    matches[k] += other.matches[k];
    correct[k] += other.correct[k];
  }
  correspondences += other.correspondences;
  return *this;
}

MatchingCounts count_matches(std::span<const float> distances, std::size_t others,
                             std::span<const RegionPair> overlapping, Distance distance, PairRule rule) {
  MatchingCounts counts;
  if (others == 0) { return counts; }
  FLIRT_ASSERT(distances.size() % others == 0);
  const Thresholds thresholds(distance);
  const auto add = [&](std::size_t i, std::size_t j, bool right) {
    const std::size_t k = thresholds.first_above(distances[i * others + j]);
    ++counts.matches[k];
    counts.correct[k] += right ? 1 : 0;
  };
  std::vector<char> right(distances.size());
  for (const RegionPair& pair : overlapping) { right[pair.reference * others + pair.other] = 1; }
  for (std::size_t i = 0; i < distances.size() / others; ++i) {
    const auto row = distances.subspan(i * others, others);
    const auto right_row = std::span<const char>(right).subspan(i * others, others);
    if (rule == PairRule::nearest) {
      counts.correspondences += std::any_of(right_row.begin(), right_row.end(), [](char r) { return r != 0; }) ? 1 : 0;
      const auto j = static_cast<std::size_t>(std::min_element(row.begin(), row.end()) - row.begin());
      add(i, j, right_row[j] != 0);
      continue;
    }
    for (std::size_t j = 0; j < others; ++j) {
      counts.correspondences += right_row[j] != 0 ? 1 : 0;
      add(i, j, right_row[j] != 0);
    }
  }
  return counts;
}

std::vector<MatchingPoint> matching_curve(const MatchingCounts& counts) {
  std::vector<MatchingPoint> curve;
  double matches = 0;
  double correct = 0;
  for (std::size_t k = 0; k < threshold_count; ++k) {
    matches += counts.matches[k];
    correct += counts.correct[k];
    if (counts.matches[k] == 0 || counts.correspondences == 0) { continue; }
    curve.push_back({k, correct / matches, correct / counts.correspondences});
  }
  return curve;
}

double average_precision(const MatchingCounts& counts) {
  double area = 0;
  double previous = 0;
  for (const MatchingPoint& point : matching_curve(counts)) {
    area += (point.recall - previous) * point.precision;
    previous = point.recall;
  }
  return area;
}

}  // namespace flirt
