// flirt/eval/buildings.hpp: single scans found in buildings whose truth is exact, with people in the way.
//
// In a simulated building it is known which scans only one place explains: the truth at the place and the truth at any
// other place proposed can be compared beam by beam, without noise, people or map. Of those scans all should be found.
#pragma once

#include "flirt/core/parallel.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/eval/localization_answer.hpp"
#include "flirt/eval/statistics.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/sim/floor_plan.hpp"
#include "flirt/sim/lidar.hpp"
#include "flirt/sim/ray_caster.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

struct BuildingBenchParams {
  double people{0};           ///< share of the beams that end on people, at least; never without a wall behind
  double same_range{0.1};     ///< m, two beams that differ by no more see the same
  double told_apart{0.1};     ///< share of the beams that see something else from a place that is told apart
  std::size_t min_beams{20};  ///< beams that see the building; scans with fewer are not asked
  PoseTolerance tolerance{};
  LocalizeParams localize{};
  std::uint64_t seed{0};
};

/// A scan with its place.
struct BuildingQuery {
  Scan scan{};
  Pose2 map_from_sensor{};            ///< the truth
  std::vector<double> true_ranges{};  ///< m, of the building alone, without noise
  std::vector<char> sees_building{};  ///< 1: the beam ended on the building
};

struct BuildingAnswer {
  BuildingQuery query{};
  LocalizationResult result{};
  bool is_unique{false};  ///< no other hypothesis sees the same
  bool is_right{false};
};

struct BuildingBench {
  Rate success{};        ///< right, of the scans that one place alone explains
  Rate twins_right{};    ///< right, of the others
  Rate called_unique{};  ///< right and called unique, of the scans that one place alone explains
  Rate unique_right{};   ///< right, of all called unique
  double people{0};      ///< mean share of the returning beams that ended on people
  std::vector<BuildingAnswer> answers{};
};

/// Share of the beams for which `ranges` and `others` differ by more than `same_range`, of those that see the building.
[[nodiscard]] double differing_share(std::span<const double> ranges, std::span<const double> others,
                                     std::span<const char> sees_building, double same_range);

/// A scan at a place, with pairs of legs put in its way until enough beams end on them.
[[nodiscard]] BuildingQuery building_query(const RayCaster& caster, const LidarParams& lidar,
                                           const Pose2& map_from_sensor, double people, std::uint64_t seed);

/// Asks `map`, which is of the building `plan`, for scans at the given places. The same on any number of threads.
[[nodiscard]] BuildingBench bench_building(const FloorPlan& plan, const PlaceMap& map, const LidarParams& lidar,
                                           std::span<const Pose2> map_from_sensor, const BuildingBenchParams& params,
                                           std::size_t threads, const Progress& progress = {});

}  // namespace flirt
