// flirt/eval/descriptor_bench.hpp: how well descriptors tell the same place from others (P2 §IV-C, Fig. 7).
#pragma once

#include "flirt/arena/any_features.hpp"
#include "flirt/eval/bootstrap.hpp"
#include "flirt/eval/matching_counts.hpp"
#include "flirt/eval/transform_cases.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace flirt {

/// Features under test, and the distances that they are compared by.
struct FeatureMethod {
  std::string detector{};
  std::string descriptor{};
  AnyFeatureParams features{};
  std::vector<Distance> distances{Distance::chi_square};
};

/// The papers' comparison: 4 detectors × 2 descriptors.
[[nodiscard]] std::vector<FeatureMethod> paper_combinations();
/// Curvature keypoints with other β-grids (raw ratio, radius in proportion to the scale or 1 m, no-return as free
/// space), both descriptors with every distance, and the raw ratio with all detectors. The papers' choice comes first.
[[nodiscard]] std::vector<FeatureMethod> descriptor_variants();

/// Curvature, FALKO and OC keypoints, each with our descriptors and the rivals'.
[[nodiscard]] std::vector<FeatureMethod> rival_combinations();

struct DescriptorBenchParams {
  TransformParams transforms{.partners = 20};
  double overlap_error{0.6};  ///< regions with less are the same place
  double common_radius{0.5};  ///< m, of RegionRule::common
  std::vector<Condition> conditions{paper_conditions()};
};

/// One line of the comparison: features with a distance.
struct DescriptorEntry {
  std::size_t method{0};
  Distance distance{Distance::chi_square};
};

/// Which of the counts: rules and transform.
struct CountsOf {
  std::size_t entry{0};
  RegionRule region{RegionRule::common};
  PairRule pairs{PairRule::all};
  ScanTransform transform{ScanTransform::viewpoint};
};

struct DescriptorBench {
  std::vector<Location> locations{};
  std::vector<FeatureMethod> methods{};
  std::vector<DescriptorEntry> entries{};
  std::vector<MatchingCounts> counts{};              ///< entry × region rule × pair rule × transform × location
  std::array<std::size_t, transform_count> scans{};  ///< pairs of scans that each transform has

  [[nodiscard]] std::size_t index(const CountsOf& which, std::size_t location) const {
    const auto rules = static_cast<std::size_t>(which.region) * 2 + static_cast<std::size_t>(which.pairs);
    const auto curve = (which.entry * 4 + rules) * transform_count + static_cast<std::size_t>(which.transform);
    return curve * locations.size() + location;
  }
  [[nodiscard]] std::span<const MatchingCounts> at(const CountsOf& which) const {
    return std::span(counts).subspan(index(which, 0), locations.size());
  }
};

/// Runs all methods over all cases of the locations. `logs` have poses. The same on any number of threads.
[[nodiscard]] DescriptorBench bench_descriptors(std::span<const ScanLog> logs, std::span<const Location> locations,
                                                const std::vector<FeatureMethod>& methods,
                                                const DescriptorBenchParams& params, std::size_t threads,
                                                const Progress& progress = {});

/// Sum over the locations.
[[nodiscard]] MatchingCounts total(std::span<const MatchingCounts> per_location);

/// Average precision of the sum over all locations, and of each bootstrap draw of locations.
struct AveragePrecision {
  double value{0};
  std::vector<double> draws{};
};
[[nodiscard]] AveragePrecision average_precision(std::span<const MatchingCounts> per_location,
                                                 std::span<const std::vector<std::uint32_t>> draws);

/// The mean of several, draw by draw; and the difference of two, draw by draw.
[[nodiscard]] AveragePrecision mean_of(std::span<const AveragePrecision> parts);
[[nodiscard]] AveragePrecision difference(const AveragePrecision& a, const AveragePrecision& b);

}  // namespace flirt
