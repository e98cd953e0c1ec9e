// flirt/map/grid_pixels.hpp: what the pixels of a grid map say to a scan: where it ends, and what it cannot pass.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/grid/grey_image.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace flirt {

/// Scans end on `passed` and `solid` pixels. No beam passes `solid` ones and the `core` of thick walls, which scans do
/// not reach. All three are occupied.
enum class GridPixel : std::uint8_t { free, unknown, passed, solid, core };

[[nodiscard]] inline bool is_occupied(GridPixel pixel) {
  return pixel >= GridPixel::passed;
}

/// Row by row from the top.
struct GridPixels {
  std::int32_t width{0};
  std::int32_t height{0};
  std::vector<GridPixel> pixels{};

  /// Outside everything is unknown.
  [[nodiscard]] GridPixel at(std::int32_t column, std::int32_t row) const {
    return contains(column, row) ? pixels[offset(column, row)] : GridPixel::unknown;
  }
  /// What is at a place in pixels from the lower left corner.
  [[nodiscard]] GridPixel at(Point2 in_pixels) const {
    if (!(in_pixels.x >= 0 && in_pixels.y >= 0 && in_pixels.x < width && in_pixels.y < height)) {
      return GridPixel::unknown;
    }
    return at(static_cast<std::int32_t>(in_pixels.x), height - 1 - static_cast<std::int32_t>(in_pixels.y));
  }
  [[nodiscard]] bool contains(std::int32_t column, std::int32_t row) const {
    return column >= 0 && row >= 0 && column < width && row < height;
  }
  [[nodiscard]] std::size_t offset(std::int32_t column, std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
};

/// A pixel is occupied when the map says so or calls it likelier than not (probability > 0.53; in maps of
/// probabilities, and in ours, what was hit once). It is free when the map says so, and in maps that show unseen space
/// as even odds when it is less likely than not (< 0.47): maps of probabilities seldom come down to the threshold.
///
/// Maps of three shades are black wherever anything was hit more than now and then. No beam passes what is, besides,
/// - black: nearer to certainty than to the threshold;
/// - part of a wall: of occupied pixels, connected across corners too, at least 0.6 m across. Legs, posts and what is
///   left about are smaller, and gone or moved when the next scan is taken;
/// - not the front of a thick wall. Where a wall is thicker than a pixel, those beside free space are what its scatter
///   has blackened: scans end there, and as many pass.
/// Behind the front of a thick wall the next pixels are its core, if black, and those farther in unknown, as in a map
/// that scans have made; scans would be drawn onto the middle of all that is occupied. O(pixels).
[[nodiscard]] GridPixels grid_pixels(const GreyImage& image, const GridMapMetadata& metadata);

}  // namespace flirt
