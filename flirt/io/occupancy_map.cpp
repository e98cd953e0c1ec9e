#include "flirt/io/occupancy_map.hpp"

#include "flirt/io/pgm.hpp"

#include <algorithm>
#include <limits>

namespace flirt {
namespace {

constexpr std::uint8_t solid_pixel = 0;
constexpr std::uint8_t occupied_pixel = 60;   // probability .76: occupied to a map_server, too
constexpr std::uint8_t hit_once_pixel = 115;  // .55: unknown to a map_server
constexpr std::uint8_t free_pixel = 254;
constexpr std::uint8_t unknown_pixel = 205;
constexpr std::size_t most_cells_a_side = 16;  // of a pixel

/// Smallest box around the cells that were seen; nothing for an empty grid.
std::optional<CellBox> seen_box(const EvidenceGrid& grid) {
  constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
  CellBox box{{most, most}, {-most, -most}};
  grid.for_each_row([&](CellIndex first, std::span<const EvidenceCell> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (!row[i].seen()) { continue; }
      const std::int32_t x = first.x + static_cast<std::int32_t>(i);
      box.min = {std::min(box.min.x, x), std::min(box.min.y, first.y)};
      box.max = {std::max(box.max.x, x + 1), std::max(box.max.y, first.y + 1)};
    }
  });
  return box.min.x < box.max.x ? std::optional(box) : std::nullopt;
}

std::uint8_t pixel(const EvidenceCell& cell) {
  if (!cell.seen()) { return unknown_pixel; }
  if (cell.strong()) { return solid_pixel; }
  if (!cell.occupied()) { return free_pixel; }
  return cell.hits >= 2 ? occupied_pixel : hit_once_pixel;
}

std::size_t pixels_for(std::size_t cells, std::size_t cells_a_side) {
  return (cells + cells_a_side - 1) / cells_a_side;
}

/// Cells a side of a pixel: 1, or more where that would be too many pixels.
std::size_t pixel_side(const CellBox& box) {
  std::size_t side = pixels_for(std::max(box.width(), box.height()), most_pixels_a_side);
  while (pixels_for(box.width(), side) > most_pixels / pixels_for(box.height(), side)) { ++side; }
  return side;
}

}  // namespace

Result<GridMapImage> occupancy_map(const EvidenceGrid& grid, const std::string& image_name) {
  GridMapImage map;
  map.metadata.image = image_name;
  map.metadata.resolution = grid.params().cell_size;
  const auto box = seen_box(grid);
  if (!box) {
    map.image = {1, 1, {unknown_pixel}};
    return map;
  }
  const std::size_t side = pixel_side(*box);
  if (side > most_cells_a_side) {
    return fail("expected scans near each other, found a map of " + std::to_string(box->width()) + " x " +
                std::to_string(box->height()) + " cells");
  }
  map.metadata.resolution *= static_cast<double>(side);
  map.metadata.origin = {box->min.x * grid.params().cell_size, box->min.y * grid.params().cell_size, 0};
  map.image = {pixels_for(box->width(), side), pixels_for(box->height(), side), {}};
  map.image.pixels.assign(map.image.width * map.image.height, unknown_pixel);
  grid.for_each_row([&](CellIndex first, std::span<const EvidenceCell> row) {
    if (first.y < box->min.y || first.y >= box->max.y) { return; }
    const std::size_t image_row = map.image.height - 1 - static_cast<std::size_t>(first.y - box->min.y) / side;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::int32_t x = first.x + static_cast<std::int32_t>(i);
      if (!row[i].seen() || x < box->min.x || x >= box->max.x) { continue; }
      const std::size_t column = static_cast<std::size_t>(x - box->min.x) / side;
      std::uint8_t& at = map.image.pixels[image_row * map.image.width + column];
      at = at == unknown_pixel ? pixel(row[i]) : std::min(at, pixel(row[i]));
    }
  });
  return map;
}

}  // namespace flirt
