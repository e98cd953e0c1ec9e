#include "apps/flirt/speed_log.hpp"

#include "flirt/io/log.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace flirt::app {

SpeedLog simulated_log(std::uint32_t beams, const Session& session) {
  SimulateParams params{
      .lidar = {.beams = beams}, .people = {.count = 10}, .seed = session.seed, .threads = session.threads};
  params.drive.rounds = 1;
  const World office = make_office({.seed = session.seed + 1});
  return {fmt::format("simulated-{}", beams), value_or_quit(simulate(office, params)).log};
}

SpeedLog given_log(const SpeedOptions& options, const Session& session) {
  ScanLog log = value_or_quit(read_log(options.log, {}, progress_bar(session, "reading"))).log;
  if (log.scans.size() < 2 || log.map_from_robot.size() != log.scans.size()) {
    throw BadInput(fmt::format("{}: expected two or more scans with poses, found {} scans and {} poses", options.log,
                               log.scans.size(), log.map_from_robot.size()));
  }
  return {std::filesystem::path(options.log).filename().string(), std::move(log)};
}

std::vector<std::size_t> spread_evenly(std::size_t size, std::size_t count) {
  const std::size_t chosen = std::min(size, count);
  std::vector<std::size_t> indices(chosen);
  for (std::size_t i = 0; i < chosen; ++i) { indices[i] = i * size / chosen; }
  return indices;
}

}  // namespace flirt::app
