// apps/flirt/localize_json.hpp: answers of localization for programs and for people.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/map/localize.hpp"

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <optional>
#include <string>

namespace flirt::app {

/// {x, y, theta, covariance: 9 numbers, row by row}
[[nodiscard]] nlohmann::ordered_json pose_json(const Pose2& pose, const Eigen::Matrix3d& covariance);

/// {likelihood, free, unknown, through, near, residual}
[[nodiscard]] nlohmann::ordered_json evidence_json(const EvidenceScore& evidence);

/// How much of an answer is written.
struct AnswerDetail {
  std::size_t most_places{10};
  bool samples{false};  ///< every match of the method `papers`
};
/// A member of `queries`.
[[nodiscard]] nlohmann::ordered_json answer_json(std::size_t scan, const LocalizationResult& result,
                                                 const LocalizeTimes& times, const AnswerDetail& detail);

/// One line for people; `truth` is the log's own pose, where it has one.
[[nodiscard]] std::string answer_line(std::size_t scan, const LocalizationResult& result,
                                      const std::optional<Pose2>& truth);

}  // namespace flirt::app
