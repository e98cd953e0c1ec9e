#include "flirt/features/selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace flirt {
namespace {

Point2 point_of(const ScanCurve& curve, const Candidate& candidate) {
  return {curve.x[candidate.point], curve.y[candidate.point]};
}

}  // namespace

std::uint32_t foreground_point(const ScanCurve& curve, std::uint32_t peak, double jump) {
  const auto n = static_cast<std::uint32_t>(curve.size());
  const std::uint32_t after = peak + 1 < n ? peak + 1 : 0;
  const std::uint32_t before = peak > 0 ? peak - 1 : n - 1;
  std::uint32_t nearest = peak;
  for (const std::uint32_t other : {after, before}) {
    if (other != peak && curve.adjacent(peak, other) && curve.hit[other] &&
        curve.ranges[other] < curve.ranges[nearest] && curve.ranges[peak] - curve.ranges[other] > jump) {
      nearest = other;
    }
  }
  return nearest;
}

void drop_duplicates(const ScanCurve& curve, const SelectionParams& params, DuplicateWork& work,
                     std::vector<Candidate>& candidates) {
  auto& [order, kept_points] = work;
  order.resize(candidates.size());
  std::iota(order.begin(), order.end(), 0U);
  if (params.precedence == Precedence::response) {
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
      const Candidate& left = candidates[a];
      const Candidate& right = candidates[b];
      if (left.level != right.level) { return left.level < right.level; }
      const double difference = std::abs(left.response) - std::abs(right.response);
      return difference != 0.0 ? difference > 0.0 : a < b;
    });
  }
  const double squared_radius = params.duplicate_radius * params.duplicate_radius;
  std::size_t kept = 0;  // order[0] .. order[kept − 1] stay
  kept_points.clear();
  for (const std::uint32_t index : order) {
    const Candidate& candidate = candidates[index];
    const Point2 point = point_of(curve, candidate);
    bool duplicate = false;  // no early end: the kept ones are few, and where one lies cannot be foreseen
    for (const Point2& other : kept_points) { duplicate |= squared_norm(point - other) < squared_radius; }
    if (!(squared_radius > 0.0)) {
      duplicate = std::any_of(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), [&](auto i) {
        return candidates[i].point == candidate.point && candidates[i].level == candidate.level;
      });
    }
    if (duplicate) { continue; }
    order[kept++] = index;
    kept_points.push_back(point);
  }
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept));
  for (std::size_t i = 0; i < kept; ++i) { candidates[i] = candidates[order[i]]; }  // order[i] ≥ i
  candidates.resize(kept);
}

}  // namespace flirt
