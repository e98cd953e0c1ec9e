#include "flirt/map/grid_cells.hpp"

#include "flirt/map/grid_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace flirt {
namespace {

constexpr double smallest_pixel = 1e-3;  // m
constexpr double largest_area = 1e6;     // m²
constexpr double farthest_origin = 1e6;  // m

struct Extent {
  Point2 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Point2 high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
};

/// The smallest rectangle around the image, m, map frame.
Extent extent_of(const GreyImage& image, const GridMapMetadata& metadata) {
  const double width = static_cast<double>(image.width) * metadata.resolution;
  const double height = static_cast<double>(image.height) * metadata.resolution;
  Extent extent;
  for (const Point2 in_image : {Point2{0, 0}, Point2{width, 0}, Point2{0, height}, Point2{width, height}}) {
    const Point2 corner = metadata.origin * in_image;
    extent.low = {std::min(extent.low.x, corner.x), std::min(extent.low.y, corner.y)};
    extent.high = {std::max(extent.high.x, corner.x), std::max(extent.high.y, corner.y)};
  }
  return extent;
}

struct CellSample {
  CellState state;
  float occupied_share;
  std::uint8_t solid;
};

/// What is in one cell; its corner and its sides are in pixels. Where a wall of one pixel lies across two cells only
/// the one with half of it or more is solid.
CellSample sample(const GridPixels& pixels, Point2 corner, Point2 right, Point2 up, int samples) {
  std::array<int, 5> counts{};  // by GridPixel
  for (int j = 0; j < samples; ++j) {
    for (int i = 0; i < samples; ++i) {
      const Point2 place = corner + ((i + 0.5) / samples) * right + ((j + 0.5) / samples) * up;
      ++counts[static_cast<std::size_t>(pixels.at(place))];
    }
  }
  const auto count = [&](GridPixel pixel) { return counts[static_cast<std::size_t>(pixel)]; };
  const int all = samples * samples;
  const int surface = count(GridPixel::passed) + count(GridPixel::solid);
  const int barrier = count(GridPixel::solid) + count(GridPixel::core);
  const double strip = std::min(1.0, 1 / std::hypot(right.x, right.y));  // of the cell, a pixel wide, from side to side
  const bool is_solid = 2 * barrier >= strip * all;
  const CellState state = surface + barrier > 0              ? CellState::occupied
                          : 2 * count(GridPixel::free) > all ? CellState::free
                                                             : CellState::unknown;
  return {state, static_cast<float>(surface) / static_cast<float>(all), static_cast<std::uint8_t>(is_solid ? 1 : 0)};
}

}  // namespace

Result<GridCells> grid_cells(const GreyImage& image, const GridMapMetadata& metadata, double cell_size) {
  if (!(metadata.resolution >= smallest_pixel)) {
    return fail("expected pixels of at least 0.001 m, found smaller ones");
  }
  const Extent extent = extent_of(image, metadata);
  const double reach = std::max({-extent.low.x, -extent.low.y, extent.high.x, extent.high.y});
  const double area = (extent.high.x - extent.low.x) * (extent.high.y - extent.low.y);
  if (!(area <= largest_area)) { return fail("expected a grid map of at most 1 km², found a larger one"); }
  if (!(reach <= farthest_origin)) {
    return fail("expected a grid map within 1000 km of its origin, found one farther away");
  }

  // Sides on a boundary between cells must not reach into the next one by rounding.
  const auto low_cell = [&](double low) { return static_cast<std::int32_t>(std::floor(low / cell_size + 1e-6)); };
  const auto high_cell = [&](double high) { return static_cast<std::int32_t>(std::ceil(high / cell_size - 1e-6)); };
  GridCells cells;
  cells.first = {low_cell(extent.low.x), low_cell(extent.low.y)};
  cells.width = std::max(0, high_cell(extent.high.x) - cells.first.x);
  cells.height = std::max(0, high_cell(extent.high.y) - cells.first.y);
  const std::size_t count = static_cast<std::size_t>(cells.width) * static_cast<std::size_t>(cells.height);
  cells.states.resize(count);
  cells.occupied_share.resize(count);
  cells.solid.resize(count);

  const GridPixels pixels = grid_pixels(image, metadata);
  const Pose2 image_from_map = inverse(metadata.origin);
  const auto in_pixels = [&](double x, double y) {
    return (1 / metadata.resolution) * (image_from_map * Point2{x * cell_size, y * cell_size});
  };
  const Point2 right = in_pixels(1, 0) - in_pixels(0, 0);
  const Point2 up = in_pixels(0, 1) - in_pixels(0, 0);
  // Points closer than a pixel's inscribed square miss none, however it is turned.
  const int samples = std::max(4, static_cast<int>(std::ceil(std::numbers::sqrt2 * cell_size / metadata.resolution)));
  for (std::int32_t y = 0; y < cells.height; ++y) {
    for (std::int32_t x = 0; x < cells.width; ++x) {
      const CellIndex cell{cells.first.x + x, cells.first.y + y};
      const auto [state, occupied_share, solid] = sample(pixels, in_pixels(cell.x, cell.y), right, up, samples);
      cells.states[cells.offset(cell)] = state;
      cells.occupied_share[cells.offset(cell)] = occupied_share;
      cells.solid[cells.offset(cell)] = solid;
    }
  }
  return cells;
}

EvidenceGrid evidence_of(const GridCells& cells, std::uint32_t counts, double cell_size) {
  EvidenceGrid evidence({.cell_size = cell_size});
  for (std::size_t at = 0; at < cells.states.size(); ++at) {
    const auto width = static_cast<std::size_t>(cells.width);
    const CellIndex cell{cells.first.x + static_cast<std::int32_t>(at % width),
                         cells.first.y + static_cast<std::int32_t>(at / width)};
    if (cells.states[at] == CellState::free) {
      evidence.count(cell, {.hits = 0, .passes = static_cast<std::uint16_t>(counts)});
    } else if (cells.states[at] == CellState::occupied) {
      const long hits = std::max(2L, std::lround(static_cast<float>(counts) * cells.occupied_share[at]));
      const long passes = cells.solid[at] != 0 ? 0 : hits + 1;
      evidence.count(cell, {.hits = static_cast<std::uint16_t>(hits), .passes = static_cast<std::uint16_t>(passes)});
    }
  }
  return evidence;
}

}  // namespace flirt
