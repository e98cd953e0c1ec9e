#include "flirt/map/hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

namespace flirt {
namespace {

constexpr double smallest_residual = 1e-6;  // m²

bool is_better(const Hypothesis& a, const Hypothesis& b, HypothesisOrder order) {
  const bool by_inliers_first = order == HypothesisOrder::corresp;
  if (by_inliers_first && a.inliers != b.inliers) { return a.inliers > b.inliers; }
  if (a.residual != b.residual) { return a.residual < b.residual; }
  if (a.inliers != b.inliers) { return a.inliers > b.inliers; }
  return a.map_scan < b.map_scan;
}

/// Places by where their founders are, so that a pose meets those nearby alone.
class FounderGrid {
 public:
  /// Poses farther than `reach` (m) from a founder need not meet it.
  explicit FounderGrid(double reach) : reach_(reach * (1.0 + 1e-9) + 1e-6) {}

  void add(const Pose2& founder, std::uint32_t place) {
    for (std::int64_t x = cell(founder.x - reach_); x <= cell(founder.x + reach_); ++x) {  // two cells at most
      for (std::int64_t y = cell(founder.y - reach_); y <= cell(founder.y + reach_); ++y) {
        places_[key(x, y)].push_back(place);
      }
    }
  }

  /// All places within reach of `pose`, and some others, in the order in which they were added.
  [[nodiscard]] std::span<const std::uint32_t> near(const Pose2& pose) const {
    const auto found = places_.find(key(cell(pose.x), cell(pose.y)));
    return found == places_.end() ? std::span<const std::uint32_t>() : found->second;
  }

 private:
  [[nodiscard]] std::int64_t cell(double position) const {
    return static_cast<std::int64_t>(std::floor(position / (2.0 * reach_)));
  }
  /// Cells far apart may share a key: then a pose meets places in vain.
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    return static_cast<std::uint64_t>(x) << 32U ^ (static_cast<std::uint64_t>(y) & 0xFFFFFFFFU);
  }

  double reach_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> places_{};
};

}  // namespace

void set_weights(std::span<Hypothesis> hypotheses) {
  double sum = 0;
  for (Hypothesis& hypothesis : hypotheses) {
    hypothesis.weight = 1.0 / std::max(hypothesis.residual, smallest_residual);
    sum += hypothesis.weight;
  }
  for (Hypothesis& hypothesis : hypotheses) { hypothesis.weight /= sum; }
}

double score_from_residual(double residual, double inlier_distance) {
  constexpr double chi_square_95 = 5.99;  // two degrees of freedom
  return std::clamp(1.0 - residual / (chi_square_95 * inlier_distance * inlier_distance), 0.0, 1.0);
}

void sort_hypotheses(std::span<Hypothesis> hypotheses, HypothesisOrder order) {
  std::sort(hypotheses.begin(), hypotheses.end(),
            [order](const Hypothesis& a, const Hypothesis& b) { return is_better(a, b, order); });
}

std::vector<Place> distinct_places(std::span<const Hypothesis> sorted, double max_distance, double max_heading) {
  std::vector<Place> places;
  FounderGrid grid(max_distance);
  for (std::uint32_t i = 0; i < sorted.size(); ++i) {
    const Hypothesis& hypothesis = sorted[i];
    const std::span<const std::uint32_t> near = grid.near(hypothesis.map_from_sensor);
    const auto found = std::ranges::find_if(near, [&](std::uint32_t candidate) {
      const Pose2& founder = sorted[places[candidate].hypothesis].map_from_sensor;
      return distance(founder, hypothesis.map_from_sensor) <= max_distance &&
             heading_difference(founder, hypothesis.map_from_sensor) <= max_heading;
    });
    const auto index = found == near.end() ? static_cast<std::uint32_t>(places.size()) : *found;
    if (index == places.size()) {
      places.push_back({.hypothesis = i});
      grid.add(hypothesis.map_from_sensor, index);
    }
    Place& place = places[index];
    place.support += 1;
    place.inliers = std::max(place.inliers, hypothesis.inliers);
    place.weight += hypothesis.weight;
  }
  return places;
}

}  // namespace flirt
