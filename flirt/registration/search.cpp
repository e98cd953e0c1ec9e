#include "flirt/registration/search.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace flirt {
namespace {

/// A pose on its way through the heats.
struct Runner {
  Pose2 map_from_sensor;
  double value{0};  ///< preference, as far as it is known
};

/// Every so many points, so that no more than `most` are left.
ScanPoints evenly_picked(const ScanPoints& points, std::size_t most) {
  const std::size_t stride = (points.size() + most - 1) / most;
  ScanPoints picked;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    picked.x.push_back(points.x[i]);
    picked.y.push_back(points.y[i]);
    picked.range.push_back(points.range[i]);
  }
  return picked;
}

/// All drawn a little closer, those before others whose end points agree with the map.
std::vector<Runner> after_heat(const MapFields& fields, const ScanPoints& points, const EvidenceScorer& scorer,
                               std::vector<Runner> runners, const SearchParams& params) {
  RefineParams few_steps = params.refine;
  few_steps.iterations = std::min(params.heat_steps, params.refine.iterations);
  for (Runner& runner : runners) {
    runner.map_from_sensor = refined_pose(fields, points, runner.map_from_sensor, few_steps);
    runner.value = scorer.score_of_end_points(points, runner.map_from_sensor).preference;
  }
  std::ranges::stable_sort(runners, std::ranges::greater{}, &Runner::value);
  return runners;
}

/// The `params.refined` best of the runners (best first) once beams count, too. These only take value away: what is
/// worth less than the worst of enough others need not be looked at.
std::vector<Runner> best_by_beams(const ScanPoints& points, const EvidenceScorer& scorer,
                                  std::span<const Runner> runners, const SearchParams& params) {
  const std::size_t stride = (points.size() + params.heat_rays - 1) / params.heat_rays;
  const double penalty = std::max(0.0, -params.score.preference.through);
  std::vector<Runner> best;
  for (Runner runner : runners) {
    const bool enough = best.size() == params.refined;
    if (enough && runner.value <= best.back().value) { break; }
    const double most = enough && penalty > 0 ? (runner.value - best.back().value) / penalty : 1.0;
    runner.value -= penalty * scorer.through(points, runner.map_from_sensor, stride, most);
    best.insert(std::ranges::upper_bound(best, runner.value, std::ranges::greater{}, &Runner::value), runner);
    if (best.size() > params.refined) { best.pop_back(); }
  }
  return best;
}

}  // namespace

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

std::vector<Pose2> finalists(const MapFields& fields, const ScanPoints& points, std::span<const CoarsePose> coarse,
                             const SearchParams& params) {
  const EvidenceScorer scorer(fields, params.score);
  std::vector<Runner> runners;
  runners.reserve(coarse.size());
  for (const CoarsePose& pose : coarse) { runners.push_back({pose.map_from_sensor, 0}); }
  runners = after_heat(fields, evenly_picked(points, params.first_heat_points), scorer, std::move(runners), params);
  if (runners.size() > params.second_heat) { runners.resize(params.second_heat); }
  runners = after_heat(fields, evenly_picked(points, params.second_heat_points), scorer, std::move(runners), params);
  std::vector<Pose2> poses;
  poses.reserve(params.refined);
  for (const Runner& runner : best_by_beams(points, scorer, runners, params)) {
    poses.push_back(runner.map_from_sensor);
  }
  return poses;
}

std::vector<ScoredPose> search(const MapFields& fields, const ScanPoints& points, const SearchParams& params) {
  const std::vector<CoarsePose> coarse = dense_search(fields, points, params.dense);
  return distinct(judge(fields, points, finalists(fields, points, coarse, params), params), params);
}

std::vector<ScoredPose> search(const MapFields& fields, const Scan& scan, const SearchParams& params) {
  return search(fields, scan_points(scan, params.points), params);
}

}  // namespace flirt
