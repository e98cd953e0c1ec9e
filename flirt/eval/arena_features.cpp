#include "flirt/eval/arena_features.hpp"

#include "flirt/eval/cpu_time.hpp"
#include "flirt/eval/matching_counts.hpp"
#include "flirt/eval/repeatability.hpp"
#include "flirt/eval/transform_cases.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace flirt {
namespace {

/// Two neighbours in the log, in the frame of the first.
struct NextScan {
  std::size_t reference;
  std::size_t other;
  Pose2 reference_from_other;
};
std::vector<NextScan> next_scans(const ScanLog& log, const ArenaQueries& queries) {
  std::vector<NextScan> pairs;
  for (const std::size_t q : queries.scans) {
    if (q + 1 == log.scans.size()) { continue; }
    pairs.push_back({q, q + 1, inverse(log.map_from_sensor(q)) * log.map_from_sensor(q + 1)});
  }
  return pairs;
}

std::vector<Region> regions_at(std::span<const Keypoint> keypoints, const Pose2& reference_from_sensor,
                               const ArenaParams& params) {
  return regions_of(keypoints, reference_from_sensor, RegionRule::common, params.common_radius);
}

MatchingCounts count_nearest(const ArenaScan& reference, const ArenaScan& other, const Pose2& reference_from_other,
                             const ArenaParams& params) {
  const DescriptorRows rows = rows_of(reference.features.descriptors);
  const DescriptorRows columns = rows_of(other.features.descriptors);
  std::vector<float> table(std::size_t{rows.count} * columns.count);
  for (std::size_t i = 0; i < rows.count && columns.count > 0; ++i) {
    descriptor_distances(Distance::chi_square, rows, i, columns,
                         std::span(table).subspan(i * columns.count, columns.count));
  }
  const double max_error = RepeatabilityParams{}.overlap_error;
  return count_matches(table, columns.count,
                       overlapping_pairs(regions_at(reference.features.keypoints, {}, params),
                                         regions_at(other.features.keypoints, reference_from_other, params), max_error),
                       Distance::chi_square, PairRule::nearest);
}

}  // namespace

double mean_us(std::span<const double> times) {
  return times.empty() ? 0.0 : std::accumulate(times.begin(), times.end(), 0.0) / static_cast<double>(times.size());
}

DetectedLog detect_all(const ScanLog& log, const NamedDetector& named, const ArenaQueries& queries,
                       const ArenaParams& params, std::size_t threads) {
  DetectedLog detected{.keypoints = std::vector<std::vector<Keypoint>>(log.scans.size())};
  std::vector<AnyDetector> detectors;
  detectors.reserve(thread_count(threads));
  for (std::size_t t = 0; t < thread_count(threads); ++t) { detectors.emplace_back(named.params); }
  std::vector<double> times(log.scans.size());
  parallel_for(log.scans.size(), threads, [&](std::size_t i, std::size_t thread) {
    const double before = thread_cpu_us();
    detected.keypoints[i] = detectors[thread].detect(log.scans[i]);
    times[i] = thread_cpu_us() - before;
  });
  detected.detect_us = mean_us(times);
  double count = 0;
  for (const auto& own : detected.keypoints) { count += static_cast<double>(own.size()); }
  detected.per_scan = count / static_cast<double>(std::max<std::size_t>(1, log.scans.size()));

  const std::vector<NextScan> pairs = next_scans(log, queries);
  std::vector<RepeatabilityCounts> counts(pairs.size());
  parallel_for(pairs.size(), threads, [&](std::size_t k, std::size_t) {
    const auto& [reference, other, reference_from_other] = pairs[k];
    counts[k] =
        repeatability({regions_at(detected.keypoints[reference], {}, params), points_of(log.scans[reference], {})},
                      {regions_at(detected.keypoints[other], reference_from_other, params),
                       points_of(log.scans[other], reference_from_other)});
  });
  for (const RepeatabilityCounts& own : counts) {
    detected.repeatability.hits += own.corresponding;
    detected.repeatability.total += own.present;
  }
  return detected;
}

DescribedLog describe_all(const ScanLog& log, const DetectedLog& detected, const std::optional<NamedDescriptor>& named,
                          const ArenaQueries& queries, const ArenaParams& params, std::size_t threads) {
  DescribedLog described{.scans = std::vector<ArenaScan>(log.scans.size())};
  std::vector<AnyDescriber> describers;
  describers.reserve(thread_count(threads));
  if (named) {
    for (std::size_t t = 0; t < thread_count(threads); ++t) { describers.emplace_back(named->params); }
  }
  std::vector<double> times(log.scans.size());
  parallel_for(log.scans.size(), threads, [&](std::size_t i, std::size_t thread) {
    Features features{detected.keypoints[i], {}};
    const double before = thread_cpu_us();
    if (named) { features.descriptors = describers[thread].describe(log.scans[i], features.keypoints); }
    times[i] = thread_cpu_us() - before;
    described.scans[i] = arena_scan(std::move(features));
  });
  if (!named) { return described; }
  described.describe_us = mean_us(times);
  MatchingCounts sum;
  for (const NextScan& pair : next_scans(log, queries)) {
    sum +=
        count_nearest(described.scans[pair.reference], described.scans[pair.other], pair.reference_from_other, params);
  }
  described.average_precision = average_precision(sum);
  return described;
}

}  // namespace flirt
