#include "flirt/map/grid_place_map.hpp"

#include "flirt/grid/beam_traversal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace flirt {
namespace {

/// The states of all cells of the map's box.
struct Cells {
  CellIndex first{};
  std::int32_t width{0};
  std::int32_t height{0};
  std::vector<CellState> states{};

  [[nodiscard]] bool contains(std::int32_t x, std::int32_t y) const {
    return x >= first.x && y >= first.y && x < first.x + width && y < first.y + height;
  }
  [[nodiscard]] std::size_t offset(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y - first.y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x - first.x);
  }
  [[nodiscard]] CellState at(std::int32_t x, std::int32_t y) const {
    return contains(x, y) ? states[offset(x, y)] : CellState::unknown;
  }
};

/// The cells around all pixels; nothing when the map is larger than any building.
std::optional<Cells> empty_cells(const GreyImage& image, const GridMapMetadata& metadata, double cell_size) {
  constexpr double longest = 1e4;  // m
  Point2 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Point2 high{-low.x, -low.y};
  for (const double x : {0.0, static_cast<double>(image.width)}) {
    for (const double y : {0.0, static_cast<double>(image.height)}) {
      const Point2 corner = metadata.origin * Point2{x * metadata.resolution, y * metadata.resolution};
      low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
      high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
    }
  }
  const bool sane =
      high.x - low.x <= longest && high.y - low.y <= longest && std::abs(low.x) <= 1e6 && std::abs(low.y) <= 1e6;
  if (!sane) { return std::nullopt; }
  Cells cells{.first = {static_cast<std::int32_t>(std::floor(low.x / cell_size)) - 1,
                        static_cast<std::int32_t>(std::floor(low.y / cell_size)) - 1}};
  cells.width = static_cast<std::int32_t>(std::floor(high.x / cell_size)) + 2 - cells.first.x;
  cells.height = static_cast<std::int32_t>(std::floor(high.y / cell_size)) + 2 - cells.first.y;
  cells.states.assign(static_cast<std::size_t>(cells.width) * static_cast<std::size_t>(cells.height),
                      CellState::unknown);
  return cells;
}

/// Sets what a pixel says in each cell that it touches; occupied wins over free, free over unknown.
void draw_pixel(Cells& cells, Point2 centre, double resolution, double cell_size, CellState state) {
  // A pixel's corners on a boundary must not reach into the next cell.
  const double half = 0.5 * resolution - 1e-3 * cell_size;
  const auto cell = [cell_size](double value) { return static_cast<std::int32_t>(std::floor(value / cell_size)); };
  for (std::int32_t y = cell(centre.y - half); y <= cell(centre.y + half); ++y) {
    for (std::int32_t x = cell(centre.x - half); x <= cell(centre.x + half); ++x) {
      if (!cells.contains(x, y)) { continue; }
      CellState& known = cells.states[cells.offset(x, y)];
      if (known != CellState::occupied) { known = state; }
    }
  }
}

void draw(Cells& cells, const GreyImage& image, const GridMapMetadata& metadata, double cell_size) {
  for (std::size_t row = 0; row < image.height; ++row) {
    for (std::size_t column = 0; column < image.width; ++column) {
      const CellState state = cell_state(image.at(column, row), metadata);
      if (state == CellState::unknown) { continue; }
      draw_pixel(cells, map_point(column, row, image, metadata), metadata.resolution, cell_size, state);
    }
  }
}

EvidenceGrid evidence_of(const Cells& cells, const GridPlaceMapParams& params) {
  EvidenceGrid evidence;
  const auto counts = static_cast<std::uint16_t>(params.counts);
  for (std::int32_t y = cells.first.y; y < cells.first.y + cells.height; ++y) {
    for (std::int32_t x = cells.first.x; x < cells.first.x + cells.width; ++x) {
      const CellState state = cells.at(x, y);
      if (state == CellState::occupied) { evidence.count({x, y}, {.hits = counts, .passes = 0}); }
      if (state == CellState::free) { evidence.count({x, y}, {.hits = 0, .passes = counts}); }
    }
  }
  return evidence;
}

bool is_clear(const Cells& cells, CellIndex at, std::int32_t reach) {
  if (cells.at(at.x, at.y) != CellState::free) { return false; }
  for (std::int32_t dy = -reach; dy <= reach; ++dy) {
    for (std::int32_t dx = -reach; dx <= reach; ++dx) {
      if (dx * dx + dy * dy <= reach * reach && cells.at(at.x + dx, at.y + dy) == CellState::occupied) { return false; }
    }
  }
  return true;
}

/// Distance to the first occupied cell in a direction, m; `range_max` where there is none or unknown space comes first.
double cast(const Cells& cells, Point2 from_in_cells, double angle, double cell_size, double range_max) {
  const double reach = range_max / cell_size;
  const Point2 direction{std::cos(angle), std::sin(angle)};
  double range = range_max;
  bool stopped = false;
  traverse(fixed_point(from_in_cells), fixed_point(from_in_cells + reach * direction),
           [&](std::int32_t x, std::int32_t y) {
             if (stopped || cells.at(x, y) == CellState::free) { return; }
             stopped = true;
             if (cells.at(x, y) != CellState::occupied) { return; }
             const Point2 centre{x + 0.5, y + 0.5};
             range = std::max(0.1, dot(centre - from_in_cells, direction) * cell_size);
           });
  return range;
}

Scan virtual_scan(const Cells& cells, Point2 from_in_cells, double cell_size, const GridPlaceMapParams& params) {
  const double step = 2 * std::numbers::pi / params.beams;
  Scan scan{.beams = {-std::numbers::pi, step, 0.05, params.range_max}};
  scan.ranges.reserve(params.beams);
  for (std::size_t i = 0; i < params.beams; ++i) {
    scan.ranges.push_back(cast(cells, from_in_cells, scan.beams.angle(i), cell_size, params.range_max));
  }
  return scan;
}

}  // namespace

Result<PlaceMap> place_map_from_grid(const GreyImage& image, const GridMapMetadata& metadata,
                                     const GridPlaceMapParams& params, const FeatureParams& features) {
  const double cell_size = EvidenceGridParams{}.cell_size;
  std::optional<Cells> cells = empty_cells(image, metadata, cell_size);
  if (!cells) { return fail("expected a grid map of at most 10 km within 1000 km of its origin, found a larger one"); }
  draw(*cells, image, metadata, cell_size);
  if (std::ranges::find(cells->states, CellState::free) == cells->states.end()) {
    return fail("expected a grid map with free cells, found none");
  }
  PlaceMapBuilder builder(features);
  FeatureExtractor extractor(features);
  const auto stride = std::max(1, static_cast<std::int32_t>(std::lround(params.spacing / cell_size)));
  const auto reach = static_cast<std::int32_t>(std::ceil(params.clearance / cell_size));
  for (std::int32_t y = cells->first.y + stride / 2; y < cells->first.y + cells->height; y += stride) {
    for (std::int32_t x = cells->first.x + stride / 2; x < cells->first.x + cells->width; x += stride) {
      if (!is_clear(*cells, {x, y}, reach)) { continue; }
      const Point2 in_cells{x + 0.5, y + 0.5};
      const Scan scan = virtual_scan(*cells, in_cells, cell_size, params);
      builder.add(scan, {in_cells.x * cell_size, in_cells.y * cell_size, 0}, extractor.extract(scan));
    }
  }
  return std::move(builder).build(evidence_of(*cells, params));
}

}  // namespace flirt
