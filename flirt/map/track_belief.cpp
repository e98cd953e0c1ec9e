#include "flirt/map/track_belief.hpp"

#include "flirt/map/verdict.hpp"

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

/// How much of an independent look a scan is after this motion: nothing new is seen from the same place. That holds for
/// what speaks for the place; a place that fits no longer though the wheels stood still is one the robot was carried
/// from.
double novelty(const Pose2& before_from_after, const BeliefParams& params) {
  const double way = norm(before_from_after.translation()) / params.new_way;
  const double turn = std::abs(before_from_after.theta) / params.new_turn;
  return std::min(1.0, way + turn);
}

}  // namespace

double log_odds_of_look(const EvidenceScore& score, std::size_t points, const BeliefParams& params) {
  const double log_odds = params.offset + params.strength * evidence_strength(score, points) +
                          params.unknown * score.unknown + params.through * score.through;
  return std::clamp(log_odds, -params.largest_look, params.largest_look);
}

void TrackBelief::start(double confidence) {
  probability_ = std::min(confidence, params_.largest_start);
}

void TrackBelief::look(const EvidenceScore& score, std::size_t points, const Pose2& before_from_after) {
  const double share = novelty(before_from_after, params_);
  const double stayed = probability_ * (1 - params_.leave * share) + (1 - probability_) * params_.arrive * share;
  const double log_odds = points == 0 ? 0.0 : log_odds_of_look(score, points, params_);
  const double ratio = std::exp(log_odds > 0 ? share * log_odds : log_odds);
  probability_ = stayed * ratio / (stayed * ratio + 1 - stayed);
}

}  // namespace flirt
