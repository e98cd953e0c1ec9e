// flirt/sim/simulate.hpp: a robot with a laser scanner drives through a floor plan; the truth is known exactly.
//
//   const World office = make_office({.area = 2000});
//   const Result<Simulation> simulation = simulate(office, {.people = {.count = 10}});
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/parallel.hpp"
#include "flirt/core/result.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/sim/drive.hpp"
#include "flirt/sim/floor_plan.hpp"
#include "flirt/sim/lidar.hpp"
#include "flirt/sim/odometry.hpp"
#include "flirt/sim/people.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

struct SimulateParams {
  LidarParams lidar{};
  DriveParams drive{};
  OdometryParams odometry{};
  PeopleParams people{};
  std::uint64_t seed{0};   ///< equal seeds give equal bits on any number of threads
  std::size_t threads{0};  ///< 0: one per processor
};

struct Simulation {
  ScanLog log{};                           ///< map_from_robot is the exact truth; odometry, if any, in the scans
  std::vector<std::size_t> round_begin{};  ///< first scan of each round
  FloorPlan plan{};                        ///< what was driven through
};

/// Drives and measures. Errors: the robot fits nowhere in the plan; the plan is more than 10 km wide or high. O(scans ·
/// beams) besides planning the drive. `progress` is of the measuring, from its first scans on.
[[nodiscard]] Result<Simulation> simulate(const World& world, const SimulateParams& params = {},
                                          const Progress& progress = {});

}  // namespace flirt
