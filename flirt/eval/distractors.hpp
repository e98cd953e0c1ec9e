// flirt/eval/distractors.hpp: scans of other buildings asked against a map: whoever is called unique there is wrong.
#pragma once

#include "flirt/core/parallel.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/eval/localization_answer.hpp"
#include "flirt/eval/statistics.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/place_map.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace flirt {

/// Answers to every `every`-th scan of a log that was taken elsewhere; poses of the log are not looked at. The whole
/// map takes part. None is answerable, none correct. The same on any number of threads.
[[nodiscard]] std::vector<LocalizationAnswer> ask_distractors(const ScanLog& log, const PlaceMap& map,
                                                              std::size_t every, const LocalizeParams& params,
                                                              std::size_t threads, const Progress& progress = {});

struct DistractorSummary {
  Rate unique{};                              ///< false positives: called unique
  std::array<std::size_t, 10> confidences{};  ///< answers by confidence, in tenths; without an answer it is 0
};

[[nodiscard]] DistractorSummary summarise_distractors(std::span<const LocalizationAnswer> answers);

}  // namespace flirt
