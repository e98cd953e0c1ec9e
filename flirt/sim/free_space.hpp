// flirt/sim/free_space.hpp: where a disc can go in a floor plan, and on which way.
#pragma once

#include "flirt/sim/cell_grid.hpp"
#include "flirt/sim/floor_plan.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// The points of a plan from which a disc of the given radius touches nothing, on cells of 5 cm (10 cm and more in
/// large buildings). Outside of the plan's bounds nothing is free, nor is what only leads there.
class FreeSpace {
 public:
  /// O(plan + cells).
  FreeSpace(const FloorPlan& plan, double radius);

  /// A lower bound of the distance from the point to the nearest surface, m, within 1.5 cells of the truth.
  [[nodiscard]] double clearance(Point2 point) const;

  /// The disc fits here, and here belongs to the largest connected space. Where two such points are no more than a
  /// cell's diagonal apart the disc fits between them as well: |a − o|² + |b − o|² = 2|m − o|² + 2|a − m|² for any
  /// point o of a surface and the middle m.
  [[nodiscard]] bool contains(Point2 point) const;

  /// Every point of the straight way from a to b is in the space, by samples less than a cell's diagonal apart.
  [[nodiscard]] bool contains(Point2 a, Point2 b) const;

  /// Area of the space, m².
  [[nodiscard]] double area() const;

  /// The nearest point of the space within `reach` m, itself if it is one; an empty list when there is none.
  [[nodiscard]] std::vector<Point2> nearest(Point2 point, double reach) const;

  /// Points of the space at least `spacing` m apart, in an order given by the seed, until no other fits.
  [[nodiscard]] std::vector<Point2> spread(double spacing, std::uint64_t seed) const;

  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] double cell_size() const { return cell_size_; }

  friend class PathSearch;

 private:
  [[nodiscard]] std::int64_t cell_of(Point2 point) const;  ///< −1 outside
  [[nodiscard]] Point2 center_of(std::size_t cell) const;
  void measure_distances(const FloorPlan& plan);
  void keep_largest_space();

  double radius_;
  double needed_clearance_{0};  ///< m; more than the radius, so that steps between neighbouring cells keep it as well
  double cell_size_{0};
  Point2 origin_;
  std::int32_t columns_{0};
  std::int32_t rows_{0};
  std::vector<float> distance_;       ///< m, from a cell's centre to the centre of the nearest cell with a surface
  std::vector<std::uint8_t> inside_;  ///< 1: the disc may stand in this cell
};

/// Shortest ways through a free space. Keeps its working memory from one question to the next.
class PathSearch {
 public:
  explicit PathSearch(const FreeSpace& space);

  /// Cell centres of a shortest way that prefers the middle of what is free, from `start` to `goal`, both included
  /// (A*, 8 neighbours). Empty when there is none. O(cells · log cells) at worst, less when the goal is near.
  [[nodiscard]] std::vector<Point2> path(Point2 start, Point2 goal);

  struct Found {
    std::size_t goal{0};  ///< index into the goals
    std::vector<Point2> path{};
  };
  /// The way to the nearest of the goals; an empty path when none can be reached.
  [[nodiscard]] Found path_to_nearest(Point2 start, std::span<const Point2> goals);

 private:
  template <class IsGoal, class Estimate>
  std::int64_t search(std::size_t start, const IsGoal& is_goal, const Estimate& estimate);
  [[nodiscard]] std::vector<Point2> trace_back(std::size_t start, std::size_t goal) const;

  const FreeSpace& space_;
  std::uint32_t round_{0};
  std::vector<std::uint32_t> seen_in_;  ///< the round in which cost_ and from_ of a cell were written
  std::vector<float> cost_;
  std::vector<std::uint8_t> from_;     ///< number of the neighbour from which the cell was reached
  std::vector<std::int64_t> goal_at_;  ///< for path_to_nearest: index of a goal in this cell, −1: none
};

}  // namespace flirt
