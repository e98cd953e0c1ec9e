#include "flirt/map/grid_place_map.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/grid/beam_traversal.hpp"
#include "flirt/grid/nearest_cells.hpp"
#include "flirt/map/grid_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace flirt {
namespace {

constexpr double cell_size = EvidenceGridParams{}.cell_size;

/// Not 0: nothing occupied within `clearance` of this free cell.
std::vector<std::uint8_t> clear_cells(const GridCells& cells, double clearance) {
  std::vector<std::uint8_t> occupied(cells.states.size());
  for (std::size_t i = 0; i < occupied.size(); ++i) { occupied[i] = cells.states[i] == CellState::occupied ? 1 : 0; }
  const int reach = std::clamp(static_cast<int>(std::ceil(clearance / cell_size)), 1, longest_reach);
  const std::vector<CellOffset> nearest = nearest_cells(occupied, static_cast<std::size_t>(cells.width), reach);
  std::vector<std::uint8_t> clear(cells.states.size());
  for (std::size_t i = 0; i < clear.size(); ++i) {
    const bool is_far = nearest[i].squared_distance == CellOffset::none;
    clear[i] = is_far && cells.states[i] == CellState::free ? 1 : 0;
  }
  return clear;
}

/// The clear cell nearest to the middle of the square of `side` cells at `low`; of equal ones the first.
std::optional<CellIndex> place_in(const GridCells& cells, const std::vector<std::uint8_t>& clear, CellIndex low,
                                  std::int32_t side) {
  std::optional<CellIndex> place;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (std::int32_t y = low.y; y < std::min(low.y + side, cells.first.y + cells.height); ++y) {
    for (std::int32_t x = low.x; x < std::min(low.x + side, cells.first.x + cells.width); ++x) {
      const std::int64_t dx = x - (low.x + side / 2);
      const std::int64_t dy = y - (low.y + side / 2);
      if (clear[cells.offset({x, y})] == 0 || dx * dx + dy * dy >= least) { continue; }
      least = dx * dx + dy * dy;
      place = CellIndex{x, y};
    }
  }
  return place;
}

std::vector<Point2> places_in_cells(const GridCells& cells, const GridPlaceMapParams& params) {
  const std::vector<std::uint8_t> clear = clear_cells(cells, params.clearance);
  const auto side = std::max(1, static_cast<std::int32_t>(std::lround(params.spacing / cell_size)));
  std::vector<Point2> places;
  for (std::int32_t y = cells.first.y; y < cells.first.y + cells.height; y += side) {
    for (std::int32_t x = cells.first.x; x < cells.first.x + cells.width; x += side) {
      const std::optional<CellIndex> place = place_in(cells, clear, {x, y}, side);
      if (place) { places.push_back({place->x + 0.5, place->y + 0.5}); }
    }
  }
  return places;
}

/// Where a ray from outside comes into a cell, cells along the ray: the later of the two borders that it faces.
double entry(Point2 from, Point2 direction, CellIndex cell) {
  const auto border = [](double start, double slope, std::int32_t low) {
    if (slope == 0) { return -std::numeric_limits<double>::infinity(); }
    return ((slope > 0 ? low : low + 1) - start) / slope;
  };
  return std::max(border(from.x, direction.x, cell.x), border(from.y, direction.y, cell.y));
}

/// Distance to the first occupied cell, m; `range_max` where there is none or unknown space comes first.
double cast(const GridCells& cells, Point2 from_in_cells, double angle, double range_max) {
  const Point2 direction{std::cos(angle), std::sin(angle)};
  double range = range_max;
  bool has_ended = false;
  traverse(fixed_point(from_in_cells), fixed_point(from_in_cells + (range_max / cell_size) * direction),
           [&](std::int32_t x, std::int32_t y) {
             if (has_ended) { return; }
             const CellState state = cells.at({x, y});
             has_ended = state != CellState::free;
             if (state == CellState::occupied) { range = cell_size * entry(from_in_cells, direction, {x, y}); }
           });
  return range;
}

Scan virtual_scan(const GridCells& cells, Point2 from_in_cells, const GridPlaceMapParams& params) {
  Scan scan{.beams = {.angle_min = -std::numbers::pi,
                      .angle_step = 2 * std::numbers::pi / params.beams,
                      .range_min = 0,
                      .range_max = params.range_max}};
  scan.ranges.reserve(params.beams);
  for (std::size_t i = 0; i < params.beams; ++i) {
    scan.ranges.push_back(cast(cells, from_in_cells, scan.beams.angle(i), params.range_max));
  }
  return scan;
}

}  // namespace

Result<PlaceMap> place_map_from_grid(const GreyImage& image, const GridMapMetadata& metadata,
                                     const GridPlaceMapParams& params, const FeatureParams& features,
                                     std::size_t threads, const Progress& progress, MapVariances variances) {
  FLIRT_ASSERT(out_of_range(params).empty());
  const Result<GridCells> cells = grid_cells(image, metadata, cell_size);
  if (!cells) { return tl::unexpected(cells.error()); }
  if (std::ranges::find(cells->states, CellState::free) == cells->states.end()) {
    return fail("expected a grid map with free space, found none");
  }
  const std::vector<Point2> places = places_in_cells(*cells, params);
  std::vector<FeatureExtractor> extractors;
  extractors.reserve(thread_count(threads));
  for (std::size_t i = 0; i < thread_count(threads); ++i) { extractors.emplace_back(features); }
  std::vector<Scan> scans(places.size());
  std::vector<Features> features_of(places.size());
  parallel_for(
      places.size(), extractors.size(),
      [&](std::size_t i, std::size_t thread) {
        scans[i] = virtual_scan(*cells, places[i], params);
        features_of[i] = extractors[thread].extract(scans[i]);
      },
      progress);
  PlaceMapBuilder builder(features, variances);
  for (std::size_t i = 0; i < places.size(); ++i) {
    builder.add(scans[i], {cell_size * places[i].x, cell_size * places[i].y, 0}, features_of[i]);
  }
  return std::move(builder).build(evidence_of(*cells, params.counts, cell_size));
}

}  // namespace flirt
