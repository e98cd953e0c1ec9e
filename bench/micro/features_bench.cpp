// Time of a scan's features, one scan an iteration.
#include "flirt/features/extract.hpp"

#include "bench/micro/scans.hpp"

#include <benchmark/benchmark.h>

#include <cstddef>
#include <numeric>
#include <vector>

namespace flirt::bench {
namespace {

std::vector<std::vector<Keypoint>> keypoints_of(const std::vector<Scan>& scans, const DetectorParams& params) {
  std::vector<std::vector<Keypoint>> keypoints;
  keypoints.reserve(scans.size());
  for (const Scan& scan : scans) { keypoints.push_back(detect(scan, params)); }
  return keypoints;
}

double mean_count(const std::vector<std::vector<Keypoint>>& keypoints) {
  const auto add = [](std::size_t sum, const std::vector<Keypoint>& some) { return sum + some.size(); };
  const std::size_t all = std::accumulate(keypoints.begin(), keypoints.end(), std::size_t{0}, add);
  return static_cast<double>(all) / static_cast<double>(keypoints.size());
}

void run_detect(benchmark::State& state, Source source, const DetectorParams& params) {
  const std::vector<Scan>& scans = scans_of(source);
  if (scans.empty()) { return state.SkipWithError("the log is absent"); }
  Detector detector(params);
  std::size_t i = 0;
  for ([[maybe_unused]] auto _ : state) { benchmark::DoNotOptimize(detector.detect(scans[i++ % scans.size()])); }
  state.counters["beams"] = static_cast<double>(scans.front().ranges.size());
  state.counters["keypoints"] = mean_count(keypoints_of(scans, params));
}

void run_describe(benchmark::State& state, Source source, const DescriptorParams& params) {
  const std::vector<Scan>& scans = scans_of(source);
  if (scans.empty()) { return state.SkipWithError("the log is absent"); }
  const auto keypoints = keypoints_of(scans, {});
  Describer describer(params);
  std::size_t i = 0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(describer.describe(scans[i % scans.size()], keypoints[i % scans.size()]));
    ++i;
  }
  state.counters["beams"] = static_cast<double>(scans.front().ranges.size());
  state.counters["keypoints"] = mean_count(keypoints);
  state.counters["scans_of_24"] = benchmark::Counter(mean_count(keypoints) / 24.0 * static_cast<double>(i),
                                                     benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(run_detect, curvature_simulated_180, Source::simulated_180, CurvatureParams{});
BENCHMARK_CAPTURE(run_detect, curvature_simulated_360, Source::simulated_360, CurvatureParams{});
BENCHMARK_CAPTURE(run_detect, curvature_fr079, Source::fr079, CurvatureParams{});
BENCHMARK_CAPTURE(run_detect, range_simulated_360, Source::simulated_360, RangeParams{});
BENCHMARK_CAPTURE(run_detect, normal_edge_simulated_360, Source::simulated_360, NormalEdgeParams{});
BENCHMARK_CAPTURE(run_detect, normal_blob_simulated_360, Source::simulated_360, NormalBlobParams{});
BENCHMARK_CAPTURE(run_describe, beta_grid_simulated_180, Source::simulated_180, BetaGridParams{});
BENCHMARK_CAPTURE(run_describe, beta_grid_simulated_360, Source::simulated_360, BetaGridParams{});
BENCHMARK_CAPTURE(run_describe, beta_grid_fr079, Source::fr079, BetaGridParams{});
BENCHMARK_CAPTURE(run_describe, shape_context_simulated_360, Source::simulated_360, ShapeContextParams{});

}  // namespace
}  // namespace flirt::bench
