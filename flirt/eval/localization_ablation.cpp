#include "flirt/eval/localization_ablation.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/eval/bootstrap.hpp"

#include <cstdint>
#include <limits>

namespace flirt {
namespace {

/// Variants that change the search for candidates and their refinement.
void add_search_variants(const LocalizeParams& full, std::vector<LocalizationVariant>& variants) {
  const auto add = [&](std::string_view name, std::string_view meaning, const auto& change) {
    variants.push_back({name, meaning, full});
    change(variants.back().params);
  };
  add("no-coarse-penalty", "coarse search does not tell free from unknown space",
      [](LocalizeParams& params) { params.fields.free_penalty = 0; });
  add("one-reading", "what is not unique without legs is not read again with them",
      [](LocalizeParams& params) { params.few_legs = 0; });
  add("no-heats", "coarse poses compared as they are for which to refine",
      [](LocalizeParams& params) { params.search.heat_steps = 0; });
  add("few-candidates", "100 coarse tiles kept instead of 1000",
      [](LocalizeParams& params) { params.search.dense.candidates = 100; });
  add("no-refinement", "coarse poses scored as they are, 0.2 m and 3° apart",
      [](LocalizeParams& params) { params.search.refine.iterations = 0; });
  add("correlative", "no lines: poses 0.1 m and 1° apart scored as they are", [](LocalizeParams& params) {
    params.method = LocalizeMethod::dense;
    params.fields.coarse_factor = 2;
    params.fields.likelihood_sigma = 0.1;
    params.search.dense.heading_step = radians_from_degrees(1);
    params.search.refine.iterations = 0;
  });
  add("blind-sides", "scans drawn onto surfaces that were only seen from their other side, too",
      [](LocalizeParams& params) { params.search.refine.before = 0; });
  add("dense", "every heading at every place", [](LocalizeParams& params) { params.method = LocalizeMethod::dense; });
  add("features", "only where keypoints vote for",
      [](LocalizeParams& params) { params.method = LocalizeMethod::features; });
  add("papers", "matches with single map scans, by their keypoints",
      [](LocalizeParams& params) { params.method = LocalizeMethod::papers; });
}

using Weight = double EvidenceWeights::*;

/// Variants that change the score, or the confidence that comes of it.
void add_score_variants(const LocalizeParams& full, std::vector<LocalizationVariant>& variants) {
  const auto add = [&](std::string_view name, std::string_view meaning, const auto& change) {
    variants.push_back({name, meaning, full});
    change(variants.back().params);
  };
  const auto without = [&](std::string_view name, std::string_view meaning, const std::vector<Weight>& weights) {
    add(name, meaning, [&](LocalizeParams& params) {
      for (const Weight weight : weights) {
        params.search.score.fit.*weight = 0;
        params.search.score.preference.*weight = 0;
      }
    });
  };
  using W = EvidenceWeights;
  without("no-through", "beams may cross walls in the score", {&W::through});
  without("no-free", "end points may lie in free space in the score", {&W::free});
  without("no-unknown", "unseen space is worth nothing in the score", {&W::unknown});
  without("end-points-only", "the three before together", {&W::through, &W::free, &W::unknown});
  add("one-score", "places compared by how well the scan fits",
      [](LocalizeParams& params) { params.search.score.preference = params.search.score.fit; });
  add("nothing-moved", "what is not unique is not judged again as if narrow things had been moved",
      [](LocalizeParams& params) { params.search.score.moved_width = 0; });
  add("margin-only", "confidence without the shares of unseen end points and crossing beams",
      [](LocalizeParams& params) {
        params.verdict.unknown = 0;
        params.verdict.through = 0;
      });
  add("no-margin", "confidence without the margin to the second place",
      [](LocalizeParams& params) { params.verdict.margin = 0; });
}

/// 1 for each right answer, 0 for each wrong one, NaN where `full` shows that the query can't be answered.
std::vector<double> right_answers(const LocalizationBench& bench, const LocalizationBench& full) {
  std::vector<double> right;
  right.reserve(bench.answers.size());
  for (std::size_t i = 0; i < bench.answers.size(); ++i) {
    right.push_back(!full.answers[i].answerable ? std::numeric_limits<double>::quiet_NaN()
                    : bench.answers[i].correct  ? 1.0
                                                : 0.0);
  }
  return right;
}

LocalizationVariantRow row_of(const LocalizationVariant& variant, const LocalizationBench& bench,
                              const LocalizationBench& full, std::uint64_t seed) {
  FLIRT_ASSERT(bench.revisit && bench.answers.size() == full.answers.size());
  const std::vector<double> first = right_answers(full, full);
  const std::vector<double> second = right_answers(bench, full);
  std::vector<double> gain;
  gain.reserve(first.size());
  for (std::size_t i = 0; i < first.size(); ++i) { gain.push_back(second[i] - first[i]); }
  const RevisitSummary& summary = *bench.revisit;
  return {.name = variant.name,
          .meaning = variant.meaning,
          .success = summary.success,
          .recall_at_99 = recall_at_precision(summary.curve, 0.99),
          .unique_found = summary.unique_found.value(),
          .query_median_us = bench.times.per_query_median,
          .from_full = disagreements(first, second),
          .difference = block_bootstrap_mean(full.blocks, gain, seed).interval};
}

}  // namespace

std::vector<LocalizationVariant> localization_variants(const LocalizeParams& full) {
  std::vector<LocalizationVariant> variants{{"full", "everything", full}};
  add_score_variants(full, variants);
  add_search_variants(full, variants);
  return variants;
}

std::vector<LocalizationVariantRow> ablate_localization(const ScanLog& log, const PlaceMap& map,
                                                        const LocalizationBenchParams& params,
                                                        std::span<const LocalizationVariant> variants,
                                                        std::size_t threads, const Progress& progress) {
  std::vector<LocalizationVariantRow> rows;
  LocalizationBench full;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    LocalizationBenchParams asked = params;
    asked.protocol = LocalizationProtocol::revisit;
    asked.localize = variants[i].params;
    const Progress part = [&](double done) {
      if (progress) { progress((static_cast<double>(i) + done) / static_cast<double>(variants.size())); }
    };
    LocalizationBench bench = bench_localization(log, map, asked, threads, part);
    rows.push_back(row_of(variants[i], bench, i == 0 ? bench : full, params.seed));
    if (i == 0) { full = std::move(bench); }
  }
  return rows;
}

}  // namespace flirt
