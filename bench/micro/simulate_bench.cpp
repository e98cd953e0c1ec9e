// Time of one simulated scan, robot poses and people given. items_per_second is scans/s on one core.
#include "flirt/sim/lidar.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>

namespace flirt::bench {
namespace {

void run_measure(benchmark::State& state) {
  const World office = make_office({});
  const auto simulation = simulate(office, {.seed = 1});
  if (!simulation) { return state.SkipWithError("no way through the office"); }
  const LidarParams params{.beams = static_cast<std::uint32_t>(state.range(0))};
  const Lidar lidar(params);
  const RayCaster caster(office.plan);
  std::size_t i = 0;
  for ([[maybe_unused]] auto _ : state) {
    Rng rng(1, i);
    const Pose2 map_from_sensor = simulation->log.map_from_sensor(i++ % simulation->log.scans.size());
    benchmark::DoNotOptimize(lidar.measure(caster, {}, map_from_sensor, rng));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(run_measure)->Arg(180)->Arg(360)->Arg(1080);

}  // namespace
}  // namespace flirt::bench
