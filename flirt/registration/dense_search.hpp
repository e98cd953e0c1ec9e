// flirt/registration/dense_search.hpp: all poses of a scan in a map, tried on a coarse grid of places and headings.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/registration/map_fields.hpp"
#include "flirt/registration/scan_points.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

struct DenseSearchParams {
  double heading_step{radians_from_degrees(3)};   ///< rad, rounded so that a whole number of steps makes a turn
  std::uint32_t headings_per_tile{3};             ///< neighbouring headings of which only the best place is kept
  std::uint32_t largest_point_count{120};         ///< end points used, evenly picked
  std::uint32_t candidates{1000};                 ///< best tiles of 4 × 4 coarse cells × headings_per_tile kept
  double near_distance{3.0};                      ///< m around a given place that is searched
  double near_heading{radians_from_degrees(12)};  ///< rad on both sides of a given heading
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, DenseSearchParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.heading_step, Field{"heading_step", "rad", "between headings tried", 0.005, 0.5});
  visit(params.headings_per_tile, Field{"headings_per_tile", "", "headings of which the best is kept", 1, 16});
  visit(params.largest_point_count, Field{"largest_point_count", "", "end points used by the dense search", 8, 250});
  visit(params.candidates, Field{"candidates", "", "places kept by the dense search", 1, 1000000});
  visit(params.near_distance, Field{"near_distance", "m", "around a place voted for that is searched", 0, 100});
  visit(params.near_heading, Field{"near_heading", "rad", "around a heading voted for that is searched", 0, 3.2});
}

/// A pose of the coarse grid with its mean value over the end points.
struct CoarsePose {
  Pose2 map_from_sensor;
  float value{0};  ///< 0..1: 0 when all end points lie in free space, 1 when all lie on something occupied
};

/// Tries each heading at each coarse cell in which a robot can have been, and keeps the best pose of each tile, best
/// tiles first. Exhaustive: whole blocks of cells are added up in bytes (Olson 2009 without the bound: at this
/// resolution adding 32 cells at once is cheaper than deciding which to leave out). Integer sums: the same on every
/// processor. O(headings · cells · points / 32).
[[nodiscard]] std::vector<CoarsePose> dense_search(const MapFields& fields, const ScanPoints& points,
                                                   const DenseSearchParams& params = {});

/// The same around given places alone, in whole blocks of 32 × 4 coarse cells.
[[nodiscard]] std::vector<CoarsePose> dense_search_near(const MapFields& fields, const ScanPoints& points,
                                                        std::span<const Pose2> map_from_sensor,
                                                        const DenseSearchParams& params = {});

}  // namespace flirt
