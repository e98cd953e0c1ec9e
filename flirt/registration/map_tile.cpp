#include "flirt/registration/map_tile.hpp"

#include "flirt/grid/nearest_cells.hpp"
#include "flirt/registration/raster.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace flirt {
namespace {

constexpr std::int32_t side = MapTile::side;
constexpr std::int32_t block = 4;  // cells, of the distance transform far from walls
constexpr std::int32_t clearance_margin = block * longest_reach;

/// At most `longest_reach`, which the range of the field keeps to in cells of 5 cm.
int reach_cells(const MapFieldParams& params, double cell_size) {
  return std::clamp(static_cast<int>(std::lround(params.reach / cell_size)), 1, longest_reach);
}
int line_radius_cells(const MapFieldParams& params, double cell_size) {
  return std::max(1, static_cast<int>(std::lround(params.line_radius / cell_size)));
}
constexpr int widest_line = 4;  // times the radius, where hits are sparse

/// Evidence marks over the tile and a margin around it: window cell (x, y) is cell (x − margin, y − margin) of the
/// tile.
struct Window {
  std::int32_t margin{0};
  Raster<std::uint8_t> marks;
  Raster<std::uint16_t> hits;

  [[nodiscard]] Raster<std::uint8_t> only(std::uint8_t mark, std::int32_t around) const {
    Raster<std::uint8_t> chosen(side + 2 * around, side + 2 * around);
    for (std::int32_t y = 0; y < chosen.height; ++y) {
      const std::uint8_t* const from = &marks.at(margin - around, y + margin - around);
      std::uint8_t* const to = &chosen.at(0, y);
      for (std::int32_t x = 0; x < chosen.width; ++x) { to[x] = from[x] & mark; }
    }
    return chosen;
  }
};

Window window_of(const TileSurroundings& around, std::int32_t margin) {
  const std::int32_t width = side + 2 * margin;
  Window window{margin, {width, width}, {width, width}};
  for (std::int32_t dy = -around.reach; dy <= around.reach; ++dy) {
    for (std::int32_t dx = -around.reach; dx <= around.reach; ++dx) {
      const TileMarks* const marks = around.at(dx, dy);
      if (marks == nullptr) { continue; }
      const std::int32_t x0 = std::max(dx * side, -margin);
      const std::int32_t x1 = std::min((dx + 1) * side, side + margin);
      for (std::int32_t y = std::max(dy * side, -margin); y < std::min((dy + 1) * side, side + margin) && x0 < x1;
           ++y) {
        const std::size_t from = MapTile::offset(x0, y);
        const auto n = static_cast<std::size_t>(x1 - x0);
        std::copy_n(&marks->marks[from], n, &window.marks.at(x0 + margin, y + margin));
        std::copy_n(&marks->hits[from], n, &window.hits.at(x0 + margin, y + margin));
      }
    }
  }
  return window;
}

/// Hits in the occupied cells around one: how many cells, and their moments about the middle cell.
struct Moments {
  int cells{0};
  double weight{0};
  double x{0}, y{0}, xx{0}, xy{0}, yy{0};
};

Moments moments_around(const Window& window, std::int32_t x, std::int32_t y, int radius) {
  Moments sum;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      const double w = window.hits.at(x + dx, y + dy);
      if (w == 0 || dx * dx + dy * dy > radius * radius) { continue; }
      ++sum.cells;
      sum.weight += w;
      sum.x += w * dx;
      sum.y += w * dy;
      sum.xx += w * dx * dx;
      sum.xy += w * dx * dy;
      sum.yy += w * dy * dy;
    }
  }
  return sum;
}

/// Centre and main direction of the hits around an occupied cell of the window. Where hits are sparse, a wider
/// neighbourhood tells the direction that a lone cell does not have; nothing where even that holds too few cells.
std::optional<LinePiece> line_piece(const Window& window, std::int32_t x, std::int32_t y, int radius,
                                    double cell_size) {
  constexpr int enough_cells = 4;
  Moments sum = moments_around(window, x, y, radius);
  for (int factor = 2; factor <= widest_line && sum.cells < enough_cells; factor *= 2) {
    sum = moments_around(window, x, y, factor * radius);
  }
  if (sum.cells < enough_cells) { return std::nullopt; }
  const double mean_x = sum.x / sum.weight;
  const double mean_y = sum.y / sum.weight;
  // A hit is known to its cell only: variance 1/12 of a cell in each direction.
  const double xx = sum.xx / sum.weight - mean_x * mean_x + 1.0 / 12;
  const double xy = sum.xy / sum.weight - mean_x * mean_y;
  const double yy = sum.yy / sum.weight - mean_y * mean_y + 1.0 / 12;
  const double half_difference = 0.5 * (xx - yy);
  const double root = std::sqrt(half_difference * half_difference + xy * xy);
  const double mean = 0.5 * (xx + yy);
  const double along = 0.5 * std::atan2(2 * xy, xx - yy);
  return LinePiece{static_cast<float>((x - window.margin + 0.5 + mean_x) * cell_size),
                   static_cast<float>((y - window.margin + 0.5 + mean_y) * cell_size),
                   static_cast<float>(-std::sin(along)), static_cast<float>(std::cos(along)),
                   static_cast<float>((mean - root) / (mean + root))};
}

/// Nearest occupied cells of the tile and a margin of their reach.
std::vector<CellOffset> to_occupied(const Window& window, int reach) {
  const Raster<std::uint8_t> occupied = window.only(TileMarks::occupied, reach);
  return nearest_cells(occupied.cells, static_cast<std::size_t>(occupied.width), reach);
}

const CellOffset& nearest_at(const std::vector<CellOffset>& nearest, int reach, std::int32_t x, std::int32_t y) {
  return nearest[row_offset(x + reach, y + reach, side + 2 * reach)];
}

void fill_agreement(MapTile& tile, const Window& window, const std::vector<CellOffset>& nearest, int reach) {
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      const std::uint8_t marks = window.marks.at(x + window.margin, y + window.margin);
      const int state = (marks & TileMarks::seen) == 0       ? Agreement::unknown
                        : (marks & TileMarks::occupied) == 0 ? Agreement::free
                                                             : 0;
      const int squared = std::min<int>(nearest_at(nearest, reach, x, y).squared_distance, Agreement::distance_mask);
      tile.agreement[MapTile::offset(x, y)] = static_cast<std::uint8_t>(state | squared);
    }
  }
}

void fill_lines(MapTile& tile, const Window& window, const std::vector<CellOffset>& nearest, int reach,
                const MapFieldParams& params, double cell_size) {
  const int radius = line_radius_cells(params, cell_size);
  constexpr std::uint16_t not_made = 0xffff;
  Raster<std::uint16_t> line_of(side + 2 * reach, side + 2 * reach, not_made);
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      const CellOffset& offset = nearest_at(nearest, reach, x, y);
      if (offset.squared_distance == CellOffset::none) { continue; }
      const std::int32_t at_x = x + offset.dx;
      const std::int32_t at_y = y + offset.dy;
      std::uint16_t& line = line_of.at(at_x + reach, at_y + reach);
      if (line == not_made) {
        const auto piece = line_piece(window, at_x + window.margin, at_y + window.margin, radius, cell_size);
        if (piece) { tile.lines.push_back(*piece); }
        line = piece ? static_cast<std::uint16_t>(tile.lines.size()) : std::uint16_t{0};
      }
      tile.line[MapTile::offset(x, y)] = line;
    }
  }
}

/// `MapTile::clearance` by the squared distance between the centres of two cells, `scale` cells to a unit of it: as far
/// as a ray from any point of one may go before it can meet the other, since both points may lie half a diagonal off.
using ClearanceOf = std::array<std::uint8_t, CellOffset::none + 1>;
ClearanceOf clearances(double scale, double least) {
  ClearanceOf clearance{};
  for (std::size_t squared = 0; squared < clearance.size(); ++squared) {
    const double away = squared == CellOffset::none ? longest_reach : std::sqrt(static_cast<double>(squared));
    clearance[squared] = static_cast<std::uint8_t>(std::max(least, scale * (away - std::numbers::sqrt2)));
  }
  return clearance;
}

/// Blocks of 4 × 4 cells of the window that hold one with the mark.
Raster<std::uint8_t> blocks_with(const Window& window, std::uint8_t mark, std::int32_t around) {
  const std::int32_t cells = side + 2 * around;
  Raster<std::uint8_t> blocks(cells / block, cells / block);
  for (std::int32_t y = 0; y < cells; ++y) {
    const std::uint8_t* const row = &window.marks.at(window.margin - around, y + window.margin - around);
    std::uint8_t* const to = &blocks.at(0, y / block);
    for (std::int32_t x = 0; x < blocks.width; ++x) {
      const std::uint8_t* const four = row + static_cast<std::ptrdiff_t>(block) * x;
      to[x] |= static_cast<std::uint8_t>((four[0] | four[1] | four[2] | four[3]) & mark);
    }
  }
  return blocks;
}

/// For each cell how far a ray may go before it can meet a solid one, in cells: by the distance transform at full
/// resolution, and far from all walls by one over blocks of 4 × 4 cells, which reaches four times as far.
void fill_clearance(MapTile& tile, const Window& window) {
  static const ClearanceOf near_clearance = clearances(1, 0);
  static const ClearanceOf far_clearance = clearances(block, longest_reach - std::numbers::sqrt2);
  const Raster<std::uint8_t> blocks = blocks_with(window, TileMarks::strong, clearance_margin);
  if (std::ranges::count(blocks.cells, 0) == std::ssize(blocks.cells)) {
    tile.clearance.fill(MapTile::clear);
    return;
  }
  const Raster<std::uint8_t> solid = window.only(TileMarks::strong, longest_reach);
  const std::vector<CellOffset> near = nearest_cells(solid.cells, static_cast<std::size_t>(solid.width), longest_reach);
  const std::vector<CellOffset> far =
      nearest_cells(blocks.cells, static_cast<std::size_t>(blocks.width), longest_reach);
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      const std::uint8_t squared = nearest_at(near, longest_reach, x, y).squared_distance;
      std::uint8_t& clearance = tile.clearance[MapTile::offset(x, y)];
      if (squared == 0) {
        clearance = MapTile::solid;
      } else if (squared != CellOffset::none) {
        clearance = near_clearance[squared];
      } else {
        const std::size_t at = blocks.offset((x + clearance_margin) / block, (y + clearance_margin) / block);
        clearance = far_clearance[far[at].squared_distance];
      }
    }
  }
}

std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9e3779b97f4a7c15ULL;
  return hash ^ (hash >> 29U);
}

}  // namespace

TileMarks::TileMarks(std::span<const EvidenceCell> cells) {
  for (std::size_t i = 0; i < cells.size(); i += 4) {
    std::uint64_t shapes = 0;
    std::uint64_t solids = 0;
    std::uint64_t weights = 0;
    for (std::size_t k = i; k < i + 4; ++k) {
      const EvidenceCell& cell = cells[k];
      const bool is_occupied = cell.occupied();
      marks[k] = static_cast<std::uint8_t>((is_occupied ? occupied : 0) | (cell.strong() ? strong : 0) |
                                           (cell.seen() ? seen : 0));
      hits[k] = is_occupied ? cell.hits : std::uint16_t{0};
      shapes = shapes << 8U | static_cast<std::uint64_t>(marks[k] & (occupied | seen));
      solids = solids << 8U | static_cast<std::uint64_t>(marks[k] & strong);
      weights = weights << 16U | hits[k];
    }
    shape = mixed(shape, shapes);
    solid = mixed(solid, solids);
    weight = mixed(weight, weights);
  }
}

std::int32_t tile_reach(const MapFieldParams& params, double cell_size) {
  const std::int32_t lines = reach_cells(params, cell_size) + widest_line * line_radius_cells(params, cell_size);
  return (std::max(lines, clearance_margin) + side - 1) / side;
}

MapTile::Sources sources_of(const TileSurroundings& around) {
  MapTile::Sources sources;
  for (const TileMarks* marks : around.marks) {
    sources.agreement = mixed(sources.agreement, marks != nullptr ? marks->shape : 1);
    sources.clearance = mixed(sources.clearance, marks != nullptr ? marks->solid : 1);
    sources.line = mixed(sources.line, marks != nullptr ? marks->weight : 1);
  }
  return sources;
}

bool is_far_from_all(const TileSurroundings& around, const MapFieldParams& params, double cell_size) {
  if (around.at(0, 0) != nullptr) { return false; }
  const int reach = reach_cells(params, cell_size);
  const Window window = window_of(around, clearance_margin);
  const auto holds = [&](std::uint8_t mark, std::int32_t within) {
    return std::ranges::any_of(window.only(mark, within).cells, [](std::uint8_t cell) { return cell != 0; });
  };
  return !holds(TileMarks::occupied, reach) && !holds(TileMarks::strong, clearance_margin);
}

MapTile map_tile(const TileSurroundings& around, const MapFieldParams& params, double cell_size,
                 const MapTile* before) {
  const int reach = reach_cells(params, cell_size);
  const Window window =
      window_of(around, std::max(clearance_margin, reach + widest_line * line_radius_cells(params, cell_size)));
  MapTile tile{.sources = sources_of(around)};
  const bool same_shape = before != nullptr && before->sources.agreement == tile.sources.agreement;
  const bool same_solid = before != nullptr && before->sources.clearance == tile.sources.clearance;
  const bool same_lines = before != nullptr && before->sources.line == tile.sources.line;
  const std::vector<CellOffset> nearest =
      same_shape && same_lines ? std::vector<CellOffset>{} : to_occupied(window, reach);
  if (same_shape) {
    tile.agreement = before->agreement;
  } else {
    fill_agreement(tile, window, nearest, reach);
  }
  if (same_solid) {
    tile.clearance = before->clearance;
  } else {
    fill_clearance(tile, window);
  }
  if (same_lines) {
    tile.line = before->line;
    tile.lines = before->lines;
  } else {
    fill_lines(tile, window, nearest, reach, params, cell_size);
  }
  return tile;
}

bool is_blank(const MapTile& tile) {
  constexpr std::uint8_t nothing = Agreement::unknown | Agreement::distance_mask;
  return std::ranges::all_of(tile.agreement, [](std::uint8_t cell) { return cell == nothing; }) &&
         std::ranges::all_of(tile.clearance, [](std::uint8_t cell) { return cell == MapTile::clear; });
}

}  // namespace flirt
