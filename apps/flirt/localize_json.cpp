#include "apps/flirt/localize_json.hpp"

#include "apps/flirt/command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace flirt::app {

nlohmann::ordered_json pose_json(const Pose2& pose, const Eigen::Matrix3d& covariance) {
  std::vector<double> entries;
  entries.reserve(9);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) { entries.push_back(covariance(row, column)); }
  }
  return {{"x", pose.x}, {"y", pose.y}, {"theta", pose.theta}, {"covariance", entries}};
}

nlohmann::ordered_json evidence_json(const EvidenceScore& evidence) {
  return {{"likelihood", evidence.likelihood}, {"free", evidence.free}, {"unknown", evidence.unknown},
          {"through", evidence.through},       {"near", evidence.near}, {"residual", evidence.residual}};
}

namespace {

nlohmann::ordered_json hypothesis_json(const PoseHypothesis& hypothesis) {
  nlohmann::ordered_json json = pose_json(hypothesis.map_from_sensor, hypothesis.covariance);
  json["score"] = hypothesis.score;
  json["weight"] = hypothesis.weight;
  json["evidence"] = evidence_json(hypothesis.evidence);
  return json;
}

/// A place by the papers' method: the match that stands for it, with what all matches of the place say together.
nlohmann::ordered_json place_json(const PoseHypothesis& hypothesis, const Place& place, const SolutionSet& set) {
  nlohmann::ordered_json json = pose_json(hypothesis.map_from_sensor, hypothesis.covariance);
  const Hypothesis& best = set.hypotheses[place.hypothesis];
  json["score"] = hypothesis.score;
  json["weight"] = hypothesis.weight;
  json["inliers"] = best.inliers;
  json["residual"] = best.residual;
  json["map_scan"] = best.map_scan;
  json["support"] = place.support;
  return json;
}

nlohmann::ordered_json sample_json(const Hypothesis& sample) {
  nlohmann::ordered_json json = pose_json(sample.map_from_sensor, sample.covariance);
  json["weight"] = sample.weight;
  json["inliers"] = sample.inliers;
  json["residual"] = sample.residual;
  json["map_scan"] = sample.map_scan;
  return json;
}

}  // namespace

nlohmann::ordered_json answer_json(std::size_t scan, const LocalizationResult& result, const LocalizeTimes& times,
                                   const AnswerDetail& detail) {
  nlohmann::ordered_json json{{"scan", scan},
                              {"verdict", to_string(result.verdict)},
                              {"reason", to_string(result.reason)},
                              {"confidence", result.confidence},
                              {"points", result.points},
                              {"time_us", times.total_us()},
                              {"stages_us",
                               {{"detect", stage_json(times.detect_us)},
                                {"describe", stage_json(times.describe_us)},
                                {"match", stage_json(times.match_us)},
                                {"search", stage_json(times.search_us)},
                                {"rank", stage_json(times.rank_us)},
                                {"refine", stage_json(times.refine_us)}}},
                              {"places", result.hypotheses.size()},
                              {"hypotheses", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < std::min(result.hypotheses.size(), detail.most_places); ++i) {
    const PoseHypothesis& hypothesis = result.hypotheses[i];
    json["hypotheses"].push_back(result.solution_set
                                     ? place_json(hypothesis, result.solution_set->places[i], *result.solution_set)
                                     : hypothesis_json(hypothesis));
  }
  if (detail.samples) {
    json["samples"] = nlohmann::ordered_json::array();
    for (const Hypothesis& sample : result.solution_set->hypotheses) { json["samples"].push_back(sample_json(sample)); }
  }
  return json;
}

std::string answer_line(std::size_t scan, const LocalizationResult& result, const std::optional<Pose2>& truth) {
  std::string line = fmt::format("scan {:>5}  {:<9}", scan, to_string(result.verdict));
  if (const PoseHypothesis* best = result.best(); best != nullptr) {
    const Pose2& pose = best->map_from_sensor;
    line += fmt::format("  x {:8.3f} m  y {:8.3f} m  {:7.2f} deg  confidence {:.3f}", pose.x, pose.y,
                        degrees_from_radians(pose.theta), result.confidence);
    if (truth) {
      line += fmt::format("  {:.3f} m {:.2f} deg from the log's pose", distance(pose, *truth),
                          degrees_from_radians(heading_difference(pose, *truth)));
    }
  }
  return result.verdict == Verdict::unique ? line : line + "  " + std::string(to_string(result.reason));
}

}  // namespace flirt::app
