// flirt/grid/grey_image.hpp: an 8-bit grey raster, and what a ROS grid map says about one.
#pragma once

#include "flirt/core/pose2.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace flirt {

/// Rows from top to bottom, pixels from left to right; 0 is black.
struct GreyImage {
  std::size_t width{0};                ///< pixels
  std::size_t height{0};               ///< pixels
  std::vector<std::uint8_t> pixels{};  ///< width · height, row after row

  [[nodiscard]] std::uint8_t at(std::size_t column, std::size_t row) const { return pixels[row * width + column]; }
  friend bool operator==(const GreyImage&, const GreyImage&) = default;
};

/// How a ROS map_server reads pixels as occupancy.
enum class GridMapMode : std::uint8_t {
  trinary,  ///< occupied above occupied_thresh, free below free_thresh, else unknown
  scale,    ///< as trinary, with the probability in between
  raw,      ///< the pixel is the occupancy in per cent, above 100 unknown
};

/// The YAML file beside the image of a ROS grid map, field names as there.
struct GridMapMetadata {
  std::string image{};           ///< file name, relative to the YAML file
  double resolution{0.05};       ///< m per pixel
  Pose2 origin{};                ///< map_from_image: pose of the image's lower left corner in the map
  bool negate{false};            ///< true: white is occupied
  double occupied_thresh{0.65};  ///< probability above which a cell is occupied
  double free_thresh{0.196};     ///< probability below which a cell is free
  GridMapMode mode{GridMapMode::trinary};

  friend bool operator==(const GridMapMetadata&, const GridMapMetadata&) = default;
};

/// What a pixel of a grid map says.
enum class CellState : std::uint8_t { free, occupied, unknown };

/// Probability that the pixel's cell is occupied (dark is occupied unless `negate`); in raw mode the pixel itself is
/// the probability in per cent, and values above 1 mean unknown.
[[nodiscard]] inline double occupancy(std::uint8_t pixel, const GridMapMetadata& metadata) {
  const int shade = metadata.negate ? 255 - pixel : pixel;
  return metadata.mode == GridMapMode::raw ? shade / 100.0 : (255 - shade) / 255.0;
}

/// The state of a pixel's cell by the thresholds of the metadata (map_server's rule).
[[nodiscard]] inline CellState cell_state(std::uint8_t pixel, const GridMapMetadata& metadata) {
  const double probability = occupancy(pixel, metadata);
  if (probability > 1.0) { return CellState::unknown; }
  if (probability > metadata.occupied_thresh) { return CellState::occupied; }
  return probability < metadata.free_thresh ? CellState::free : CellState::unknown;
}

/// Centre of a pixel in the map, m.
[[nodiscard]] inline Point2 map_point(std::size_t column, std::size_t row, const GreyImage& image,
                                      const GridMapMetadata& metadata) {
  const double x = (static_cast<double>(column) + 0.5) * metadata.resolution;
  const double y = (static_cast<double>(image.height - row) - 0.5) * metadata.resolution;
  return metadata.origin * Point2{x, y};
}

}  // namespace flirt
