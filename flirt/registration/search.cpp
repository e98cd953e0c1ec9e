#include "flirt/registration/search.hpp"

#include <algorithm>
#include <cstddef>

namespace flirt {

std::vector<ScoredPose> judge(const MapFields& fields, const ScanPoints& points, std::span<const Pose2> map_from_sensor,
                              const SearchParams& params) {
  const EvidenceScorer scorer(fields, params.score);
  std::vector<ScoredPose> poses;
  poses.reserve(map_from_sensor.size());
  for (const Pose2& start : map_from_sensor) {
    const RefinedPose refined = refine(fields, points, start, params.refine);
    poses.push_back(
        {refined.map_from_sensor, scorer.score(points, refined.map_from_sensor), refined.covariance, refined.support});
  }
  return poses;
}

std::vector<ScoredPose> distinct(std::vector<ScoredPose> poses, const SearchParams& params) {
  std::ranges::stable_sort(poses, std::ranges::greater{}, [](const ScoredPose& pose) { return pose.score.total; });
  std::vector<ScoredPose> kept;
  for (const ScoredPose& pose : poses) {
    const bool known = std::ranges::any_of(kept, [&](const ScoredPose& better) {
      return distance(pose.map_from_sensor, better.map_from_sensor) <= params.distinct_distance &&
             heading_difference(pose.map_from_sensor, better.map_from_sensor) <= params.distinct_heading;
    });
    if (!known) { kept.push_back(pose); }
  }
  return kept;
}

std::vector<Pose2> ranked_candidates(const MapFields& fields, const ScanPoints& points, const SearchParams& params) {
  const std::vector<CoarsePose> coarse = dense_search(fields, points, params.dense);
  const EvidenceScorer scorer(fields, params.score);
  struct Ranked {
    double value;
    std::size_t index;
  };
  std::vector<Ranked> ranked(coarse.size());
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    const double through = scorer.through(points, coarse[i].map_from_sensor, params.ray_stride);
    ranked[i] = {coarse[i].value - params.ray_weight * through, i};
  }
  const std::size_t count = std::min<std::size_t>(params.refined, ranked.size());
  std::ranges::partial_sort(
      ranked, ranked.begin() + static_cast<std::ptrdiff_t>(count),
      [](const Ranked& a, const Ranked& b) { return a.value != b.value ? a.value > b.value : a.index < b.index; });
  std::vector<Pose2> poses(count);
  for (std::size_t i = 0; i < count; ++i) { poses[i] = coarse[ranked[i].index].map_from_sensor; }
  return poses;
}

std::vector<ScoredPose> search(const MapFields& fields, const ScanPoints& points, const SearchParams& params) {
  return distinct(judge(fields, points, ranked_candidates(fields, points, params), params), params);
}

std::vector<ScoredPose> search(const MapFields& fields, const Scan& scan, const SearchParams& params) {
  return search(fields, scan_points(scan, params.points), params);
}

}  // namespace flirt
