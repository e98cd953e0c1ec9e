#include "flirt/map/hypotheses.hpp"

#include <algorithm>
#include <cstddef>

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
  for (std::uint32_t i = 0; i < sorted.size(); ++i) {
    const Hypothesis& hypothesis = sorted[i];
    auto place = std::find_if(places.begin(), places.end(), [&](const Place& candidate) {
      const Pose2& founder = sorted[candidate.hypothesis].map_from_sensor;
      return distance(founder, hypothesis.map_from_sensor) <= max_distance &&
             heading_difference(founder, hypothesis.map_from_sensor) <= max_heading;
    });
    if (place == places.end()) { place = places.insert(place, {.hypothesis = i}); }
    place->support += 1;
    place->inliers = std::max(place->inliers, hypothesis.inliers);
    place->weight += hypothesis.weight;
  }
  return places;
}

}  // namespace flirt
