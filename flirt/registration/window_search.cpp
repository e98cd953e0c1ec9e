#include "flirt/registration/window_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace flirt {
namespace {

constexpr std::int32_t tile_side = 4;         // places
constexpr std::int32_t tile_headings = 3;     // headings
constexpr std::size_t points_in_a_byte = 17;  // 17 · 15 = 255

using RowSums = std::array<std::uint16_t, LocalMap::row_length>;

/// Sums over the cells of the points, for 32 places side by side.
RowSums row_sums(const LocalMap& map, const std::vector<CellIndex>& cells, std::int32_t x, std::int32_t y) {
  RowSums sums{};
  for (std::size_t begin = 0; begin < cells.size(); begin += points_in_a_byte) {
    const std::size_t end = std::min(cells.size(), begin + points_in_a_byte);
    std::array<std::uint8_t, LocalMap::row_length> bytes{};
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint8_t* row = map.row({cells[i].x + x, cells[i].y + y});
      for (std::size_t k = 0; k < bytes.size(); ++k) { bytes[k] = static_cast<std::uint8_t>(bytes[k] + row[k]); }
    }
    for (std::size_t k = 0; k < bytes.size(); ++k) { sums[k] = static_cast<std::uint16_t>(sums[k] + bytes[k]); }
  }
  return sums;
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
  void add_row(const RowSums& sums, std::int32_t first_x, std::int32_t y, std::int32_t heading) {
    const std::int32_t last_x = std::min(first_x + LocalMap::row_length - 1, reach_);
    Place* row = best_.data() + static_cast<std::ptrdiff_t>((y + reach_) / tile_side) * side_;
    for (std::int32_t x = first_x; x <= last_x; ++x) {
      const Place place{sums[static_cast<std::size_t>(x - first_x)], x, y, heading};
      Place& best = row[(x + reach_) / tile_side];
      if (place.sum >= best.sum && better(place, best)) { best = place; }
    }
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
  TileMaxima maxima(reach);
  std::vector<Place> places;
  const std::int32_t last = all_headings ? turn_steps - 1 : turn_steps;
  for (std::int32_t heading = -turn_steps; heading <= last; ++heading) {
    Pose2 pose = window.map_from_robot;
    pose.theta += heading * step;
    const std::vector<CellIndex> cells = cells_at(picked, pose);
    for (std::int32_t y = -reach; y <= reach; ++y) {
      for (std::int32_t x = -reach; x <= reach; x += LocalMap::row_length) {
        maxima.add_row(row_sums(map, cells, x, y), x, y, heading);
      }
    }
    if ((heading + turn_steps) % tile_headings == tile_headings - 1 || heading == last) {
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
