// apps/flirt/speed_section.hpp: one experiment of `flirt bench speed`; each lives in a file speed_NAME.cpp of its name.
//
// A new section is such a file, its declaration below, and one line in the table of bench_speed.cpp.
#pragma once

#include "flirt/io/svg.hpp"

#include "apps/flirt/command.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace flirt::app {

struct SpeedOptions {
  std::vector<double> areas{1000, 3000, 10000, 30000, 100000};  ///< m², floors of the buildings
  std::size_t queries{100};                                     ///< scans localized in each map
  std::string log{};                                            ///< file with poses; empty: simulated scans
  std::vector<std::size_t> sizes{1000, 10000, 100000};          ///< map scans
};

/// What an experiment found: a table, row by row with equal keys, and the same drawn.
struct SpeedSection {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  svg::Figure figure{};
};

/// Each stage for one scan, beside the targets.
[[nodiscard]] SpeedSection speed_stages(const SpeedOptions& options, const Session& session);

/// The papers' method against the number of map scans: all of them, and those that an index over words leaves.
[[nodiscard]] SpeedSection speed_map_size(const SpeedOptions& options, const Session& session);

/// Localization of single scans against the area of the map, in simulated offices.
[[nodiscard]] SpeedSection speed_map_area(const SpeedOptions& options, const Session& session);

}  // namespace flirt::app
