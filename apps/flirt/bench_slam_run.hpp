// apps/flirt/bench_slam_run.hpp: one method on one log, and how well it did.
#pragma once

#include "flirt/eval/map_quality.hpp"
#include "flirt/eval/trajectory_metrics.hpp"
#include "flirt/slam/rbpf_params.hpp"
#include "flirt/slam/slam_params.hpp"

#include "apps/flirt/bench_slam_input.hpp"
#include "apps/flirt/latency.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt::app {

struct SlamMethods {
  SlamParams slam;
  RbpfParams rbpf;
};

/// Edges between revisited places against the truth.
struct Closures {
  std::size_t accepted{0};
  std::size_t wrong{0};  ///< more than 0.5 m or 10° off, of those whose ends have a true pose
};

struct SlamRow {
  std::string method;    ///< a front end's name, "rbpf", or "odometry", "corrected": what the log itself says
  std::string odometry;  ///< "own", "synthetic", or "none"
  std::vector<Pose2> map_from_robot{};
  std::vector<std::pair<Point2, Point2>> closure_lines{};  ///< m, map frame
  std::optional<TrajectoryError> ate{};
  std::optional<TrajectoryError> rpe{};  ///< over 1 m
  std::optional<RelationsError> relations{};
  std::string_view relations_source{"official"};  ///< or "derived" from the truth: no official one has both stamps
  std::optional<Closures> closures{};
  MapQuality quality{};
  double cpu_seconds{0};
  Latency latency{};
  double memory_mb{0};  ///< peak of the whole process, log included
  bool mapped{true};    ///< false: what the log itself says
};

/// Names of all methods: the front ends, then rbpf.
std::vector<std::string> slam_methods();

struct MappingResult {
  std::vector<Pose2> map_from_robot;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> loop_nodes;
  std::vector<Pose2> loop_motions;  ///< a_from_b of the same edges
  bool has_loops{false};
  double cpu_seconds{0};
  std::vector<double> latency_ms;
  double memory_mb{0};
};
/// Maps all scans by the method; `odometry` says whether the scans' own is used.
MappingResult map_scans(const ScanLog& log, const std::string& method, OdometryUse odometry, SlamMethods methods,
                        const Session& session, const Progress& progress = {});

/// Maps and judges.
SlamRow run_method(const SlamInput& input, const std::string& method, OdometryUse odometry, const SlamMethods& methods,
                   const Session& session);
/// What the log's own odometry and its corrected poses are worth, where it has them.
std::vector<SlamRow> rows_of_log(const SlamInput& input, const Session& session);

/// Share of runs without odometry, from poses drawn around the origin, that keep the bound.
struct JitteredStarts {
  std::string name;
  std::string method;
  std::vector<double> ate{};  ///< m, one a start
  double bound{0};            ///< m
  std::size_t kept{0};
};
JitteredStarts run_starts(const SlamInput& input, const std::string& method, std::size_t starts,
                          const SlamMethods& methods, const Session& session);

}  // namespace flirt::app
