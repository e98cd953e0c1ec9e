#include "flirt/registration/window_search.hpp"

#include "flirt/registration/window_bounds.hpp"
#include "flirt/registration/window_kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace flirt {
namespace {

constexpr std::int32_t tile_side = WindowBounds::tile_side;
constexpr std::size_t tile_headings = 3;
constexpr std::int32_t worth_bounds = 10;  // cells of reach; in smaller windows bounds cost more than they save

using window::RowSums;

/// Sums over the cells of the points, for 32 places side by side. `offsets` is room for as many numbers.
RowSums row_sums(const LocalMap& map, std::span<const CellIndex> cells, std::int32_t x, std::int32_t y,
                 std::span<std::int32_t> offsets) {
  window::row_offsets(cells, x, y, offsets);
  return window::sum_rows(map.values(), offsets);
}

/// At most about `most` points, evenly picked.
std::vector<Point2> picked_points(std::span<const SurfacePoints> scans, std::size_t most) {
  std::size_t all = 0;
  for (const SurfacePoints& points : scans) { all += points.size(); }
  std::vector<Point2> picked;
  std::size_t owed = most / 2;  // picks one point when it reaches `all`
  for (const SurfacePoints& points : scans) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      owed += std::min(most, all);
      if (owed < all) { continue; }
      owed -= all;
      picked.push_back({points.x[i], points.y[i]});
    }
  }
  return picked;
}

/// Cells of the points at a pose.
std::vector<CellIndex> cells_at(const std::vector<Point2>& points, const Pose2& map_from_robot) {
  const double c = std::cos(map_from_robot.theta) / LocalMap::cell_size;
  const double s = std::sin(map_from_robot.theta) / LocalMap::cell_size;
  const double x0 = map_from_robot.x / LocalMap::cell_size;
  const double y0 = map_from_robot.y / LocalMap::cell_size;
  std::vector<CellIndex> cells;
  cells.reserve(points.size());
  for (const Point2& point : points) {
    cells.push_back({static_cast<std::int32_t>(std::floor(x0 + c * point.x - s * point.y)),
                     static_cast<std::int32_t>(std::floor(y0 + s * point.x + c * point.y))});
  }
  return cells;
}

struct Place {
  std::int32_t sum{-1};
  std::int32_t x{0};        // cells from the middle
  std::int32_t y{0};        // cells from the middle
  std::int32_t heading{0};  // steps from the middle
};

/// Better first; a fixed order among equals, nearer to the middle first.
bool better(const Place& a, const Place& b) {
  if (a.sum != b.sum) { return a.sum > b.sum; }
  const auto from_middle = [](const Place& p) { return p.x * p.x + p.y * p.y + p.heading * p.heading; };
  if (from_middle(a) != from_middle(b)) { return from_middle(a) < from_middle(b); }
  return std::array{a.heading, a.y, a.x} < std::array{b.heading, b.y, b.x};
}

/// The best place of each tile of places, over the headings since the last `clear`.
class TileMaxima {
 public:
  explicit TileMaxima(std::int32_t reach) : reach_(reach), side_((2 * reach + tile_side) / tile_side) { clear(); }

  void clear() { best_.assign(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), Place{}); }
  /// Returns the best sum of the row.
  std::int32_t add_row(const RowSums& sums, std::int32_t first_x, std::int32_t y, std::int32_t heading) {
    std::int32_t largest = 0;
    const std::int32_t last_x = std::min(first_x + LocalMap::row_length - 1, reach_);
    Place* row = best_.data() + static_cast<std::ptrdiff_t>((y + reach_) / tile_side) * side_;
    for (std::int32_t x = first_x; x <= last_x; ++x) {
      const Place place{sums[static_cast<std::size_t>(x - first_x)], x, y, heading};
      Place& best = row[(x + reach_) / tile_side];
      largest = std::max(largest, place.sum);
      if (place.sum >= best.sum && better(place, best)) { best = place; }
    }
    return largest;
  }
  void append_to(std::vector<Place>& places) const {
    for (const Place& place : best_) {
      if (place.sum > 0) { places.push_back(place); }
    }
  }

 private:
  std::int32_t reach_;
  std::int32_t side_;
  std::vector<Place> best_;
};

/// The rows of places where something may still reach the share of the best that is asked for.
class Promising {
 public:
  Promising(const LocalMap& map, std::span<const std::vector<CellIndex>> cells, std::span<const Point2> points,
            const SearchWindow& window, std::int32_t reach)
      : keep_(window.keep), reach_(reach) {
    if (keep_ <= 0 || reach < worth_bounds) { return; }
    const WindowBounds bounds(map, middle_of(window), radius_of(points), reach);
    strips_ = bounds.strips();
    for (const std::vector<CellIndex>& at_heading : cells) { bounds_.push_back(bounds.of(at_heading)); }
    raise(best_of_most_promising(map, cells));
  }

  void raise(std::int32_t sum) { best_ = std::max(best_, sum); }
  template <class Visit>
  void for_each_row(std::size_t heading, const Visit& visit) const {
    for (std::int32_t y = -reach_; y <= reach_; ++y) {
      for (std::int32_t x = -reach_; x <= reach_; x += LocalMap::row_length) {
        if (is_promising(heading, x, y)) { visit(x, y); }
      }
    }
  }

 private:
  static CellIndex middle_of(const SearchWindow& window) {
    return {static_cast<std::int32_t>(std::floor(window.map_from_robot.x / LocalMap::cell_size)),
            static_cast<std::int32_t>(std::floor(window.map_from_robot.y / LocalMap::cell_size))};
  }
  static std::int32_t radius_of(std::span<const Point2> points) {
    double farthest = 0;
    for (const Point2& point : points) { farthest = std::max(farthest, norm(point)); }
    return static_cast<std::int32_t>(farthest / LocalMap::cell_size) + 2;
  }
  [[nodiscard]] std::int32_t bound(std::size_t heading, std::int32_t x, std::int32_t y) const {
    const std::int32_t strip = (y + reach_) / tile_side * strips_ + (x + reach_) / LocalMap::row_length;
    return bounds_[heading][static_cast<std::size_t>(strip)];
  }
  [[nodiscard]] bool is_promising(std::size_t heading, std::int32_t x, std::int32_t y) const {
    return bounds_.empty() || bound(heading, x, y) >= keep_ * best_;
  }
  /// The best sum at the heading with the highest bound: what the others have to come near to.
  [[nodiscard]] std::int32_t best_of_most_promising(const LocalMap& map,
                                                    std::span<const std::vector<CellIndex>> cells) const {
    const auto highest = [](const std::vector<std::uint16_t>& all) { return std::ranges::max(all); };
    const auto most = std::ranges::max_element(bounds_, {}, highest);
    const std::uint16_t limit = highest(*most);
    const auto heading = static_cast<std::size_t>(most - bounds_.begin());
    std::int32_t best = 0;
    std::vector<std::int32_t> offsets(cells[heading].size());
    for_each_row(heading, [&](std::int32_t x, std::int32_t y) {
      if (bound(heading, x, y) < limit) { return; }
      const RowSums sums = row_sums(map, cells[heading], x, y, offsets);
      const std::int32_t last_x = std::min(LocalMap::row_length, reach_ - x + 1);
      best = std::max<std::int32_t>(best, *std::max_element(sums.begin(), sums.begin() + last_x));
    });
    return best;
  }

  double keep_;
  std::int32_t reach_;
  std::int32_t strips_{0};
  std::int32_t best_{0};
  std::vector<std::vector<std::uint16_t>> bounds_{};  // per heading; empty: all is promising
};

std::vector<WindowPose> distinct(const std::vector<Place>& places, const SearchWindow& window, double step,
                                 std::size_t points) {
  std::vector<WindowPose> kept;
  for (const Place& place : places) {
    if (kept.size() == window.candidates) { break; }
    const Pose2& middle = window.map_from_robot;
    const Pose2 pose{middle.x + place.x * LocalMap::cell_size, middle.y + place.y * LocalMap::cell_size,
                     wrap_angle(middle.theta + place.heading * step)};
    const bool known = std::ranges::any_of(kept, [&](const WindowPose& other) {
      return distance(pose, other.map_from_robot) < window.distinct_distance &&
             heading_difference(pose, other.map_from_robot) < window.distinct_heading;
    });
    if (known) { continue; }
    kept.push_back({pose, place.sum / (static_cast<double>(LocalMap::largest) * static_cast<double>(points))});
  }
  return kept;
}

}  // namespace

std::vector<WindowPose> search_window(const LocalMap& map, std::span<const SurfacePoints> scans,
                                      const SearchWindow& window) {
  const std::vector<Point2> picked = picked_points(scans, window.most_points);
  if (picked.empty()) { return {}; }
  const auto reach = static_cast<std::int32_t>(std::ceil(window.half_extent / LocalMap::cell_size));
  constexpr double half_turn = std::numbers::pi;
  const bool all_headings = window.half_turn >= half_turn;
  const auto turn_steps =
      static_cast<std::int32_t>(std::ceil((all_headings ? half_turn : window.half_turn) / window.heading_step));
  const double step = all_headings ? half_turn / turn_steps : window.heading_step;
  const std::int32_t last = all_headings ? turn_steps - 1 : turn_steps;
  std::vector<std::vector<CellIndex>> cells;
  for (std::int32_t heading = -turn_steps; heading <= last; ++heading) {
    Pose2 pose = window.map_from_robot;
    pose.theta += heading * step;
    cells.push_back(cells_at(picked, pose));
  }
  Promising promising(map, cells, picked, window, reach);
  TileMaxima maxima(reach);
  std::vector<Place> places;
  std::vector<std::int32_t> offsets(picked.size());
  for (std::int32_t heading = -turn_steps; heading <= last; ++heading) {
    const std::int32_t from_first = heading + turn_steps;
    const auto index = static_cast<std::size_t>(from_first);
    promising.for_each_row(index, [&](std::int32_t x, std::int32_t y) {
      const RowSums sums = row_sums(map, cells[index], x, y, offsets);
      promising.raise(maxima.add_row(sums, x, y, heading));
    });
    if (index % tile_headings == tile_headings - 1 || heading == last) {
      maxima.append_to(places);
      maxima.clear();
    }
  }
  // Many more than are kept, as neighbours of the best come first.
  const auto sorted = static_cast<std::ptrdiff_t>(std::min(places.size(), 40 * window.candidates));
  std::ranges::partial_sort(places, places.begin() + sorted, better);
  places.resize(static_cast<std::size_t>(sorted));
  return distinct(places, window, step, picked.size());
}

}  // namespace flirt
