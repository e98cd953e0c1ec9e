// flirt/sim/path_search.hpp: shortest ways through a free space.
#pragma once

#include "flirt/sim/free_space.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

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
