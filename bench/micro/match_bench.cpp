// Time of one pair of scans: candidates and alignment. All pairs of the chosen scans in turn, as against a map: few of
// them belong together.
#include "flirt/features/extract.hpp"
#include "flirt/match/feature_table.hpp"
#include "flirt/match/pair_matcher.hpp"

#include "bench/micro/scans.hpp"

#include <benchmark/benchmark.h>

#include <cstddef>
#include <vector>

namespace flirt::bench {
namespace {

std::vector<FeatureTable> features_of(const std::vector<Scan>& scans) {
  std::vector<FeatureTable> all;
  all.reserve(scans.size());
  for (const Scan& scan : scans) { all.push_back(feature_table(extract(scan))); }
  return all;
}

/// Goes through all ordered pairs, query by query; `one_pair` is timed with setting the query where it changes.
template <class SetQuery, class OnePair>
void run_pairs(benchmark::State& state, const std::vector<FeatureTable>& all, const SetQuery& set_query,
               const OnePair& one_pair) {
  std::size_t query = 0;
  std::size_t reference = 0;
  for ([[maybe_unused]] auto _ : state) {
    if (reference == 0) { set_query(all[query].columns()); }
    one_pair(all[reference].columns());
    if (++reference == all.size()) {
      reference = 0;
      query = (query + 1) % all.size();
    }
  }
  double keypoints = 0;
  for (const FeatureTable& scan : all) { keypoints += static_cast<double>(scan.features.keypoints.size()); }
  state.counters["keypoints"] = keypoints / static_cast<double>(all.size());
}

void run_candidates(benchmark::State& state, Source source) {
  const std::vector<FeatureTable> all = features_of(scans_of(source));
  if (all.empty()) { return state.SkipWithError("the log is absent"); }
  Matcher matcher;
  run_pairs(
      state, all, [&](const FeatureColumns& query) { matcher.set_query(query.descriptors); },
      [&](const FeatureColumns& reference) { benchmark::DoNotOptimize(matcher.candidates(reference.descriptors)); });
}

void run_match_pair(benchmark::State& state, Source source) {
  const std::vector<FeatureTable> all = features_of(scans_of(source));
  if (all.empty()) { return state.SkipWithError("the log is absent"); }
  PairMatcher matcher;
  run_pairs(
      state, all, [&](const FeatureColumns& query) { matcher.set_query(query); },
      [&](const FeatureColumns& reference) { benchmark::DoNotOptimize(matcher.align(reference)); });
}

BENCHMARK_CAPTURE(run_candidates, simulated_360, Source::simulated_360);
BENCHMARK_CAPTURE(run_candidates, fr079, Source::fr079);
BENCHMARK_CAPTURE(run_match_pair, simulated_360, Source::simulated_360);
BENCHMARK_CAPTURE(run_match_pair, fr079, Source::fr079);

}  // namespace
}  // namespace flirt::bench
