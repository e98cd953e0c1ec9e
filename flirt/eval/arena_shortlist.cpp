#include "flirt/eval/arena_shortlist.hpp"

#include "flirt/eval/cpu_time.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace flirt {
namespace {

constexpr std::size_t never = std::numeric_limits<std::size_t>::max();

std::vector<Point2> positions_of(std::span<const Keypoint> keypoints) {
  std::vector<Point2> points;
  points.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) { points.push_back(keypoint.sensor_from_keypoint.translation()); }
  return points;
}

/// Scans by rising distance of their signatures, those without one left out; ties in order.
std::vector<std::size_t> ranking(std::span<const GlarotSignature> signatures, std::size_t query) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < signatures.size(); ++i) {
    const double apart = glarot_distance(signatures[query], signatures[i]).value;
    if (std::isfinite(apart)) { order.emplace_back(apart, i); }
  }
  std::ranges::sort(order);
  std::vector<std::size_t> ranked;
  ranked.reserve(order.size());
  for (const auto& [apart, i] : order) { ranked.push_back(i); }
  return ranked;
}

/// Number of scans in the map ahead of the first one that was taken near the query.
std::size_t rank_of_first_near(const ScanLog& log, std::span<const std::size_t> ranked, std::size_t query,
                               ScanInterval excluded, double near) {
  std::size_t rank = 0;
  for (const std::size_t i : ranked) {
    if (excluded.contains(i)) { continue; }
    if (distance(log.map_from_sensor(i), log.map_from_sensor(query)) <= near) { return rank; }
    ++rank;
  }
  return never;
}

}  // namespace

ShortlistResult bench_shortlist(const std::string& detector, const ScanLog& log,
                                std::span<const std::vector<Keypoint>> keypoints, const ArenaQueries& queries,
                                const ArenaParams& params, std::size_t threads) {
  ShortlistResult result{.detector = detector};
  const auto scans = static_cast<double>(std::max<std::size_t>(1, keypoints.size()));
  std::vector<GlarotSignature> signatures;
  signatures.reserve(keypoints.size());
  const double start = thread_cpu_us();
  for (const auto& own : keypoints) { signatures.push_back(glarot_signature(positions_of(own), params.glarot)); }
  result.build_us = (thread_cpu_us() - start) / scans;

  std::vector<std::array<std::size_t, arena_protocols.size()>> ranks(queries.scans.size());
  std::vector<double> times(queries.scans.size());
  parallel_for(queries.scans.size(), threads, [&](std::size_t k, std::size_t) {
    const double before = thread_cpu_us();
    const std::vector<std::size_t> ranked = ranking(signatures, queries.scans[k]);
    times[k] = (thread_cpu_us() - before) / scans;
    for (const ArenaProtocol protocol : arena_protocols) {
      ranks[k][static_cast<std::size_t>(protocol)] = rank_of_first_near(
          log, ranked, queries.scans[k], queries.excluded(k, protocol), params.tolerance.correct_distance);
    }
  });
  result.compare_us = mean_us(times);
  for (const ArenaProtocol protocol : arena_protocols) {
    auto& recall = result.recall[static_cast<std::size_t>(protocol)];
    for (std::size_t k = 0; k < ranks.size(); ++k) {
      if (!queries.counts(k, protocol)) { continue; }
      for (std::size_t n = 0; n < shortlist_lengths.size(); ++n) {
        ++recall[n].total;
        recall[n].hits += ranks[k][static_cast<std::size_t>(protocol)] < shortlist_lengths[n] ? 1 : 0;
      }
    }
  }
  return result;
}

}  // namespace flirt
