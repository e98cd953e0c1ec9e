#include "flirt/eval/ablation.hpp"

#include "flirt/eval/revisit.hpp"

#include <cmath>
#include <iomanip>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

namespace flirt {
namespace {

std::string decimals(double value, int count) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(count) << value;
  return text.str();
}

/// A variant from the default by a change of its parts.
class Variants {
 public:
  template <class Change>
  void detector(const std::string& choice, const std::string& value, const Change& change) {
    CurvatureParams params;
    change(params);
    AblationVariant& variant = add(choice, value);
    variant.features.detector = params;
    variant.other_detector = true;
  }
  template <class Change>
  void grid(const std::string& choice, const std::string& value, const Change& change) {
    BetaGridParams params;
    change(params);
    add(choice, value).features.descriptor = params;
  }
  AblationVariant& add(const std::string& choice, const std::string& value) {
    return variants_.emplace_back(AblationVariant{.choice = choice, .value = value});
  }
  std::vector<AblationVariant> take() { return std::move(variants_); }

 private:
  std::vector<AblationVariant> variants_;
};

void add_detectors(Variants& variants) {
  variants.detector("geodesic distance", "3 spanning trees",
                    [](CurvatureParams& params) { params.geodesic = Geodesic::spanning_trees; });
  for (const double radius : {0.0, 0.1, 0.3, 0.4}) {
    variants.detector("duplicate radius", decimals(radius, 1) + " m",
                      [radius](CurvatureParams& params) { params.selection.duplicate_radius = radius; });
  }
  variants.detector("foreground shift", "off",
                    [](CurvatureParams& params) { params.selection.foreground_shift = false; });
  for (const int count : {1, 2, 3, 4, 6, 7}) {
    variants.detector("number of scales", std::to_string(count),
                      [count](CurvatureParams& params) { params.scales.count = count; });
  }
}

void add_descriptors(Variants& variants) {
  variants.grid("β-grid estimate", "raw ratio",
                [](BetaGridParams& params) { params.estimate = OccupancyEstimate::raw_ratio; });
  variants.grid("β-grid radius", "2t, the support region",
                [](BetaGridParams& params) { params.radius_rule = RadiusRule::support; });
  variants.grid("β-grid radius", "1 m", [](BetaGridParams& params) { params.radius = 1.0; });
  variants.grid("β-grid no-return", "free space",
                [](BetaGridParams& params) { params.no_return = NoReturnMeaning::free_space; });
  variants.grid("β-grid bins", "reach 5° and 0.05 m over their edges", [](BetaGridParams& params) {
    params.angular_inflation = radians_from_degrees(5);
    params.radial_inflation = 0.05;
  });
  variants.add("descriptor", "shape context").features.descriptor = ShapeContextParams{};
  variants.add("distance", "χ² weighted by variance").match.distance = Distance::variance_chi_square;
}

void add_matching(Variants& variants) {
  for (const double threshold : {0.2, 0.3, 0.5, 0.6}) {
    variants.add("threshold", decimals(threshold, 1)).match.max_distance = threshold;
  }
  for (const double threshold : {0.05, 0.1, 0.15}) {
    variants.add("threshold", decimals(threshold, 2)).match.max_distance = threshold;
  }
  for (const double threshold : {0.2, 0.3, 0.4, 0.5, 0.6}) {
    BetaGridParams raw;
    raw.estimate = OccupancyEstimate::raw_ratio;
    AblationVariant& variant = variants.add("threshold, raw ratio", decimals(threshold, 1));
    variant.features.descriptor = raw;
    variant.match.max_distance = threshold;
  }
  for (const double probability : {0.3, 0.4, 0.5}) {
    AblationVariant& variant = variants.add("RANSAC inlier probability", decimals(probability, 1));
    variant.ransac.sampling = Sampling::random;
    variant.ransac.inlier_probability = probability;
    variant.ransac.max_turn_difference = std::numbers::pi;  // the papers do not compare the keypoints' directions
  }
}

/// Repeatability per location, of the default's detector first and then of each variant that has another.
std::vector<std::vector<double>> repeatabilities(std::span<const ScanLog> logs, std::span<const Location> locations,
                                                 std::span<const AblationVariant> variants,
                                                 const AblationParams& params, std::size_t threads) {
  std::vector<DetectorVariant> detectors;
  for (const AblationVariant& variant : variants) {
    if (detectors.empty() || variant.other_detector) {
      detectors.push_back({variant.value, variant.features.detector});
    }
  }
  const DetectorBench bench = bench_detectors(logs, locations, detectors, params.detectors, threads);
  std::vector<std::vector<double>> scores;
  for (std::size_t v = 0; v < detectors.size(); ++v) {
    std::vector<double> mean(locations.size());
    for (const auto& [transform, name] : enum_names(ScanTransform{})) {
      const std::vector<double> own = location_scores(bench, v, RegionRule::common, transform);
      for (std::size_t l = 0; l < mean.size(); ++l) { mean[l] += own[l] / static_cast<double>(transform_count); }
    }
    scores.push_back(std::move(mean));
  }
  return scores;
}

LocalizationBench localize_with(const ScanLog& log, const PlaceMap& map, const AblationVariant& variant,
                                LocalizationProtocol protocol, LocalizationBenchParams params, std::size_t threads) {
  params.protocol = protocol;
  params.localize.method = LocalizeMethod::papers;
  params.localize.papers.match = variant.match;
  params.localize.papers.ransac = variant.ransac;
  return bench_localization(log, map, params, threads);
}

/// Adds one log to the result of a variant.
void add_log(const LocalizationBench& paper, const LocalizationBench& revisit, double share, AblationResult& result) {
  for (const LocalizationAnswer& answer : paper.answers) {
    if (answer.strategy != to_string(PickBy::residual)) { continue; }
    result.localized.push_back(answer.correct ? 1 : 0);
    result.answers.push_back(answer.answered ? 1 : 0);
  }
  for (const LocalizationAnswer& answer : revisit.answers) {
    result.revisited.push_back(answer.answerable ? (answer.correct ? 1 : 0) : std::numeric_limits<double>::quiet_NaN());
  }
  for (const StrategyCurve& curve : paper.strategies) {
    if (curve.strategy == PickBy::residual) { result.p_cl += share * curve.p_cl(); }
  }
  result.keypoints_per_scan += share * paper.features_per_scan;
}

}  // namespace

std::vector<AblationVariant> paper_ablations() {
  Variants variants;
  variants.add("default", "");
  add_detectors(variants);
  add_descriptors(variants);
  add_matching(variants);
  return variants.take();
}

std::vector<std::uint32_t> query_blocks(std::span<const ScanLog> logs, const LocalizationBenchParams& params) {
  std::vector<std::uint32_t> blocks;
  std::uint32_t first = 0;
  for (const ScanLog& log : logs) {
    const std::vector<double> lengths = path_lengths(log);
    for (std::size_t i = 0; i < lengths.size(); i += params.every) {
      blocks.push_back(first + static_cast<std::uint32_t>(lengths[i] / params.block_length));
    }
    if (!blocks.empty()) { first = blocks.back() + 1; }
  }
  return blocks;
}

Result<std::vector<AblationResult>> bench_ablation(std::span<const ScanLog> logs, std::span<const Location> locations,
                                                   std::span<const AblationVariant> variants,
                                                   const AblationParams& params, std::size_t threads,
                                                   const Progress& progress) {
  std::vector<AblationResult> results(variants.size());
  const auto scores = repeatabilities(logs, locations, variants, params, threads);
  std::size_t next = 1;
  for (std::size_t v = 0; v < variants.size(); ++v) {
    if (v > 0 && variants[v].other_detector) { results[v].repeatability = scores[next++]; }
    if (v == 0) { results[v].repeatability = scores[0]; }
    for (const ScanLog& log : logs) {
      const Result<PlaceMap> map =
          build_place_map(log, variants[v].features, threads, {}, variances_for(variants[v].match.distance));
      if (!map) { return tl::unexpected(map.error()); }
      const auto localize = [&](LocalizationProtocol protocol) {
        return localize_with(log, *map, variants[v], protocol, params.localization, threads);
      };
      add_log(localize(LocalizationProtocol::paper), localize(LocalizationProtocol::revisit),
              1.0 / static_cast<double>(logs.size()), results[v]);
    }
    if (progress) { progress(static_cast<double>(v + 1) / static_cast<double>(variants.size())); }
  }
  return results;
}

}  // namespace flirt
