#include "flirt/map/localize.hpp"

#include "flirt/core/stopwatch.hpp"

#include <span>

namespace flirt {
namespace {

std::vector<PoseHypothesis> hypotheses_of(std::span<const ScoredPose> poses, const VerdictParams& params) {
  const std::vector<double> weights = weights_of(poses, params);
  std::vector<PoseHypothesis> hypotheses;
  hypotheses.reserve(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    hypotheses.push_back({.map_from_sensor = poses[i].map_from_sensor,
                          .covariance = poses[i].covariance,
                          .score = poses[i].score.preference,
                          .weight = weights[i],
                          .evidence = poses[i].score});
  }
  return hypotheses;
}

/// The places of a solution set, each with the pose of its best match.
std::vector<PoseHypothesis> hypotheses_of(const SolutionSet& set) {
  std::vector<PoseHypothesis> hypotheses;
  hypotheses.reserve(set.places.size());
  for (const Place& place : set.places) {
    const Hypothesis& best = set.hypotheses[place.hypothesis];
    hypotheses.push_back({.map_from_sensor = best.map_from_sensor,
                          .covariance = best.covariance,
                          .score = best.score,
                          .weight = place.weight});
  }
  return hypotheses;
}

}  // namespace

Localizer::Localizer(const PlaceMap& map, const LocalizeParams& params, std::size_t threads)
    : map_(map),
      params_(params),
      detector_(map.feature_params().detector),
      describer_(map.feature_params().descriptor),
      evidence_(map, params.fields),
      finder_(map, params.papers, threads) {}

std::vector<CoarsePose> Localizer::candidates(const MapFields& fields, const Scan& scan, const ScanPoints& points,
                                              LocalizeTimes& times) {
  Stopwatch stopwatch;
  if (!votes_needed(fields)) {
    std::vector<CoarsePose> coarse = dense_search(fields, points, params_.search.dense);
    times.search_us = stopwatch.lap_us();
    return coarse;
  }
  const Features features = features_of(scan, times);
  stopwatch.lap_us();
  const std::vector<Pose2> places = landmarks_->vote(features);
  times.match_us = stopwatch.lap_us();
  std::vector<CoarsePose> coarse = dense_search_near(fields, points, places, params_.search.dense);
  times.search_us = stopwatch.lap_us();
  return coarse;
}

bool Localizer::votes_needed(const MapFields& fields) const {
  return params_.method == LocalizeMethod::features ||
         (params_.method == LocalizeMethod::automatic && fields.searched_area() > params_.largest_dense);
}

LocalizationResult Localizer::by_evidence(const Scan& scan, const ScanPoints& points, ScanInterval excluded,
                                          LocalizeTimes& times) {
  Stopwatch stopwatch;
  const MapFields& fields = evidence_.fields(excluded);
  if (votes_needed(fields) && (!landmarks_ || excluded_ != excluded)) {
    landmarks_.emplace(map_, params_.landmarks, excluded);
    excluded_ = excluded;
  }
  times.prepare_us = stopwatch.lap_us();
  LocalizationResult result;
  if (fields.empty()) {
    result.reason = Reason::empty_map;
    return result;
  }
  result.points = static_cast<std::uint32_t>(points.size());
  const std::vector<CoarsePose> coarse = candidates(fields, scan, points, times);
  stopwatch.lap_us();
  const std::vector<Pose2> promising = finalists(fields, points, coarse, params_.search);
  times.rank_us = stopwatch.lap_us();
  const std::vector<ScoredPose> poses = distinct(judge(fields, points, promising, params_.search), params_.search);
  const Judgement judgement = judge_answer(poses, points.size(), params_.verdict);
  result.verdict = judgement.verdict;
  result.reason = judgement.reason;
  result.confidence = judgement.confidence;
  result.hypotheses = hypotheses_of(poses, params_.verdict);
  times.refine_us = stopwatch.lap_us();
  return result;
}

Features Localizer::features_of(const Scan& scan, LocalizeTimes& times) {
  Stopwatch stopwatch;
  const std::span<const Keypoint> keypoints = detector_.detect(scan);
  times.detect_us = stopwatch.lap_us();
  Features features{{keypoints.begin(), keypoints.end()}, describer_.describe(scan, keypoints)};
  times.describe_us = stopwatch.lap_us();
  return features;
}

LocalizationResult Localizer::by_papers(const Scan& scan, ScanInterval excluded, LocalizeTimes& times) {
  const Features features = features_of(scan, times);
  Stopwatch stopwatch;
  SolutionSet set = finder_.find(features, excluded);
  times.match_us = stopwatch.lap_us();
  return {.verdict = set.verdict,
          .reason = set.reason,
          .confidence = set.confidence,
          .hypotheses = hypotheses_of(set),
          .solution_set = std::move(set)};
}

LocalizationResult Localizer::localize(const Scan& scan, ScanInterval excluded, LocalizeTimes* times) {
  LocalizeTimes taken;
  LocalizationResult result = params_.method == LocalizeMethod::papers
                                  ? by_papers(scan, excluded, taken)
                                  : by_evidence(scan, scan_points(scan, params_.search.points), excluded, taken);
  if (times != nullptr) { *times = taken; }
  return result;
}

LocalizationResult Localizer::localize_points(const Scan& scan, const ScanPoints& points, ScanInterval excluded,
                                              LocalizeTimes* times) {
  LocalizeTimes taken;
  LocalizationResult result = by_evidence(scan, points, excluded, taken);
  if (times != nullptr) { *times = taken; }
  return result;
}

LocalizationResult localize(const PlaceMap& map, const Scan& scan, const LocalizeParams& params, LocalizeTimes* times) {
  return Localizer(map, params).localize(scan, {}, times);
}

}  // namespace flirt
