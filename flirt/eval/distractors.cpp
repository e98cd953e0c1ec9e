#include "flirt/eval/distractors.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <memory>

namespace flirt {

std::vector<LocalizationAnswer> ask_distractors(const ScanLog& log, const PlaceMap& map, std::size_t every,
                                                const LocalizeParams& params, std::size_t threads,
                                                const Progress& progress) {
  FLIRT_ASSERT(every > 0);
  std::vector<LocalizationAnswer> answers((log.scans.size() + every - 1) / every);
  std::vector<std::unique_ptr<Localizer>> localizers(thread_count(threads));
  parallel_for(
      answers.size(), threads,
      [&](std::size_t k, std::size_t thread) {
        if (!localizers[thread]) { localizers[thread] = std::make_unique<Localizer>(map, params); }
        const std::size_t query = k * every;
        answers[k] = answer_of(localizers[thread]->localize(log.scans[query]), map, query, {});
        answers[k].strategy = "distractor";
        answers[k].answerable = false;
      },
      progress);
  return answers;
}

DistractorSummary summarise_distractors(std::span<const LocalizationAnswer> answers) {
  DistractorSummary summary{.unique = {0, answers.size()}};
  const auto bins = static_cast<double>(summary.confidences.size());
  for (const LocalizationAnswer& answer : answers) {
    summary.unique.hits += answer.verdict == to_string(Verdict::unique) ? 1 : 0;
    const auto bin = static_cast<std::size_t>(std::clamp(answer.confidence * bins, 0.0, bins - 1));
    ++summary.confidences[bin];
  }
  return summary;
}

}  // namespace flirt
