// apps/flirt/bench_slam_dynamic.hpp: incremental mapping among people, and mapping for a long time.
#pragma once

#include "apps/flirt/bench_slam_run.hpp"
#include "apps/flirt/bench_slam_tables.hpp"

#include <string>
#include <vector>

namespace flirt::app {

/// Mapping without odometry and closures, by the last `window` scans; the way begins at the true pose.
struct DynamicRun {
  std::string place;  ///< "tunnel" or "station"
  std::string method;
  ScanLog log;                          ///< map_from_robot is the truth
  std::vector<Pose2> map_from_robot{};  ///< found, in the frame of the truth
  double way{0};                        ///< m, driven
  double end_distance{0};               ///< m, of the last pose from the true one
  double end_degrees{0};
  TrajectoryError ate{};
  double cpu_seconds{0};
};
/// The navigation paper's two experiments at a station (section 4.2), simulated.
std::vector<std::string> dynamic_places();
/// Each place by each method.
std::vector<DynamicRun> run_dynamic(const std::vector<std::string>& places, const std::vector<std::string>& methods,
                                    const SlamMethods& methods_params, const Session& session);
TextTable dynamic_table(const std::vector<DynamicRun>& runs);
nlohmann::ordered_json dynamic_json(const std::vector<DynamicRun>& runs);

/// Many scans in one building.
struct LongRun {
  std::size_t scans{0};
  Latency all{};
  Latency first_quarter{};
  Latency last_quarter{};
  double bytes_per_scan{0};  ///< growth of the process over the last three quarters
  double cpu_seconds{0};
  double ate{0};  ///< m, before the joint alignment at the end
};
LongRun run_long(std::size_t scans, const SlamParams& params, const Session& session);
TextTable long_table(const LongRun& run);
nlohmann::ordered_json long_json(const LongRun& run);

}  // namespace flirt::app
