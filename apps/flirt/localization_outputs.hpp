// apps/flirt/localization_outputs.hpp: what `flirt bench localization` prints and writes.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/eval/distractors.hpp"
#include "flirt/eval/localization.hpp"
#include "flirt/eval/localization_ablation.hpp"

#include "apps/flirt/command.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace flirt::app {

/// The scans of one other building.
struct DistractorRun {
  std::string log;
  std::vector<LocalizationAnswer> answers;
};

/// What a run gave.
struct LocalizationRun {
  std::string log;
  std::string poses;  ///< file of the trajectory; empty: the log's own
  std::string protocol;
  std::string method;
  std::size_t every{1};
  std::size_t join{1};
  nlohmann::ordered_json feature_params;
  nlohmann::ordered_json params;
  LocalizationBench bench{};
  std::vector<DistractorRun> distractors{};
  std::vector<LocalizationVariantRow> ablation{};
};

/// All distractors of a run together.
[[nodiscard]] DistractorSummary all_distractors(const LocalizationRun& run);

[[nodiscard]] std::string with_interval(const Rate& rate);
[[nodiscard]] std::string interval_text(Interval interval);

/// What localization.json holds, and --json prints.
[[nodiscard]] nlohmann::ordered_json localization_json(const LocalizationRun& run, const Session& session);

/// One line per query and strategy; those of distractors say `distractor:N`, N counting the logs from 1.
[[nodiscard]] std::string queries_csv(const LocalizationRun& run);
/// What the confidence was computed from, one line per query: to fit it, or to ask why.
[[nodiscard]] std::string evidence_csv(const LocalizationRun& run);

/// The tables for people.
[[nodiscard]] std::string localization_text(const LocalizationRun& run);
[[nodiscard]] std::string ablation_text(const LocalizationRun& run);

/// Precision and recall, as SVG.
[[nodiscard]] std::string localization_curves(const LocalizationRun& run);
[[nodiscard]] std::string localization_page(const LocalizationRun& run, const ScanLog& log);

}  // namespace flirt::app
