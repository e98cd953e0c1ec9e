#include "flirt/map/grid_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace flirt {
namespace {

constexpr double shortest_wall = 0.6;  // m
constexpr std::uint8_t deepest = 3;    // pixels between free space and a surface that is still taken to bound it

constexpr double likely = 0.53;  // more than 127 of 255, which stands for unknown in some maps

using Meanings = std::array<GridPixel, 256>;  // by grey value

GridPixel meaning_alone(std::uint8_t value, const GridMapMetadata& metadata) {
  const double probability = occupancy(value, metadata);
  const CellState state = cell_state(value, metadata);
  const bool is_likely = probability > likely && probability <= 1.0;
  if (is_likely || state == CellState::occupied) {
    return probability >= (1.0 + metadata.occupied_thresh) / 2 ? GridPixel::solid : GridPixel::passed;
  }
  return state == CellState::free ? GridPixel::free : GridPixel::unknown;
}

/// Whether unseen space, the commonest of the values that mean neither free nor occupied, is shown as even odds.
bool shows_even_odds(const GreyImage& image, const Meanings& meanings, const GridMapMetadata& metadata) {
  std::array<std::size_t, 256> counts{};
  for (const std::uint8_t value : image.pixels) { counts[value] += meanings[value] == GridPixel::unknown ? 1 : 0; }
  const auto commonest = std::ranges::max_element(counts) - counts.begin();
  return std::abs(occupancy(static_cast<std::uint8_t>(commonest), metadata) - 0.5) < 0.01;
}

GridPixels read_pixels(const GreyImage& image, const GridMapMetadata& metadata) {
  Meanings meanings{};
  for (std::size_t value = 0; value < meanings.size(); ++value) {
    meanings[value] = meaning_alone(static_cast<std::uint8_t>(value), metadata);
  }
  if (shows_even_odds(image, meanings, metadata)) {
    for (std::size_t value = 0; value < meanings.size(); ++value) {
      const bool is_less_likely = occupancy(static_cast<std::uint8_t>(value), metadata) < 1.0 - likely;
      if (is_less_likely) { meanings[value] = GridPixel::free; }
    }
  }
  GridPixels pixels{static_cast<std::int32_t>(image.width), static_cast<std::int32_t>(image.height), {}};
  pixels.pixels.reserve(image.pixels.size());
  for (const std::uint8_t value : image.pixels) { pixels.pixels.push_back(meanings[value]); }
  return pixels;
}

/// Occupied pixels that hang together, with the box around them.
struct Piece {
  std::vector<std::size_t> offsets;
  std::int32_t left;
  std::int32_t right;
  std::int32_t top;
  std::int32_t bottom;

  /// Diagonal of the box, pixels.
  [[nodiscard]] double across() const { return std::hypot(right - left + 1, bottom - top + 1); }
};

/// The piece of an occupied pixel that was not taken before; takes its pixels.
Piece piece_at(const GridPixels& pixels, std::int32_t column, std::int32_t row, std::vector<std::uint8_t>& taken) {
  Piece piece{{pixels.offset(column, row)}, column, column, row, row};
  taken[piece.offsets.front()] = 1;
  for (std::size_t i = 0; i < piece.offsets.size(); ++i) {
    const auto x = static_cast<std::int32_t>(piece.offsets[i] % static_cast<std::size_t>(pixels.width));
    const auto y = static_cast<std::int32_t>(piece.offsets[i] / static_cast<std::size_t>(pixels.width));
    piece.left = std::min(piece.left, x);
    piece.right = std::max(piece.right, x);
    piece.bottom = std::max(piece.bottom, y);
    for (std::int32_t beside_y = y - 1; beside_y <= y + 1; ++beside_y) {
      for (std::int32_t beside_x = x - 1; beside_x <= x + 1; ++beside_x) {
        if (!is_occupied(pixels.at(beside_x, beside_y))) { continue; }
        const std::size_t offset = pixels.offset(beside_x, beside_y);
        if (taken[offset] == 0) { piece.offsets.push_back(offset); }
        taken[offset] = 1;
      }
    }
  }
  return piece;
}

/// What is smaller than a wall may not be there the next time.
void let_beams_pass_small_pieces(GridPixels& pixels, double resolution) {
  std::vector<std::uint8_t> taken(pixels.pixels.size());
  for (std::int32_t row = 0; row < pixels.height; ++row) {
    for (std::int32_t column = 0; column < pixels.width; ++column) {
      if (!is_occupied(pixels.at(column, row)) || taken[pixels.offset(column, row)] != 0) { continue; }
      const Piece piece = piece_at(pixels, column, row, taken);
      if (resolution * piece.across() >= shortest_wall) { continue; }
      for (const std::size_t offset : piece.offsets) { pixels.pixels[offset] = GridPixel::passed; }
    }
  }
}

/// Steps from each pixel to the nearest free one, diagonal ones counted as one; at most `deepest` + 1. Two passes.
std::vector<std::uint8_t> steps_to_free(const GridPixels& pixels) {
  std::vector<std::uint8_t> steps(pixels.pixels.size(), deepest + 1);
  const auto come_from = [&](std::int32_t column, std::int32_t row, std::int32_t right, std::int32_t down) {
    if (!pixels.contains(column + right, row + down)) { return; }
    std::uint8_t& here = steps[pixels.offset(column, row)];
    const int there = steps[pixels.offset(column + right, row + down)];
    here = static_cast<std::uint8_t>(std::min<int>(here, there + 1));
  };
  const auto pass = [&](std::int32_t column, std::int32_t row, std::int32_t before) {
    if (pixels.at(column, row) == GridPixel::free) { steps[pixels.offset(column, row)] = 0; }
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

/// The part that an occupied pixel has in its wall: the eight around it tell whether it is the front of a thick one,
/// the layer behind that, or hidden farther inside.
GridPixel part_in_wall(const GridPixels& pixels, const std::vector<std::uint8_t>& steps, std::int32_t column,
                       std::int32_t row) {
  const GridPixel own = pixels.at(column, row);
  const std::uint8_t depth = steps[pixels.offset(column, row)];
  bool has_front = false;
  bool has_back = false;
  bool is_buried = true;
  for (std::int32_t y = row - 1; y <= row + 1; ++y) {
    for (std::int32_t x = column - 1; x <= column + 1; ++x) {
      if (!is_occupied(pixels.at(x, y))) {
        is_buried = false;
        continue;
      }
      has_front |= steps[pixels.offset(x, y)] < depth;
      has_back |= steps[pixels.offset(x, y)] > depth;
    }
  }
  if (depth == 1) { return has_back ? GridPixel::passed : own; }
  if (!has_front && !is_buried) { return own; }
  return depth == 2 && own == GridPixel::solid ? GridPixel::core : GridPixel::unknown;
}

GridPixels walls_of(const GridPixels& pixels) {
  const std::vector<std::uint8_t> steps = steps_to_free(pixels);
  GridPixels walls = pixels;
  for (std::int32_t row = 0; row < pixels.height; ++row) {
    for (std::int32_t column = 0; column < pixels.width; ++column) {
      if (!is_occupied(pixels.at(column, row))) { continue; }
      walls.pixels[pixels.offset(column, row)] = part_in_wall(pixels, steps, column, row);
    }
  }
  return walls;
}

}  // namespace

GridPixels grid_pixels(const GreyImage& image, const GridMapMetadata& metadata) {
  GridPixels pixels = read_pixels(image, metadata);
  let_beams_pass_small_pieces(pixels, metadata.resolution);
  return walls_of(pixels);
}

}  // namespace flirt
