// flirt/eval/localization_ablation.hpp: what each ingredient of localization brings: the same queries without it.
#pragma once

#include "flirt/eval/localization.hpp"
#include "flirt/eval/statistics.hpp"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace flirt {

/// One way to localize, with something left out or exchanged.
struct LocalizationVariant {
  std::string_view name{};
  std::string_view meaning{};
  LocalizeParams params{};
};

/// `full`, which is the parameters given, first; then one variant per ingredient.
[[nodiscard]] std::vector<LocalizationVariant> localization_variants(const LocalizeParams& full);

/// How a variant did, and whether that differs from `full` by more than chance.
struct LocalizationVariantRow {
  std::string_view name{};
  std::string_view meaning{};
  Rate success{};             ///< right pose of the answerable queries
  double recall_at_99{0};     ///< of the answerable queries, by the variant's own confidence
  double unique_found{0};     ///< answerable queries called unique and right
  double query_median_us{0};  ///< µs a query
  Disagreements from_full{};  ///< answerable queries; first: full, second: the variant
  Interval difference{};      ///< of success from full's, by blocks of trajectory, 95 %
};

/// Runs the revisit protocol once per variant; variants[0] is what the others are compared with.
[[nodiscard]] std::vector<LocalizationVariantRow> ablate_localization(const ScanLog& log, const PlaceMap& map,
                                                                      const LocalizationBenchParams& params,
                                                                      std::span<const LocalizationVariant> variants,
                                                                      std::size_t threads,
                                                                      const Progress& progress = {});

}  // namespace flirt
