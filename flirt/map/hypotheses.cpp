#include "flirt/map/hypotheses.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

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

/// Places by where their founders are, so that a pose meets those nearby alone: cells, hashed into chains.
class FounderGrid {
 public:
  /// Poses farther than `reach` (m) from a founder need not meet it. `founders`: about as many as there may be.
  FounderGrid(double reach, std::size_t founders)
      : reach_(reach * (1.0 + 1e-9) + 1e-6), per_metre_(0.5 / reach_), chains_(std::bit_ceil(2 * founders + 1)) {
    links_.reserve(4 * founders);
  }

  void add(const Pose2& founder, std::uint32_t place) {
    for (std::int64_t x = cell(founder.x - reach_); x <= cell(founder.x + reach_); ++x) {  // two cells at most
      for (std::int64_t y = cell(founder.y - reach_); y <= cell(founder.y + reach_); ++y) {
        Chain& chain = chains_[chain_of(x, y)];
        const auto link = static_cast<std::uint32_t>(links_.size());
        links_.push_back({place, none});
        (chain.first == none ? chain.first : links_[chain.last].next) = link;
        chain.last = link;
      }
    }
  }

  /// Of the places within reach of `pose`, the first added for which `says_same(place)`. It also meets some others,
  /// those of cells with the same hash.
  template <class Predicate>
  [[nodiscard]] std::optional<std::uint32_t> find(const Pose2& pose, const Predicate& says_same) const {
    const Chain& chain = chains_[chain_of(cell(pose.x), cell(pose.y))];
    for (std::uint32_t link = chain.first; link != none; link = links_[link].next) {
      if (says_same(links_[link].place)) { return links_[link].place; }
    }
    return std::nullopt;
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  struct Link {
    std::uint32_t place;
    std::uint32_t next;
  };
  struct Chain {
    std::uint32_t first{none};
    std::uint32_t last{none};
  };

  /// Rounded down, which a conversion is for positive numbers.
  [[nodiscard]] std::int64_t cell(double position) const {
    constexpr std::int64_t far_away = std::int64_t{1} << 40U;
    return static_cast<std::int64_t>(position * per_metre_ + static_cast<double>(far_away));
  }
  [[nodiscard]] std::size_t chain_of(std::int64_t x, std::int64_t y) const {
    const auto mixed =
        (static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15U) ^ (static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FU);
    return (mixed >> 32U) & (chains_.size() - 1);
  }

  double reach_;
  double per_metre_;
  std::vector<Chain> chains_;
  std::vector<Link> links_{};
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
  FounderGrid grid(max_distance, sorted.size());
  for (std::uint32_t i = 0; i < sorted.size(); ++i) {
    const Hypothesis& hypothesis = sorted[i];
    const auto says_same = [&](std::uint32_t place) {
      const Pose2& founder = sorted[places[place].hypothesis].map_from_sensor;
      return distance(founder, hypothesis.map_from_sensor) <= max_distance &&
             heading_difference(founder, hypothesis.map_from_sensor) <= max_heading;
    };
    const std::optional<std::uint32_t> found = grid.find(hypothesis.map_from_sensor, says_same);
    const std::uint32_t index = found.value_or(static_cast<std::uint32_t>(places.size()));
    if (!found) {
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
