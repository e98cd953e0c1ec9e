// apps/flirt/speed_log.hpp: the scans that the sections of `flirt bench speed` run over.
#pragma once

#include "flirt/core/scan.hpp"

#include "apps/flirt/speed_section.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace flirt::app {

struct SpeedLog {
  std::string name;
  ScanLog log;
};

/// One round through an office of 2000 m², by the session's seed.
[[nodiscard]] SpeedLog simulated_log(std::uint32_t beams, const Session& session);
/// The log of --log, which must have poses. Throws BadInput.
[[nodiscard]] SpeedLog given_log(const SpeedOptions& options, const Session& session);
/// `count` indices spread evenly over 0 .. size − 1; all of them when there are fewer.
[[nodiscard]] std::vector<std::size_t> spread_evenly(std::size_t size, std::size_t count);

}  // namespace flirt::app
