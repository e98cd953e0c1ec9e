// apps/flirt/slam_outputs.hpp: the files of a mapping run.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/slam/slam.hpp"

#include "apps/flirt/command.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace flirt::app {

/// What a run gave.
struct SlamRun {
  std::string log;
  std::string odometry;  ///< "used", "ignored" or "none in the log"
  std::string front_end;
  PoseGraph graph;
  std::vector<SlamStep> steps;
  SlamSummary summary;
  std::vector<double> latency_ms;  ///< of `add`, per scan
  nlohmann::ordered_json params;
  std::uint64_t seed{0};              ///< as given; nothing is drawn at random
  std::optional<SessionJoin> join{};  ///< with an earlier map
  std::size_t earlier_scans{0};       ///< of that map; their nodes come first
};

/// What summary.json holds, and --json prints.
nlohmann::ordered_json slam_json(const SlamRun& run);

/// Quits where one of the files below cannot be written.
void require_slam_outputs(const std::filesystem::path& folder);

/// trajectory.tum, after a join also session.tum with the poses of this run alone, graph.g2o, map.pgm, map.yaml,
/// map.png, map.flirt, report.html and summary.json. The poses of `log` are replaced by those of the run.
void write_slam_outputs(const std::filesystem::path& folder, const SlamRun& run, ScanLog log, const Session& session);

}  // namespace flirt::app
