#include "flirt/sim/path_search.hpp"

#include <algorithm>
#include <queue>

namespace flirt {
namespace {

constexpr double comfort = 0.6;        // m, clearance above which a way costs no more than its length
constexpr double crowding_cost = 4.0;  // added cost per m at no clearance

}  // namespace

PathSearch::PathSearch(const FreeSpace& space)
    : space_(space),
      seen_in_(space.inside_.size(), 0),
      cost_(space.inside_.size()),
      from_(space.inside_.size()),
      goal_at_(space.inside_.size(), -1) {}

/// A*: the goal's cell, or −1. Ties go to the lower cell number, so that the way is always the same.
template <class IsGoal, class Estimate>
std::int64_t PathSearch::search(std::size_t start, const IsGoal& is_goal, const Estimate& estimate) {
  struct Open {
    float bound;
    float cost;
    std::size_t cell;
    bool operator<(const Open& other) const { return bound != other.bound ? bound > other.bound : cell > other.cell; }
  };
  ++round_;
  std::priority_queue<Open> open;
  seen_in_[start] = round_;
  cost_[start] = 0;
  open.push({estimate(start), 0, start});
  const auto columns = static_cast<std::int32_t>(space_.columns_);
  while (!open.empty()) {
    const Open current = open.top();
    open.pop();
    if (current.cost > cost_[current.cell]) { continue; }  // a better way was found meanwhile
    if (is_goal(current.cell)) { return static_cast<std::int64_t>(current.cell); }
    for (std::size_t k = 0; k < cell_steps.size(); ++k) {
      const auto x = static_cast<std::int32_t>(current.cell % static_cast<std::size_t>(columns)) + cell_steps[k].right;
      const auto y = static_cast<std::int32_t>(current.cell / static_cast<std::size_t>(columns)) + cell_steps[k].up;
      if (x < 0 || x >= columns || y < 0 || y >= space_.rows_) { continue; }
      const std::size_t next =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x);
      if (space_.inside_[next] == 0) { continue; }
      const double crowding = std::max(0.0, 1 - space_.distance_[next] / comfort);
      const float cost = current.cost + cell_steps[k].length * static_cast<float>(1 + crowding_cost * crowding);
      if (seen_in_[next] == round_ && cost_[next] <= cost) { continue; }
      seen_in_[next] = round_;
      cost_[next] = cost;
      from_[next] = static_cast<std::uint8_t>(k);
      open.push({cost + estimate(next), cost, next});
    }
  }
  return -1;
}

std::vector<Point2> PathSearch::trace_back(std::size_t start, std::size_t goal) const {
  std::vector<Point2> points{space_.center_of(goal)};
  for (std::size_t cell = goal; cell != start;) {
    const CellStep& step = cell_steps[from_[cell]];
    cell = static_cast<std::size_t>(static_cast<std::int64_t>(cell) - step.right -
                                    static_cast<std::int64_t>(step.up) * space_.columns_);
    points.push_back(space_.center_of(cell));
  }
  std::reverse(points.begin(), points.end());
  return points;
}

std::vector<Point2> PathSearch::path(Point2 start, Point2 goal) {
  const std::int64_t start_cell = space_.cell_of(start);
  const std::int64_t goal_cell = space_.cell_of(goal);
  if (start_cell < 0 || goal_cell < 0) { return {}; }
  const Point2 aim = space_.center_of(static_cast<std::size_t>(goal_cell));
  const std::int64_t found = search(
      static_cast<std::size_t>(start_cell),
      [&](std::size_t cell) { return static_cast<std::int64_t>(cell) == goal_cell; },
      [&](std::size_t cell) { return static_cast<float>(norm(space_.center_of(cell) - aim) / space_.cell_size_); });
  if (found < 0) { return {}; }
  return trace_back(static_cast<std::size_t>(start_cell), static_cast<std::size_t>(found));
}

PathSearch::Found PathSearch::path_to_nearest(Point2 start, std::span<const Point2> goals) {
  const std::int64_t start_cell = space_.cell_of(start);
  if (start_cell < 0) { return {}; }
  std::vector<std::size_t> marked;
  for (std::size_t i = goals.size(); i-- > 0;) {  // the first of several in a cell stays
    const std::int64_t cell = space_.cell_of(goals[i]);
    if (cell < 0) { continue; }
    goal_at_[static_cast<std::size_t>(cell)] = static_cast<std::int64_t>(i);
    marked.push_back(static_cast<std::size_t>(cell));
  }
  const std::int64_t found = search(
      static_cast<std::size_t>(start_cell), [&](std::size_t cell) { return goal_at_[cell] >= 0; },
      [](std::size_t) { return 0.0F; });
  Found result;
  if (found >= 0) {
    result.goal = static_cast<std::size_t>(goal_at_[static_cast<std::size_t>(found)]);
    result.path = trace_back(static_cast<std::size_t>(start_cell), static_cast<std::size_t>(found));
  }
  for (const std::size_t cell : marked) { goal_at_[cell] = -1; }
  return result;
}

}  // namespace flirt
