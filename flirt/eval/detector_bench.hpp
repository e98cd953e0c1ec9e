// flirt/eval/detector_bench.hpp: how often detectors find the same places again (P2 §IV-B, Fig. 6).
#pragma once

#include "flirt/arena/any_features.hpp"
#include "flirt/eval/bootstrap.hpp"
#include "flirt/eval/repeatability.hpp"
#include "flirt/eval/transform_cases.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace flirt {

/// A detector under test.
struct DetectorVariant {
  std::string name{};
  /// Nothing: the level of chance; the keypoints of variant `chance_of` with their regions, but each moved to a hit
  /// drawn at random, in each scan anew.
  std::optional<AnyDetectorParams> params{};
  std::size_t chance_of{0};  ///< an earlier variant
};

/// The papers' four with their default parameters, and chance with as many points as curvature and as range have.
[[nodiscard]] std::vector<DetectorVariant> default_detectors();
/// The same as the papers print them: every detection of every scale is an interest point, and stays where it is.
[[nodiscard]] std::vector<DetectorVariant> detectors_as_printed();

/// The default ones, then those of flirt/arena/.
[[nodiscard]] std::vector<DetectorVariant> detectors_with_rivals();

struct DetectorBenchParams {
  TransformParams transforms{};
  RepeatabilityParams repeatability{};
  double common_radius{0.5};  ///< m, of RegionRule::common
  std::vector<Condition> conditions{paper_conditions()};
};

inline constexpr std::size_t region_rule_count = 2;

/// All counts, so that every mean can be computed, and compared, over the same locations.
struct DetectorBench {
  std::vector<Location> locations{};
  std::vector<Condition> conditions{};
  std::vector<DetectorVariant> variants{};
  std::vector<RepeatabilityCounts> counts{};  ///< variant × rule × condition × location

  [[nodiscard]] std::size_t index(std::size_t variant, RegionRule rule, std::size_t condition,
                                  std::size_t location) const {
    return ((variant * region_rule_count + static_cast<std::size_t>(rule)) * conditions.size() + condition) *
               locations.size() +
           location;
  }
};

/// Runs all variants over all cases of the locations. `logs` have poses. The same on any number of threads.
/// O(cases · variants · cost of a detection).
[[nodiscard]] DetectorBench bench_detectors(std::span<const ScanLog> logs, std::span<const Location> locations,
                                            const std::vector<DetectorVariant>& variants,
                                            const DetectorBenchParams& params, std::size_t threads,
                                            const Progress& progress = {});

/// Repeatability under one condition, one value per location: corresponding / present over all its scans, or NaN where
/// nothing was present.
[[nodiscard]] std::vector<double> location_scores(const DetectorBench& bench, std::size_t variant, RegionRule rule,
                                                  std::size_t condition);

/// The same over all conditions of a transform: the mean of those that have a value.
[[nodiscard]] std::vector<double> location_scores(const DetectorBench& bench, std::size_t variant, RegionRule rule,
                                                  ScanTransform transform);

/// All counts of a variant under one condition, summed over the locations.
[[nodiscard]] RepeatabilityCounts total(const DetectorBench& bench, std::size_t variant, RegionRule rule,
                                        std::size_t condition);

}  // namespace flirt
