// apps/flirt/speed_section.hpp: one experiment of `flirt bench speed`; each lives in a file speed_NAME.cpp of its name.
//
// A new section is such a file, its declaration below, and one line in the table of bench_speed.cpp.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/io/svg.hpp"

#include "apps/flirt/command.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace flirt::app {

struct SpeedOptions {
  std::string log{};                                            ///< with poses; a simulated office when empty
  std::vector<double> areas{1000, 3000, 10000, 30000, 100000};  ///< m², floors of the buildings
  std::vector<std::size_t> sizes{1000, 10000, 100000};          ///< scans of the maps
  std::size_t queries{100};                                     ///< scans localized in each map
};

/// What an experiment found: a table, row by row with equal keys, and how it grows, drawn.
struct SpeedSection {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  std::optional<svg::Figure> figure{};
};

/// CPU time of this process, µs: what one thread takes, whatever else runs on the machine.
[[nodiscard]] double cpu_us();

/// Seconds of CPU time that `work` takes.
template <class Work>
[[nodiscard]] double seconds_of(const Work& work) {
  const double start = cpu_us();
  work();
  return (cpu_us() - start) * 1e-6;
}

/// The scans of `options.log`, or of a simulated office.
[[nodiscard]] ScanLog speed_log(const SpeedOptions& options, const Session& session);

/// Features, pairs of scans, and queries, stage by stage.
[[nodiscard]] SpeedSection speed_stages(const SpeedOptions& options, const Session& session);
/// Localization of single scans against the area of the map, in simulated offices.
[[nodiscard]] SpeedSection speed_map_area(const SpeedOptions& options, const Session& session);
/// Localization of single scans against the number of map scans: a log's own, again and again at far places.
[[nodiscard]] SpeedSection speed_map_scans(const SpeedOptions& options, const Session& session);

}  // namespace flirt::app
