#include "flirt/arena/point_matches.hpp"

namespace flirt {

std::vector<IndexPair> all_pairs(const PointSets& points) {
  std::vector<IndexPair> pairs;
  pairs.reserve(points.query.size() * points.reference.size());
  for (std::uint32_t q = 0; q < points.query.size(); ++q) {
    for (std::uint32_t r = 0; r < points.reference.size(); ++r) { pairs.push_back({q, r}); }
  }
  return pairs;
}

std::optional<Pose2> fit_pairs(const PointSets& points, std::span<const IndexPair> pairs) {
  std::vector<PointPair> matched;
  matched.reserve(pairs.size());
  for (const IndexPair& pair : pairs) {
    matched.push_back({points.query[pair.query], points.reference[pair.reference]});
  }
  const std::optional<RigidMotion> motion = fit_rigid(matched);
  return motion ? std::optional(motion->pose()) : std::nullopt;
}

double residual_of(const PointSets& points, const IndexPair& pair, const Pose2& reference_from_query) {
  return norm(points.reference[pair.reference] - reference_from_query * points.query[pair.query]);
}

}  // namespace flirt
