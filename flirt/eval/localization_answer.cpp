#include "flirt/eval/localization_answer.hpp"

#include "flirt/eval/coverage.hpp"

#include <cmath>
#include <limits>

namespace flirt {

bool is_within(const Pose2& pose, const Pose2& truth, double max_distance, double max_heading) {
  return distance(pose, truth) <= max_distance && heading_difference(pose, truth) <= max_heading;
}

LocalizationAnswer answer_of(const LocalizationResult& result, const PlaceMap& map, std::size_t query,
                             ScanInterval excluded) {
  LocalizationAnswer answer{
      .query = query, .strategy = "localize", .verdict = to_string(result.verdict), .reason = to_string(result.reason)};
  const PoseHypothesis* best = result.best();
  if (best == nullptr) { return answer; }
  answer.answered = true;
  answer.reference = nearest_scan(map, best->map_from_sensor, excluded).value_or(0);
  answer.map_from_sensor = best->map_from_sensor;
  answer.confidence = result.confidence;
  answer.points = result.points;
  answer.evidence = best->evidence;
  answer.margin =
      result.hypotheses.size() > 1 ? best->score - result.hypotheses[1].score : std::numeric_limits<double>::infinity();
  if (result.solution_set) {
    answer.inliers = result.solution_set->best()->inliers;
    answer.residual = result.solution_set->best()->residual;
  } else {
    answer.inliers = static_cast<std::uint32_t>(std::lround(best->evidence.near * result.points));
    answer.residual = best->evidence.residual;
  }
  return answer;
}

void compare_with_truth(LocalizationAnswer& answer, const LocalizationResult& result, const Pose2& truth,
                        const PoseTolerance& tolerance) {
  const PoseHypothesis* best = result.best();
  if (best == nullptr) { return; }
  answer.correct = is_within(best->map_from_sensor, truth, tolerance.correct_distance, tolerance.correct_heading);
  answer.precise = is_within(best->map_from_sensor, truth, tolerance.precise_distance, tolerance.precise_heading);
  answer.nees = normalized_squared_error(best->map_from_sensor, truth, best->covariance);
}

}  // namespace flirt
