#include "flirt/registration/search.hpp"

#include <algorithm>
#include <cstddef>

namespace flirt {

std::vector<ScoredPose> judge(const MapFields& fields, const ScanPoints& points, std::span<const Pose2> map_from_sensor,
                              const SearchParams& params) {
  constexpr double same_distance = 0.02;
  const double same_heading = radians_from_degrees(0.2);
  const EvidenceScorer scorer(fields, params.score);
  std::vector<ScoredPose> poses;
  for (const Pose2& start : map_from_sensor) {
    const RefinedPose refined = refine(fields, points, start, params.refine);
    const Pose2& pose = refined.map_from_sensor;
    const bool known = std::ranges::any_of(poses, [&](const ScoredPose& other) {
      return distance(pose, other.map_from_sensor) < same_distance &&
             heading_difference(pose, other.map_from_sensor) < same_heading;
    });
    if (known) { continue; }
    poses.push_back({pose, scorer.score(points, pose), refined.covariance, refined.support});
  }
  return poses;
}

std::vector<ScoredPose> distinct(std::vector<ScoredPose> poses, const SearchParams& params) {
  std::ranges::stable_sort(poses, std::ranges::greater{}, [](const ScoredPose& pose) { return pose.score.preference; });
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

std::vector<Pose2> ranked_candidates(const MapFields& fields, const ScanPoints& points,
                                     std::span<const CoarsePose> coarse, const SearchParams& params) {
  const EvidenceScorer scorer(fields, params.score);
  const std::size_t stride = (points.size() + params.ranking_rays - 1) / params.ranking_rays;
  struct Ranked {
    double value;
    std::size_t index;
  };
  const auto better = [](const Ranked& a, const Ranked& b) {
    return a.value != b.value ? a.value > b.value : a.index < b.index;
  };
  // The very best are kept whatever their rays say: a heading a degree off can send many beams through a door frame.
  // Coarse poses come best first, and rays only take value away: once a pose is worth less than the worst of a full
  // heap, so are all after it.
  const std::size_t sure = std::min<std::size_t>({params.unranked, params.refined, coarse.size()});
  std::vector<Ranked> best;
  for (std::size_t i = sure; i < coarse.size() && params.refined > sure; ++i) {
    const bool full = best.size() + sure == params.refined;
    if (full && coarse[i].value <= best.front().value) { break; }
    const double most_through = full ? (coarse[i].value - best.front().value) / params.ray_weight : 1.0;
    const double through = scorer.through(points, coarse[i].map_from_sensor, stride, most_through);
    const Ranked ranked{coarse[i].value - params.ray_weight * through, i};
    if (full && !better(ranked, best.front())) { continue; }
    if (full) {
      std::ranges::pop_heap(best, better);
      best.pop_back();
    }
    best.push_back(ranked);
    std::ranges::push_heap(best, better);
  }
  std::ranges::sort(best, better);
  std::vector<Pose2> poses;
  poses.reserve(sure + best.size());
  for (std::size_t i = 0; i < sure; ++i) { poses.push_back(coarse[i].map_from_sensor); }
  for (const Ranked& ranked : best) { poses.push_back(coarse[ranked.index].map_from_sensor); }
  return poses;
}

std::vector<ScoredPose> search(const MapFields& fields, const ScanPoints& points, const SearchParams& params) {
  const std::vector<CoarsePose> coarse = dense_search(fields, points, params.dense);
  return distinct(judge(fields, points, ranked_candidates(fields, points, coarse, params), params), params);
}

std::vector<ScoredPose> search(const MapFields& fields, const Scan& scan, const SearchParams& params) {
  return search(fields, scan_points(scan, params.points), params);
}

}  // namespace flirt
