#include "flirt/map/grid_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
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

constexpr std::uint8_t deepest = 3;  // pixels between free space and a surface that is still taken to bound it

/// What the pixels of an image are, row by row from the top.
struct PixelStates {
  std::int32_t width{0};
  std::int32_t height{0};
  std::vector<CellState> states;
  std::vector<std::uint8_t> solid{};  ///< not 0: see `is_solid`

  /// Outside everything is unknown.
  [[nodiscard]] CellState at(std::int32_t column, std::int32_t row) const {
    return contains(column, row) ? states[offset(column, row)] : CellState::unknown;
  }
  /// Index of a place in pixels from the lower left corner; nothing outside.
  [[nodiscard]] std::optional<std::size_t> index(Point2 in_pixels) const {
    if (!(in_pixels.x >= 0 && in_pixels.y >= 0 && in_pixels.x < width && in_pixels.y < height)) { return std::nullopt; }
    return offset(static_cast<std::int32_t>(in_pixels.x), height - 1 - static_cast<std::int32_t>(in_pixels.y));
  }
  [[nodiscard]] bool contains(std::int32_t column, std::int32_t row) const {
    return column >= 0 && row >= 0 && column < width && row < height;
  }
  [[nodiscard]] std::size_t offset(std::int32_t column, std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
};

CellState state_of_pixel(std::uint8_t pixel, const GridMapMetadata& metadata) {
  constexpr double likely = 0.53;  // more than 127 of 255, which stands for unknown in some maps
  const double probability = occupancy(pixel, metadata);
  const bool is_likely = probability > likely && probability <= 1.0;
  return is_likely ? CellState::occupied : cell_state(pixel, metadata);
}

/// Of an occupied pixel: whether beams do not pass it.
bool is_solid(std::uint8_t pixel, const GridMapMetadata& metadata) {
  return occupancy(pixel, metadata) >= (1.0 + metadata.occupied_thresh) / 2;
}

PixelStates pixel_states(const GreyImage& image, const GridMapMetadata& metadata) {
  std::array<CellState, 256> state_of{};
  std::array<std::uint8_t, 256> solid_of{};
  for (std::size_t value = 0; value < state_of.size(); ++value) {
    state_of[value] = state_of_pixel(static_cast<std::uint8_t>(value), metadata);
    solid_of[value] = is_solid(static_cast<std::uint8_t>(value), metadata) ? 1 : 0;
  }
  PixelStates pixels{static_cast<std::int32_t>(image.width), static_cast<std::int32_t>(image.height), {}};
  pixels.states.reserve(image.pixels.size());
  pixels.solid.reserve(image.pixels.size());
  for (const std::uint8_t value : image.pixels) {
    pixels.states.push_back(state_of[value]);
    pixels.solid.push_back(solid_of[value]);
  }
  return pixels;
}

/// Steps from each pixel to the nearest free one, diagonal ones counted as one; at most `deepest` + 1. Two passes.
std::vector<std::uint8_t> steps_to_free(const PixelStates& pixels) {
  std::vector<std::uint8_t> steps(pixels.states.size(), deepest + 1);
  const auto come_from = [&](std::int32_t column, std::int32_t row, std::int32_t right, std::int32_t down) {
    if (!pixels.contains(column + right, row + down)) { return; }
    std::uint8_t& here = steps[pixels.offset(column, row)];
    const int there = steps[pixels.offset(column + right, row + down)];
    here = static_cast<std::uint8_t>(std::min<int>(here, there + 1));
  };
  const auto pass = [&](std::int32_t column, std::int32_t row, std::int32_t before) {
    if (pixels.at(column, row) == CellState::free) { steps[pixels.offset(column, row)] = 0; }
    come_from(column, row, before, 0);
    for (const std::int32_t right : {-1, 0, 1}) { come_from(column, row, right, before); }
  };
  for (std::int32_t row = 0; row < pixels.height; ++row) {
    for (std::int32_t column = 0; column < pixels.width; ++column) { pass(column, row, -1); }
  }
  for (std::int32_t row = pixels.height - 1; row >= 0; --row) {
    for (std::int32_t column = pixels.width - 1; column >= 0; --column) { pass(column, row, 1); }
  }
  return steps;
}

/// Whether no beam can end on an occupied pixel: one beside it lies nearer to free space, or only occupied ones do.
bool is_hidden(const PixelStates& pixels, const std::vector<std::uint8_t>& steps, std::int32_t column,
               std::int32_t row) {
  const std::uint8_t own = steps[pixels.offset(column, row)];
  if (own == 1) { return false; }
  bool buried = true;
  for (std::int32_t y = row - 1; y <= row + 1; ++y) {
    for (std::int32_t x = column - 1; x <= column + 1; ++x) {
      const bool occupied = pixels.at(x, y) == CellState::occupied;
      if (occupied && steps[pixels.offset(x, y)] < own) { return true; }
      buried &= occupied;
    }
  }
  return buried;
}

/// What lies behind the surface of thick walls becomes unknown, as it is in a map that scans have made.
PixelStates surfaces_of(const PixelStates& pixels) {
  const std::vector<std::uint8_t> steps = steps_to_free(pixels);
  PixelStates surfaces = pixels;
  for (std::int32_t row = 0; row < pixels.height; ++row) {
    for (std::int32_t column = 0; column < pixels.width; ++column) {
      CellState& state = surfaces.states[pixels.offset(column, row)];
      if (state == CellState::occupied && is_hidden(pixels, steps, column, row)) { state = CellState::unknown; }
    }
  }
  return surfaces;
}

struct CellSample {
  CellState state;
  float occupied_share;
  std::uint8_t solid;
};

/// What is in one cell; its corner and its sides are in pixels.
CellSample sample(const PixelStates& pixels, Point2 corner, Point2 right, Point2 up, int samples) {
  int occupied = 0;
  int free = 0;
  std::uint8_t solid = 0;
  for (int j = 0; j < samples; ++j) {
    for (int i = 0; i < samples; ++i) {
      const auto index = pixels.index(corner + ((i + 0.5) / samples) * right + ((j + 0.5) / samples) * up);
      if (!index) { continue; }
      const bool is_occupied = pixels.states[*index] == CellState::occupied;
      occupied += is_occupied ? 1 : 0;
      free += pixels.states[*index] == CellState::free ? 1 : 0;
      if (is_occupied) { solid |= pixels.solid[*index]; }
    }
  }
  const int all = samples * samples;
  const CellState state = occupied > 0 ? CellState::occupied : 2 * free > all ? CellState::free : CellState::unknown;
  return {state, static_cast<float>(occupied) / static_cast<float>(all), solid};
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

  const PixelStates pixels = surfaces_of(pixel_states(image, metadata));
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
