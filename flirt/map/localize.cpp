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

/// The end points of a scan without those on legs; and, should that not be enough to tell where it is, with them, where
/// they are few.
std::vector<ScanPoints> readings_of(const Scan& scan, const LocalizeParams& params) {
  ScanPointParams all = params.search.points;
  all.leg_width = 0;
  std::vector<ScanPoints> readings{scan_points(scan, params.search.points)};
  ScanPoints with_legs = scan_points(scan, all);
  const auto on_legs = static_cast<double>(with_legs.size()) - static_cast<double>(readings.front().size());
  if (on_legs > 0 && on_legs < params.few_legs * static_cast<double>(with_legs.size())) {
    readings.push_back(std::move(with_legs));
  }
  return readings;
}

/// The distinct ones of some poses, best first, and what they say.
struct Answer {
  std::vector<ScoredPose> poses;
  Judgement judgement;
};

/// Should no place be unique, narrow things may have been moved, and all are compared again as if they had been: of the
/// two answers the more confident one holds.
Answer answer_from(std::vector<ScoredPose> judged, std::size_t points, const LocalizeParams& params) {
  Answer answer{distinct(judged, params.search), {}};
  answer.judgement = judge_answer(answer.poses, points, params.verdict);
  if (answer.judgement.verdict == Verdict::unique) { return answer; }
  for (ScoredPose& pose : judged) { pose.score = if_things_moved(pose.score, params.search.score); }
  Answer other{distinct(std::move(judged), params.search), {}};
  other.judgement = judge_answer(other.poses, points, params.verdict);
  return other.judgement.confidence > answer.judgement.confidence ? other : answer;
}

/// Where the end points fit, near `places` or, without them, anywhere.
LocalizationResult answer_of(const MapFields& fields, const ScanPoints& points,
                             const std::optional<std::vector<Pose2>>& places, const LocalizeParams& params,
                             LocalizeTimes& times) {
  Stopwatch stopwatch;
  const std::vector<CoarsePose> coarse = places ? dense_search_near(fields, points, *places, params.search.dense)
                                                : dense_search(fields, points, params.search.dense);
  times.search_us += stopwatch.lap_us();
  const std::vector<Pose2> promising = finalists(fields, points, coarse, params.search);
  times.rank_us += stopwatch.lap_us();
  const auto [poses, judgement] =
      answer_from(judge(fields, points, promising, params.search), points_of_evidence(points, params.verdict), params);
  LocalizationResult result{.verdict = judgement.verdict,
                            .reason = judgement.reason,
                            .confidence = judgement.confidence,
                            .hypotheses = hypotheses_of(poses, params.verdict),
                            .points = static_cast<std::uint32_t>(points.size())};
  times.refine_us += stopwatch.lap_us();
  return result;
}

}  // namespace

Localizer::Localizer(const PlaceMap& map, const LocalizeParams& params, std::size_t threads)
    : map_(map),
      params_(params),
      detector_(map.feature_params().detector),
      describer_(map.feature_params().descriptor),
      evidence_(map, params.fields),
      finder_(map, params.papers, threads) {}

bool Localizer::votes_needed(const MapFields& fields) const {
  return params_.method == LocalizeMethod::features ||
         (params_.method == LocalizeMethod::automatic && fields.searched_area() > params_.largest_dense);
}

/// Where keypoints vote for.
std::vector<Pose2> Localizer::voted_places(const Scan& scan, ScanInterval excluded, LocalizeTimes& times) {
  Stopwatch stopwatch;
  if (!landmarks_ || excluded_ != excluded) {
    landmarks_.emplace(map_, params_.landmarks, excluded);
    excluded_ = excluded;
  }
  times.prepare_us += stopwatch.lap_us();
  const Features features = features_of(scan, times);
  stopwatch.lap_us();
  std::vector<Pose2> places = landmarks_->vote(features);
  times.match_us = stopwatch.lap_us();
  return places;
}

/// The most confident answer of the readings, which are asked in turn until one is unique.
LocalizationResult Localizer::by_evidence(const Scan& scan, std::span<const ScanPoints> readings, ScanInterval excluded,
                                          LocalizeTimes& times) {
  Stopwatch stopwatch;
  const MapFields& fields = evidence_.fields(excluded);
  times.prepare_us = stopwatch.lap_us();
  if (fields.empty()) { return {.reason = Reason::empty_map}; }
  std::optional<std::vector<Pose2>> places;
  if (votes_needed(fields)) { places = voted_places(scan, excluded, times); }
  LocalizationResult best = answer_of(fields, readings.front(), places, params_, times);
  for (const ScanPoints& points : readings.subspan(1)) {
    if (best.verdict == Verdict::unique) { break; }
    LocalizationResult other = answer_of(fields, points, places, params_, times);
    if (other.confidence > best.confidence) { best = std::move(other); }
  }
  return best;
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
                                  : by_evidence(scan, readings_of(scan, params_), excluded, taken);
  if (times != nullptr) { *times = taken; }
  return result;
}

LocalizationResult Localizer::localize_points(const Scan& scan, const ScanPoints& points, ScanInterval excluded,
                                              LocalizeTimes* times) {
  LocalizeTimes taken;
  LocalizationResult result = by_evidence(scan, {&points, 1}, excluded, taken);
  if (times != nullptr) { *times = taken; }
  return result;
}

LocalizationResult localize(const PlaceMap& map, const Scan& scan, const LocalizeParams& params, LocalizeTimes* times) {
  return Localizer(map, params).localize(scan, {}, times);
}

}  // namespace flirt
