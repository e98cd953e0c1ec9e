#include "flirt/eval/detector_bench.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/rng.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace flirt {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// The detectors of all variants; one set per thread.
class Detectors {
 public:
  explicit Detectors(const std::vector<DetectorVariant>& variants) {
    for (const DetectorVariant& variant : variants) {
      detectors_.push_back(variant.params ? std::optional<AnyDetector>(*variant.params) : std::nullopt);
      chance_of_.push_back(variant.chance_of);
    }
  }

  /// Keypoints of one scan, a list per variant. `stream` numbers the scan for the draw of chance.
  std::vector<std::vector<Keypoint>> detect(const Scan& scan, std::uint64_t seed, std::uint64_t stream) {
    std::vector<std::vector<Keypoint>> lists;
    for (std::size_t v = 0; v < detectors_.size(); ++v) {
      if (detectors_[v]) {
        lists.push_back(detectors_[v]->detect(scan));
      } else {
        FLIRT_ASSERT(chance_of_[v] < v);
        lists.push_back(moved_at_random(lists[chance_of_[v]], scan, seed, stream));
      }
    }
    return lists;
  }

 private:
  static std::vector<Keypoint> moved_at_random(std::vector<Keypoint> keypoints, const Scan& scan, std::uint64_t seed,
                                               std::uint64_t stream) {
    const std::vector<BeamPoint> hits = hit_points(scan);
    Rng rng(seed, stream);
    for (Keypoint& keypoint : keypoints) {
      const BeamPoint& hit = hits[rng.below(static_cast<std::uint32_t>(hits.size()))];
      keypoint.sensor_from_keypoint = {hit.point.x, hit.point.y, keypoint.sensor_from_keypoint.theta};
      keypoint.beam = hit.beam;
    }
    return keypoints;
  }

  std::vector<std::optional<AnyDetector>> detectors_;
  std::vector<std::size_t> chance_of_;
};

/// Adds all cases of one location to its own places of bench.counts.
void run_location(const ScanLog& log, std::size_t l, const DetectorBenchParams& params, Detectors& detectors,
                  DetectorBench& bench) {
  const Scan& scan = log.scans[bench.locations[l].scan];
  const std::uint64_t stream = l << 24U;
  const auto reference = detectors.detect(scan, params.transforms.seed, stream);
  RegionScan here{{}, points_of(scan, {})};
  std::uint64_t number = 0;
  for (const TransformCase& changed : cases_of(log, bench.locations[l], bench.conditions, params.transforms)) {
    const auto other = detectors.detect(changed.scan, params.transforms.seed, stream + ++number);
    RegionScan there{{}, points_of(changed.scan, changed.reference_from_sensor)};
    for (std::size_t v = 0; v < bench.variants.size(); ++v) {
      for (const RegionRule rule : region_rules) {
        here.regions = regions_of(reference[v], {}, rule, params.common_radius);
        there.regions = regions_of(other[v], changed.reference_from_sensor, rule, params.common_radius);
        bench.counts[bench.index(v, rule, changed.condition, l)] += repeatability(here, there, params.repeatability);
      }
    }
  }
}

double score_of(const RepeatabilityCounts& counts) {
  return counts.present == 0 ? no_value : static_cast<double>(counts.corresponding) / counts.present;
}

}  // namespace

std::vector<DetectorVariant> default_detectors() {
  return {{"curvature", CurvatureParams{}},    {"range", RangeParams{}}, {"normal-edge", NormalEdgeParams{}},
          {"normal-blob", NormalBlobParams{}}, {"chance", std::nullopt}, {"chance, as range", std::nullopt, 1}};
}

std::vector<DetectorVariant> detectors_as_printed() {
  std::vector<DetectorVariant> variants = default_detectors();
  for (DetectorVariant& variant : variants) {
    if (auto* ours = variant.params ? std::get_if<DetectorParams>(&*variant.params) : nullptr) {
      std::visit(
          [](auto& params) {
            params.selection.duplicate_radius = 0;
            params.selection.foreground_shift = false;
          },
          *ours);
    }
  }
  return variants;
}

std::vector<DetectorVariant> detectors_with_rivals() {
  std::vector<DetectorVariant> variants = default_detectors();
  for (const NamedDetector& rival : rival_detectors()) { variants.push_back({rival.name, rival.params}); }
  return variants;
}

DetectorBench bench_detectors(std::span<const ScanLog> logs, std::span<const Location> locations,
                              const std::vector<DetectorVariant>& variants, const DetectorBenchParams& params,
                              std::size_t threads, const Progress& progress) {
  DetectorBench bench{
      .locations = {locations.begin(), locations.end()}, .conditions = params.conditions, .variants = variants};
  bench.counts.resize(variants.size() * region_rule_count * params.conditions.size() * locations.size());
  std::vector<Detectors> detectors;
  detectors.reserve(thread_count(threads));
  for (std::size_t t = 0; t < thread_count(threads); ++t) { detectors.emplace_back(variants); }
  parallel_for(
      locations.size(), threads,
      [&](std::size_t l, std::size_t thread) {
        run_location(logs[locations[l].log], l, params, detectors[thread], bench);
      },
      progress);
  return bench;
}

std::vector<double> location_scores(const DetectorBench& bench, std::size_t variant, RegionRule rule,
                                    std::size_t condition) {
  std::vector<double> scores;
  scores.reserve(bench.locations.size());
  for (std::size_t l = 0; l < bench.locations.size(); ++l) {
    scores.push_back(score_of(bench.counts[bench.index(variant, rule, condition, l)]));
  }
  return scores;
}

std::vector<double> location_scores(const DetectorBench& bench, std::size_t variant, RegionRule rule,
                                    ScanTransform transform) {
  std::vector<double> sums(bench.locations.size());
  std::vector<double> counts(bench.locations.size());
  for (std::size_t c = 0; c < bench.conditions.size(); ++c) {
    if (bench.conditions[c].transform != transform) { continue; }
    const std::vector<double> scores = location_scores(bench, variant, rule, c);
    for (std::size_t l = 0; l < scores.size(); ++l) {
      if (!std::isfinite(scores[l])) { continue; }
      sums[l] += scores[l];
      counts[l] += 1;
    }
  }
  for (std::size_t l = 0; l < sums.size(); ++l) { sums[l] = counts[l] == 0 ? no_value : sums[l] / counts[l]; }
  return sums;
}

RepeatabilityCounts total(const DetectorBench& bench, std::size_t variant, RegionRule rule, std::size_t condition) {
  RepeatabilityCounts sum;
  for (std::size_t l = 0; l < bench.locations.size(); ++l) {
    sum += bench.counts[bench.index(variant, rule, condition, l)];
  }
  return sum;
}

}  // namespace flirt
