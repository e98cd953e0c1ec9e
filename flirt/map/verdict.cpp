#include "flirt/map/verdict.hpp"

#include <algorithm>
#include <cmath>

namespace flirt {

double evidence_strength(const EvidenceScore& score, std::size_t points) {
  constexpr double usual_points = 80;
  return score.total * std::sqrt(static_cast<double>(points) / usual_points);
}

std::size_t points_of_evidence(const ScanPoints& points, const VerdictParams& params) {
  const auto own = static_cast<double>(std::ranges::count_if(points.range, [](float range) { return range > 0; }));
  const double joined = static_cast<double>(points.size()) - own;
  return static_cast<std::size_t>(own + params.joined_points * joined);
}

double confidence_of(std::span<const ScoredPose> distinct_poses, std::size_t points, const VerdictParams& params) {
  const EvidenceScore& first = distinct_poses[0].score;
  double margin = params.largest_margin;
  if (distinct_poses.size() > 1) { margin = std::min(margin, first.preference - distinct_poses[1].score.preference); }
  const double log_odds = params.offset + params.margin * std::sqrt(std::max(0.0, margin)) +
                          params.strength * evidence_strength(first, points) + params.unknown * first.unknown +
                          params.through * first.through;
  return 1 / (1 + std::exp(-log_odds));
}

Judgement judge_answer(std::span<const ScoredPose> distinct_poses, std::size_t points, const VerdictParams& params) {
  if (distinct_poses.empty()) { return {}; }
  const double confidence = confidence_of(distinct_poses, points, params);
  const EvidenceScore& first = distinct_poses[0].score;
  const bool twin =
      distinct_poses.size() > 1 && first.preference - distinct_poses[1].score.preference < params.min_margin;
  if (points < params.min_points) { return {Verdict::lost, Reason::few_points, confidence}; }
  if (first.total < params.min_score) { return {Verdict::lost, why_not(first), confidence}; }
  if (confidence >= params.min_confidence && !twin) { return {Verdict::unique, Reason::clear_winner, confidence}; }
  const bool sure_alone = confidence_of(distinct_poses.first(1), points, params) >= params.min_confidence;
  return {Verdict::ambiguous, twin || sure_alone ? Reason::second_place_too_close : Reason::little_evidence,
          confidence};
}

Reason why_not(const EvidenceScore& score) {
  if (score.unknown > 0.5) { return Reason::outside_map; }
  const double contradicted = score.free + score.through;
  const double unexplained = 1 - score.likelihood - score.free;
  return contradicted > std::max(0.2, unexplained) ? Reason::contradicted_by_free_space : Reason::poor_fit;
}

std::vector<double> weights_of(std::span<const ScoredPose> distinct_poses, const VerdictParams& params) {
  std::vector<double> weights;
  weights.reserve(distinct_poses.size());
  double sum = 0;
  for (const ScoredPose& pose : distinct_poses) {
    weights.push_back(std::exp(params.pair_odds * (pose.score.preference - distinct_poses[0].score.preference)));
    sum += weights.back();
  }
  for (double& weight : weights) { weight /= sum; }
  return weights;
}

}  // namespace flirt
