#include "flirt/eval/descriptor_bench.hpp"

#include <utility>

namespace flirt {
namespace {

constexpr std::array pair_rules{PairRule::all, PairRule::nearest};

/// A row of descriptor distances per keypoint of the reference.
std::vector<float> distance_table(const Features& reference, const Features& other, Distance distance) {
  const DescriptorRows rows = rows_of(reference.descriptors);
  const DescriptorRows columns = rows_of(other.descriptors);
  std::vector<float> table(static_cast<std::size_t>(rows.count) * columns.count);
  for (std::size_t i = 0; i < rows.count; ++i) {
    descriptor_distances(distance, rows, i, columns, std::span(table).subspan(i * columns.count, columns.count));
  }
  return table;
}

/// One pair of scans with the features of one method.
void add_case(const Features& reference, const Features& other, const TransformCase& changed, std::size_t method,
              const DescriptorBenchParams& params, std::size_t location, DescriptorBench& bench) {
  if (reference.keypoints.empty() || other.keypoints.empty()) { return; }
  std::array<std::vector<RegionPair>, region_rules.size()> overlapping;
  for (const RegionRule rule : region_rules) {
    const auto here = regions_of(reference.keypoints, {}, rule, params.common_radius);
    const auto there = regions_of(other.keypoints, changed.reference_from_sensor, rule, params.common_radius);
    overlapping[static_cast<std::size_t>(rule)] = overlapping_pairs(here, there, params.overlap_error);
  }
  for (std::size_t e = 0; e < bench.entries.size(); ++e) {
    if (bench.entries[e].method != method) { continue; }
    const Distance distance = bench.entries[e].distance;
    const std::vector<float> table = distance_table(reference, other, distance);
    for (const RegionRule region : region_rules) {
      for (const PairRule pairs : pair_rules) {
        const CountsOf which{e, region, pairs, params.conditions[changed.condition].transform};
        bench.counts[bench.index(which, location)] += count_matches(
            table, other.keypoints.size(), overlapping[static_cast<std::size_t>(region)], distance, pairs);
      }
    }
  }
}

/// Returns the pairs of scans by transform.
std::array<std::size_t, transform_count> run_location(const ScanLog& log, std::size_t l,
                                                      const DescriptorBenchParams& params,
                                                      std::vector<AnyExtractor>& extractors, DescriptorBench& bench) {
  const Scan& scan = log.scans[bench.locations[l].scan];
  const std::vector<TransformCase> cases = cases_of(log, bench.locations[l], params.conditions, params.transforms);
  std::array<std::size_t, transform_count> scans{};
  for (const TransformCase& changed : cases) {
    ++scans[static_cast<std::size_t>(params.conditions[changed.condition].transform)];
  }
  for (std::size_t m = 0; m < extractors.size(); ++m) {
    const Features reference = extractors[m].extract(scan);
    for (const TransformCase& changed : cases) {
      add_case(reference, extractors[m].extract(changed.scan), changed, m, params, l, bench);
    }
  }
  return scans;
}

}  // namespace

std::vector<FeatureMethod> paper_combinations() {
  std::vector<FeatureMethod> methods;
  for (const DescriptorParams& descriptor :
       {DescriptorParams{BetaGridParams{}}, DescriptorParams{ShapeContextParams{}}}) {
    for (const DetectorParams& detector : {DetectorParams{CurvatureParams{}}, DetectorParams{RangeParams{}},
                                           DetectorParams{NormalEdgeParams{}}, DetectorParams{NormalBlobParams{}}}) {
      methods.push_back(
          {std::string(detector_name(detector)), std::string(descriptor_name(descriptor)), {detector, descriptor}});
    }
  }
  return methods;
}

std::vector<FeatureMethod> descriptor_variants() {
  using enum Distance;
  const std::vector<Distance> other_distances{euclidean, hellinger, bhattacharyya, jensen_shannon, kullback_leibler};
  std::vector<Distance> grid_distances{chi_square, variance_chi_square};
  grid_distances.insert(grid_distances.end(), other_distances.begin(), other_distances.end());
  std::vector<Distance> histogram_distances{chi_square};
  histogram_distances.insert(histogram_distances.end(), other_distances.begin(), other_distances.end());

  BetaGridParams raw;
  raw.estimate = OccupancyEstimate::raw_ratio;
  BetaGridParams raw_and_wide = raw;
  raw_and_wide.radius = 1.0;
  BetaGridParams proportional;
  proportional.radius_rule = RadiusRule::support;
  BetaGridParams free_space;
  free_space.no_return = NoReturnMeaning::free_space;
  BetaGridParams wide;
  wide.radius = 1.0;
  ShapeContextParams proportional_context;
  proportional_context.radius_rule = RadiusRule::support;
  const DetectorParams curvature = CurvatureParams{};
  return {{"curvature", "beta-grid", {curvature, BetaGridParams{}}, grid_distances},
          {"curvature", "beta-grid, raw ratio", {curvature, raw}, {chi_square, variance_chi_square}},
          {"curvature", "beta-grid, raw ratio, radius 1 m", {curvature, raw_and_wide}},
          {"range", "beta-grid, raw ratio", {RangeParams{}, raw}},
          {"normal-edge", "beta-grid, raw ratio", {NormalEdgeParams{}, raw}},
          {"normal-blob", "beta-grid, raw ratio", {NormalBlobParams{}, raw}},
          {"curvature", "beta-grid, radius 2t", {curvature, proportional}, {chi_square, variance_chi_square}},
          {"curvature", "beta-grid, radius 1 m", {curvature, wide}, {chi_square, variance_chi_square}},
          {"curvature", "beta-grid, no-return is free", {curvature, free_space}, {chi_square, variance_chi_square}},
          {"curvature", "shape-context", {curvature, ShapeContextParams{}}, histogram_distances},
          {"curvature", "shape-context, radius 2t", {curvature, proportional_context}}};
}

std::vector<FeatureMethod> rival_combinations() {
  std::vector<FeatureMethod> methods;
  for (const NamedDetector& detector : all_detectors()) {
    if (detector.name != "curvature" && detector.name != "falko" && detector.name != "oc") { continue; }
    for (const NamedDescriptor& descriptor : all_descriptors()) {
      methods.push_back({detector.name, descriptor.name, {detector.params, descriptor.params}});
    }
  }
  return methods;
}

DescriptorBench bench_descriptors(std::span<const ScanLog> logs, std::span<const Location> locations,
                                  const std::vector<FeatureMethod>& methods, const DescriptorBenchParams& params,
                                  std::size_t threads, const Progress& progress) {
  DescriptorBench bench{.locations = {locations.begin(), locations.end()}, .methods = methods};
  for (std::size_t m = 0; m < methods.size(); ++m) {
    for (const Distance distance : methods[m].distances) { bench.entries.push_back({m, distance}); }
  }
  bench.counts.resize(bench.entries.size() * 4 * transform_count * locations.size());
  std::vector<std::vector<AnyExtractor>> extractors(thread_count(threads));
  for (auto& own : extractors) {
    for (const FeatureMethod& method : methods) { own.emplace_back(method.features); }
  }
  std::vector<std::array<std::size_t, transform_count>> scans(locations.size());
  parallel_for(
      locations.size(), threads,
      [&](std::size_t l, std::size_t thread) {
        scans[l] = run_location(logs[locations[l].log], l, params, extractors[thread], bench);
      },
      progress);
  for (const auto& own : scans) {
    for (std::size_t t = 0; t < transform_count; ++t) { bench.scans[t] += own[t]; }
  }
  return bench;
}

MatchingCounts total(std::span<const MatchingCounts> per_location) {
  MatchingCounts sum;
  for (const MatchingCounts& counts : per_location) { sum += counts; }
  return sum;
}

AveragePrecision average_precision(std::span<const MatchingCounts> per_location,
                                   std::span<const std::vector<std::uint32_t>> draws) {
  AveragePrecision result{.value = average_precision(total(per_location))};
  for (const std::vector<std::uint32_t>& draw : draws) {
    MatchingCounts sum;
    for (const std::uint32_t location : draw) { sum += per_location[location]; }
    result.draws.push_back(average_precision(sum));
  }
  return result;
}

AveragePrecision mean_of(std::span<const AveragePrecision> parts) {
  AveragePrecision mean;
  for (const AveragePrecision& part : parts) {
    mean.draws.resize(part.draws.size());
    mean.value += part.value / static_cast<double>(parts.size());
    for (std::size_t d = 0; d < part.draws.size(); ++d) {
      mean.draws[d] += part.draws[d] / static_cast<double>(parts.size());
    }
  }
  return mean;
}

AveragePrecision difference(const AveragePrecision& a, const AveragePrecision& b) {
  AveragePrecision result{.value = a.value - b.value};
  for (std::size_t d = 0; d < a.draws.size(); ++d) { result.draws.push_back(a.draws[d] - b.draws[d]); }
  return result;
}

}  // namespace flirt
