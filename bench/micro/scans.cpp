#include "bench/micro/scans.hpp"

#include "flirt/io/log.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"

#include "tests/support/data.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace flirt::bench {
namespace {

constexpr std::size_t scan_count = 64;

std::vector<Scan> spread_evenly(const std::vector<Scan>& scans) {
  std::vector<Scan> chosen;
  chosen.reserve(scan_count);
  if (scans.empty()) { return chosen; }
  for (std::size_t i = 0; i < scan_count; ++i) { chosen.push_back(scans[i * scans.size() / scan_count]); }
  return chosen;
}

std::vector<Scan> simulated(std::uint32_t beams) {
  const auto simulation = simulate(make_office({}), {.lidar = {.beams = beams}, .people = {.count = 10}, .seed = 1});
  return simulation ? spread_evenly(simulation->log.scans) : std::vector<Scan>();
}

std::vector<Scan> real() {
  const auto file = data_file("fr079/freiburg-079-corrected.log.gz");
  if (!file) { return {}; }
  const auto loaded = read_log(*file);
  return loaded ? spread_evenly(loaded->log.scans) : std::vector<Scan>();
}

}  // namespace

const std::vector<Scan>& scans_of(Source source) {
  static const std::array<std::vector<Scan>, 3> scans{simulated(180), simulated(360), real()};
  return scans.at(static_cast<std::size_t>(source));
}

}  // namespace flirt::bench
