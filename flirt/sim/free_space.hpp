// flirt/sim/free_space.hpp: where a disc can go in a floor plan.
#pragma once

#include "flirt/sim/floor_plan.hpp"
#include "flirt/sim/ray_caster.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

/// To one of the eight cells around.
struct CellStep {
  std::int32_t right;
  std::int32_t up;
  float length;  ///< cells
};
inline constexpr std::array<CellStep, 8> cell_steps{{{1, 0, 1.0F},
                                                     {1, 1, 1.41421356F},
                                                     {0, 1, 1.0F},
                                                     {-1, 1, 1.41421356F},
                                                     {-1, 0, 1.0F},
                                                     {-1, -1, 1.41421356F},
                                                     {0, -1, 1.0F},
                                                     {1, -1, 1.41421356F}}};

/// The points of a plan from which a disc of the given radius touches nothing, on cells of 5 cm (10 cm and more in
/// large buildings). Outside of the plan's bounds nothing is free. Of several spaces without a way between
/// them it is the one with the largest enclosed area: a building's inside, not its surroundings.
class FreeSpace {
 public:
  /// O(plan + cells).
  FreeSpace(const FloorPlan& plan, double radius);

  /// A lower bound of the distance from the point to the nearest surface, m, within 1.5 cells of the truth.
  [[nodiscard]] double clearance(Point2 point) const;

  /// The disc fits here, and here belongs to the space. Where two such points are no more than a
  /// cell's diagonal apart the disc fits between them as well: |a − o|² + |b − o|² = 2|m − o|² + 2|a − m|² for any
  /// point o of a surface and the middle m.
  [[nodiscard]] bool contains(Point2 point) const;

  /// Every point of the straight way from a to b is in the space, by samples less than a cell's diagonal apart.
  [[nodiscard]] bool contains(Point2 a, Point2 b) const;

  /// Something is to be seen within 20 m in three of four directions: indoors, or so.
  [[nodiscard]] bool is_enclosed(Point2 point) const;

  /// Area of the space, m².
  [[nodiscard]] double area() const;

  /// The nearest point of the space within `reach` m, itself if it is one; an empty list when there is none.
  [[nodiscard]] std::vector<Point2> nearest(Point2 point, double reach) const;

  /// Points of the space at least `spacing` m apart, in an order given by the seed, until no other fits; only the
  /// enclosed ones unless they are less than a fifth.
  [[nodiscard]] std::vector<Point2> spread(double spacing, std::uint64_t seed) const;

  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] double cell_size() const { return cell_size_; }

  friend class PathSearch;

 private:
  [[nodiscard]] std::int64_t cell_of(Point2 point) const;  ///< −1 outside
  [[nodiscard]] Point2 center_of(std::size_t cell) const;
  void measure_distances(const FloorPlan& plan);
  void keep_one_space();
  [[nodiscard]] std::vector<std::size_t> connected_cells(std::size_t first, std::vector<std::uint8_t>& seen) const;
  [[nodiscard]] std::size_t enclosed_cells(const std::vector<std::size_t>& cells) const;

  double radius_;
  double needed_clearance_{0};  ///< m; more than the radius, so that steps between neighbouring cells keep it as well
  double cell_size_{0};
  Point2 origin_;
  std::int32_t columns_{0};
  std::int32_t rows_{0};
  RayCaster caster_;
  std::vector<float> distance_;       ///< m, from a cell's centre to the centre of the nearest cell with a surface
  std::vector<std::uint8_t> inside_;  ///< 1: the disc may stand in this cell
};

}  // namespace flirt
