#include "flirt/registration/dense_search.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/registration/dense_kernels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <utility>

namespace flirt {
namespace {

using dense::PairKeys;
using dense::Steps;

constexpr std::size_t panel_pairs = CoarseField::panel_pairs;
constexpr std::size_t tiles_per_panel = 2 * panel_pairs;

/// Headings that divide a full turn evenly.
struct Headings {
  std::size_t count;
  double step;  // rad
};

Headings headings_of(const DenseSearchParams& params) {
  const auto count = static_cast<std::size_t>(std::ceil(2 * std::numbers::pi / params.heading_step - 1e-9));
  return {count, 2 * std::numbers::pi / static_cast<double>(count)};
}

/// A panel of one of the map's coarse fields.
struct PlacedPanel {
  const CoarseField* field;
  const CoarseField::Panel* panel;
};

/// What is asked: one scan in one map.
struct Query {
  double cell_size;  ///< m, of coarse cells
  std::uint8_t largest;
  std::vector<PlacedPanel> panels;
  Headings headings;
  std::vector<Steps> steps;  ///< at each heading

  [[nodiscard]] std::size_t points() const { return steps.front().count; }
};

/// In a map with a coarse field or more, which differ in place and extent only.
Query query_of(const MapFields& fields, const ScanPoints& points, const DenseSearchParams& params) {
  const CoarseField& field = *fields.coarse.front();
  FLIRT_ASSERT(field.largest > 0);
  const std::size_t largest_count = std::min<std::size_t>(params.largest_point_count, 4095U / field.largest);
  const std::size_t count = std::min(points.size(), largest_count);
  Query query{field.cell_size, field.largest, {}, headings_of(params), {}};
  for (const auto& part : fields.coarse) {
    for (const CoarseField::Panel& panel : part->panels) { query.panels.push_back({part.get(), &panel}); }
  }
  query.steps.assign(query.headings.count, Steps(count));
  for (std::size_t heading = 0; heading < query.headings.count; ++heading) {
    const double angle = static_cast<double>(heading) * query.headings.step;
    const double c = std::cos(angle) / field.cell_size;
    const double s = std::sin(angle) / field.cell_size;
    // Every fourth point, then the next of each four: the first few already tell much of the whole.
    std::size_t to = 0;
    for (std::size_t first = 0; first < 4; ++first) {
      for (std::size_t k = first; k < count; k += 4, ++to) {
        const std::size_t i = k * points.size() / count;
        query.steps[heading].set(to, static_cast<std::int32_t>(std::lround(c * points.x[i] - s * points.y[i])),
                                 static_cast<std::int32_t>(std::lround(s * points.x[i] + c * points.y[i])));
      }
    }
  }
  return query;
}

/// For each panel, heading and pair a bound of its sums (see dense::bound_panel).
class Bounds {
 public:
  explicit Bounds(const Query& query)
      : headings_(query.headings.count), bytes_(query.panels.size() * headings_ * panel_pairs) {}

  [[nodiscard]] std::uint8_t* of(std::size_t panel, std::size_t heading) {
    return bytes_.data() + (panel * headings_ + heading) * panel_pairs;
  }
  [[nodiscard]] const std::uint8_t* of(std::size_t panel, std::size_t heading) const {
    return bytes_.data() + (panel * headings_ + heading) * panel_pairs;
  }

 private:
  std::size_t headings_;
  std::vector<std::uint8_t> bytes_;
};

/// A few neighbouring panels at a time: their surroundings and the steps of one heading stay in the cache.
Bounds bounds_everywhere(const Query& query) {
  constexpr std::size_t together = 8;
  Bounds bounds(query);
  const std::vector<PlacedPanel>& panels = query.panels;
  for (std::size_t first = 0; first < panels.size(); first += together) {
    for (std::size_t heading = 0; heading < query.headings.count; ++heading) {
      for (std::size_t panel = first; panel < std::min(first + together, panels.size()); ++panel) {
        dense::bound_panel(*panels[panel].field, *panels[panel].panel, query.steps[heading], bounds.of(panel, heading));
      }
    }
  }
  return bounds;
}

/// The best of some neighbouring headings in one tile.
struct TileBest {
  std::uint16_t key{0};
  std::uint16_t heading{0};
  CellIndex corner;  ///< coarse cells of the map

  [[nodiscard]] int sum() const { return key >> 4; }
};

/// Larger sums first; equal ones in the order of headings, rows and columns.
bool better(const TileBest& a, const TileBest& b) {
  if (a.sum() != b.sum()) { return a.sum() > b.sum(); }
  if (a.heading != b.heading) { return a.heading < b.heading; }
  return a.corner.y != b.corner.y ? a.corner.y < b.corner.y : a.corner.x < b.corner.x;
}

/// The `count` best tiles of those added so far, and the sum that others must reach to be among them.
class BestTiles {
 public:
  BestTiles(std::size_t count, int least) : count_(count), least_(least) {}

  void add(const TileBest& tile) {
    if (tile.sum() < least_) { return; }
    tiles_.push_back(tile);
    if (tiles_.size() >= 2 * count_ + 1000) { drop_worse(); }
  }
  [[nodiscard]] int least() const { return least_; }
  [[nodiscard]] std::vector<TileBest> sorted() {
    drop_worse();
    std::ranges::sort(tiles_, better);
    return std::move(tiles_);
  }

 private:
  void drop_worse() {
    if (tiles_.size() <= count_) { return; }
    const auto last = tiles_.begin() + static_cast<std::ptrdiff_t>(count_) - 1;
    std::ranges::nth_element(tiles_, last, better);
    least_ = std::max(least_, last->sum());
    tiles_.resize(count_);
  }

  std::size_t count_;
  int least_;
  std::vector<TileBest> tiles_;
};

/// The smallest bound of pairs that can hold a sum of `least`; pairs in which nobody can stand have bound 0.
std::uint8_t least_bound(int least) {
  return static_cast<std::uint8_t>(std::clamp((least + 15) / 16, 1, 255));
}

/// Calls visit(pair) for each of a panel's pairs with a bound of at least `least`.
template <class Visit>
void for_each_pair(const std::uint8_t* bounds, std::uint8_t least, const Visit& visit) {
  constexpr std::size_t together = 8;
  for (std::size_t first = 0; first < panel_pairs; first += together) {
    unsigned above = 0;
    for (std::size_t i = 0; i < together; ++i) { above |= static_cast<unsigned>(bounds[first + i] >= least) << i; }
    for (; above != 0; above &= above - 1) { visit(first + static_cast<std::size_t>(std::countr_zero(above))); }
  }
}

CellIndex corner_of(const CoarseField::Panel& panel, std::size_t pair) {
  const auto i = static_cast<std::int32_t>(pair);
  return {panel.corner.x + i % CoarseField::panel_columns * CoarseField::pair_width,
          panel.corner.y + i / CoarseField::panel_columns * CoarseField::tile_side};
}

/// The best of the headings [first, last) in each tile of a panel; only pairs with a bound of at least `least`.
void search_panel(const Query& query, const Bounds& bounds, std::size_t index, std::size_t first, std::size_t last,
                  std::uint8_t least, BestTiles& best) {
  const CoarseField& field = *query.panels[index].field;
  const CoarseField::Panel& panel = *query.panels[index].panel;
  std::array<TileBest, tiles_per_panel> tiles{};
  std::array<std::uint64_t, tiles_per_panel / 64> touched{};
  for (std::size_t heading = first; heading < last; ++heading) {
    for_each_pair(bounds.of(index, heading), least, [&](std::size_t pair) {
      const CellIndex corner = corner_of(panel, pair);
      const std::uint8_t* const standable = panel.standable.data() + pair * CoarseField::pair_cells;
      const PairKeys keys = dense::search_pair(field, corner, standable, query.steps[heading], best.least());
      for (std::size_t k = 0; k < keys.size(); ++k) {
        TileBest& tile = tiles[2 * pair + k];
        if (keys[k] <= tile.key) { continue; }
        const auto step = static_cast<std::int32_t>(k) * CoarseField::tile_side;
        tile = {
            keys[k], static_cast<std::uint16_t>(heading), {field.first.x + corner.x + step, field.first.y + corner.y}};
        touched[pair / 32] |= std::uint64_t{1} << (2 * (pair % 32) + k);
      }
    });
  }
  for (std::size_t word = 0; word < touched.size(); ++word) {
    for (std::uint64_t bits = touched[word]; bits != 0; bits &= bits - 1) {
      best.add(tiles[64 * word + static_cast<std::size_t>(std::countr_zero(bits))]);
    }
  }
}

/// Best tiles over all pairs whose bounds reach `least_asked` and what `best` asks for, which rises as tiles are found.
BestTiles search_pairs(const Query& query, const Bounds& bounds, std::uint8_t least_asked,
                       const DenseSearchParams& params, BestTiles best) {
  for (std::size_t panel = 0; panel < query.panels.size(); ++panel) {
    for (std::size_t first = 0; first < query.headings.count; first += params.headings_per_tile) {
      const std::size_t last = std::min<std::size_t>(first + params.headings_per_tile, query.headings.count);
      const std::uint8_t least = std::max(least_asked, least_bound(best.least()));
      search_panel(query, bounds, panel, first, last, least, best);
    }
  }
  return best;
}

/// A bound that some `count` pairs reach, by every eighth panel and heading.
std::uint8_t bound_of_best(const Query& query, const Bounds& bounds, std::size_t count) {
  constexpr std::size_t every = 8;
  std::array<std::size_t, 256> histogram{};
  for (std::size_t panel = 0; panel < query.panels.size(); ++panel) {
    for (std::size_t heading = panel % every; heading < query.headings.count; heading += every) {
      const std::uint8_t* const pairs = bounds.of(panel, heading);
      for (std::size_t i = 0; i < panel_pairs; ++i) { ++histogram[pairs[i]]; }
    }
  }
  std::size_t bound = 255;
  for (std::size_t reached = histogram[bound] * every; reached < count && bound > 1;) {
    --bound;
    reached += histogram[bound] * every;
  }
  return static_cast<std::uint8_t>(bound);
}

/// A sum that at least params.candidates tiles reach, close to the largest such: by the most promising pairs alone.
int reached_sum(const Query& query, const Bounds& bounds, const DenseSearchParams& params) {
  const std::size_t count = params.candidates;
  const std::uint8_t promising = bound_of_best(query, bounds, 4 * count);
  const std::vector<TileBest> tiles = search_pairs(query, bounds, promising, params, BestTiles(count, 0)).sorted();
  return tiles.size() < count ? 0 : tiles.back().sum();
}

std::vector<CoarsePose> poses_of(const std::vector<TileBest>& tiles, const Query& query, const MapFields& fields) {
  const double scale = 1.0 / (static_cast<double>(query.points()) * query.largest);
  std::vector<CoarsePose> poses;
  poses.reserve(tiles.size());
  for (const TileBest& best : tiles) {
    const std::int32_t x = best.corner.x + (best.key & 3);
    const std::int32_t y = best.corner.y + (best.key >> 2 & 3);
    poses.push_back({{fields.origin.x + (x + 0.5) * query.cell_size, fields.origin.y + (y + 0.5) * query.cell_size,
                      wrap_angle(best.heading * query.headings.step)},
                     static_cast<float>(best.sum() * scale)});
  }
  return poses;
}

/// Marks the pairs and headings around given places.
Bounds bounds_near(const Query& query, const MapFields& fields, std::span<const Pose2> places,
                   const DenseSearchParams& params) {
  Bounds bounds(query);
  const auto turns = static_cast<std::int64_t>(std::ceil(params.near_heading / query.headings.step));
  const auto turn = static_cast<std::int64_t>(query.headings.count);
  const double pair_x = CoarseField::pair_width * query.cell_size;
  const double pair_y = CoarseField::tile_side * query.cell_size;
  for (std::size_t i = 0; i < query.panels.size(); ++i) {
    const CoarseField::Panel& panel = *query.panels[i].panel;
    const CellIndex first_cell = query.panels[i].field->first;
    const Point2 corner{fields.origin.x + (first_cell.x + panel.corner.x) * query.cell_size,
                        fields.origin.y + (first_cell.y + panel.corner.y) * query.cell_size};
    for (const Pose2& place : places) {
      // Columns and rows of pairs that the place's square touches.
      const double reach = params.near_distance;
      const auto first = [](double from, double width) { return std::max(0.0, std::floor(from / width)); };
      const auto last = [](double to, double width, double count) {
        return std::min(count - 1, std::floor(to / width));
      };
      const double x0 = first(place.x - reach - corner.x, pair_x);
      const double x1 = last(place.x + reach - corner.x, pair_x, CoarseField::panel_columns);
      const double y0 = first(place.y - reach - corner.y, pair_y);
      const double y1 = last(place.y + reach - corner.y, pair_y, CoarseField::panel_rows);
      if (x0 > x1 || y0 > y1) { continue; }
      const std::int64_t heading = std::lround(place.theta / query.headings.step);
      for (std::int64_t h = heading - turns; h <= heading + turns; ++h) {
        std::uint8_t* const marks = bounds.of(i, static_cast<std::size_t>((h % turn + turn) % turn));
        for (auto row = static_cast<std::size_t>(y0); row <= static_cast<std::size_t>(y1); ++row) {
          for (auto column = static_cast<std::size_t>(x0); column <= static_cast<std::size_t>(x1); ++column) {
            const std::size_t pair = row * CoarseField::panel_columns + column;
            marks[pair] = panel.pairs[pair];
          }
        }
      }
    }
  }
  return bounds;
}

}  // namespace

std::vector<CoarsePose> dense_search(const MapFields& fields, const ScanPoints& points,
                                     const DenseSearchParams& params) {
  if (fields.coarse.empty() || points.size() == 0) { return {}; }
  const Query query = query_of(fields, points, params);
  const Bounds bounds = bounds_everywhere(query);
  const int least = reached_sum(query, bounds, params);
  return poses_of(search_pairs(query, bounds, 1, params, BestTiles(params.candidates, least)).sorted(), query, fields);
}

std::vector<CoarsePose> dense_search_near(const MapFields& fields, const ScanPoints& points,
                                          std::span<const Pose2> map_from_sensor, const DenseSearchParams& params) {
  if (fields.coarse.empty() || points.size() == 0) { return {}; }
  const Query query = query_of(fields, points, params);
  const Bounds bounds = bounds_near(query, fields, map_from_sensor, params);
  return poses_of(search_pairs(query, bounds, 1, params, BestTiles(params.candidates, 0)).sorted(), query, fields);
}

}  // namespace flirt
