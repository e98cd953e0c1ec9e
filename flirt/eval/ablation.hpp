// flirt/eval/ablation.hpp: what each choice of the method brings: one parameter changed at a time, everything else at
// its default.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/eval/detector_bench.hpp"
#include "flirt/eval/localization.hpp"
#include "flirt/features/extract.hpp"
#include "flirt/match/match.hpp"
#include "flirt/match/ransac.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace flirt {

/// The papers' method with one choice made otherwise.
struct AblationVariant {
  std::string choice{};
  std::string value{};
  FeatureParams features{};
  MatchParams match{};
  RansacParams ransac{};
  bool other_detector{false};  ///< repeatability differs from the default's
};

/// The default first, then: geodesic distances, duplicate radius, foreground shift, number of scales, estimate and
/// radius of the β-grid, no-return beams, distance and its threshold, and the papers' RANSAC by inlier probability:
/// drawn at random, any turn.
[[nodiscard]] std::vector<AblationVariant> paper_ablations();

/// What one variant reaches: one value per case, the same cases in the same order for every variant.
struct AblationResult {
  double keypoints_per_scan{0};
  std::vector<double> repeatability{};  ///< per location: mean over the four transforms, common regions
  std::vector<double> localized{};  ///< per query: 1 where the match of least residual is right, paper protocol (p_GL)
  std::vector<double> answers{};    ///< per query: 1 where there was any match
  std::vector<double> revisited{};  ///< per query: the same under `revisit`; NaN where it is not answerable
  double p_cl{0};                   ///< recall at precision 0.95, paper protocol, residual; mean over the logs
};

struct AblationParams {
  LocalizationBenchParams localization{};
  DetectorBenchParams detectors{.transforms = {.partners = 10}};
};

/// The block of trajectory of each query of all logs, one log after the other: what bootstrap draws.
[[nodiscard]] std::vector<std::uint32_t> query_blocks(std::span<const ScanLog> logs,
                                                      const LocalizationBenchParams& params);

/// One result per variant. `logs` have poses. The same on any number of threads.
[[nodiscard]] Result<std::vector<AblationResult>> bench_ablation(std::span<const ScanLog> logs,
                                                                 std::span<const Location> locations,
                                                                 std::span<const AblationVariant> variants,
                                                                 const AblationParams& params, std::size_t threads,
                                                                 const Progress& progress = {});

}  // namespace flirt
