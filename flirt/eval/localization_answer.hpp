// flirt/eval/localization_answer.hpp: what a localization said of one scan, beside the truth.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/core/scan_interval.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/place_map.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace flirt {

/// How near is right.
struct PoseTolerance {
  double correct_distance{0.5};                      ///< m, a pose farther from the truth is wrong
  double correct_heading{radians_from_degrees(10)};  ///< rad
  double precise_distance{0.25};                     ///< m, the stricter bound reported beside
  double precise_heading{radians_from_degrees(5)};   ///< rad
};

/// One answer of one strategy to one query.
struct LocalizationAnswer {
  std::size_t query{0};
  std::string_view strategy{};  ///< closest, corresp, residual; under `revisit` localize; distractor
  bool answerable{true};        ///< always true under `paper`, always false for distractors
  bool answered{false};         ///< false: the fields below mean nothing
  std::size_t reference{0};     ///< scan of the log that the pose came from
  Pose2 map_from_sensor{};
  double confidence{0};
  std::uint32_t inliers{0};
  double residual{0};          ///< m²
  std::string_view verdict{};  ///< unique, ambiguous, lost
  std::string_view reason{};   ///< why
  std::uint32_t points{0};     ///< end points used; 0 under `paper`, as are the next two
  double margin{0};            ///< score less that of the second place; infinite without one
  EvidenceScore evidence{};    ///< terms of the score
  double nees{0};              ///< squared error in units of the stated covariance; 0 under `paper`, for distractors
  bool correct{false};
  bool precise{false};
};

[[nodiscard]] bool is_within(const Pose2& pose, const Pose2& truth, double max_distance, double max_heading);

/// The best pose of a result without its judgement by the truth; `excluded` are scans that were out of the map.
[[nodiscard]] LocalizationAnswer answer_of(const LocalizationResult& result, const PlaceMap& map, std::size_t query,
                                           ScanInterval excluded);

/// Sets `correct`, `precise` and `nees` of the answer that was taken from `result`.
void compare_with_truth(LocalizationAnswer& answer, const LocalizationResult& result, const Pose2& truth,
                        const PoseTolerance& tolerance);

}  // namespace flirt
