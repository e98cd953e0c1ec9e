// tests/slam/buildings.hpp: simulated drives as mapping keeps their scans, and how far poses are from the truth.
#pragma once

#include "flirt/core/rng.hpp"
#include "flirt/eval/trajectory_metrics.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// One corridor with rooms; `seed` picks the way and all noise, `building` the walls.
inline ScanLog drive_through(std::uint64_t building, std::uint64_t seed, std::uint32_t rounds = 1, double area = 300) {
  SimulateParams params{.seed = seed};
  params.drive.rounds = rounds;
  return simulate(make_office({.area = area, .seed = building}), params)->log;
}

inline std::vector<SlamScan> slam_scans(const ScanLog& log) {
  std::vector<SlamScan> scans;
  for (const Scan& scan : log.scans) {
    scans.push_back({.points = surface_points(scan, {}), .odom_from_robot = scan.odom_from_robot, .scan = scan});
  }
  return scans;
}

inline std::vector<SurfacePoints> points_of(std::span<const SlamScan> scans) {
  std::vector<SurfacePoints> points;
  for (const SlamScan& scan : scans) { points.push_back(scan.points); }
  return points;
}

/// The poses, each off by about `metres` and `radians`, the first one not.
inline std::vector<Pose2> shaken(std::span<const Pose2> poses, double metres, double radians, std::uint64_t seed) {
  std::vector<Pose2> off(poses.begin(), poses.end());
  Rng rng(seed);
  for (std::size_t i = 1; i < off.size(); ++i) {
    off[i] = off[i] * Pose2{metres * rng.normal(), metres * rng.normal(), radians * rng.normal()};
  }
  return off;
}

/// Motions as the poses have them, known to about `metres` and `radians`.
inline PoseGraph chain_of(std::vector<Pose2> poses, double metres, double radians) {
  const Eigen::Vector3d deviation(metres, metres, radians);
  PoseGraph graph{.map_from_node = std::move(poses), .edges = {}};
  for (std::uint32_t i = 1; i < graph.map_from_node.size(); ++i) {
    graph.edges.push_back({i - 1, i, inverse(graph.map_from_node[i - 1]) * graph.map_from_node[i],
                           deviation.cwiseProduct(deviation).cwiseInverse().asDiagonal(), EdgeKind::motion});
  }
  return graph;
}

/// m, root mean square after alignment.
inline double error_of(std::span<const Pose2> poses, std::span<const Pose2> truth) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < poses.size(); ++i) { pairs.push_back({.estimate = poses[i], .truth = truth[i]}); }
  return absolute_error(pairs).translation.rmse;
}

/// A few metres through a small building, which several tests spoil and mend.
inline const ScanLog& short_drive() {
  static const ScanLog log = drive_through(2, 4, 2);
  return log;
}
inline const std::vector<SlamScan>& short_drive_scans() {
  static const std::vector<SlamScan> kept = slam_scans(short_drive());
  return kept;
}

}  // namespace flirt
