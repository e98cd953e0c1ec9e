// apps/flirt/bench_locations.hpp: logs and reference locations of the experiments on single features.
#pragma once

#include "flirt/eval/transform_cases.hpp"

#include "apps/flirt/bench_table.hpp"
#include "apps/flirt/command.hpp"

#include <CLI/CLI.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace flirt::app {

/// LOG..., --locations and --partners.
struct LocationFlags {
  std::vector<std::string> logs;
  std::size_t count{0};  ///< in all; 0: 20 a log, as in the papers

  /// `partners` are those of the bench's parameters.
  void add(CLI::App& command, std::uint32_t& partners);
};

struct ReferenceLocations {
  std::vector<std::string> names{};  ///< of the logs: file names
  std::vector<ScanLog> logs{};
  std::vector<Location> locations{};
};

/// Reads the logs, which must have poses, and draws the locations evenly from them. Throws BadInput.
ReferenceLocations read_locations(const LocationFlags& flags, const Session& session);

/// The list that is saved beside the results: log, scan, true pose of the sensor.
Table locations_table(const ReferenceLocations& reference);

/// "viewpoint", …: with the unit of the level.
std::string level_label(ScanTransform transform);

}  // namespace flirt::app
