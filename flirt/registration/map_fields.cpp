#include "flirt/registration/map_fields.hpp"

#include "flirt/grid/nearest_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

namespace flirt {
namespace {

/// The evidence over the map's box, as three marks a cell.
struct Marks {
  Raster<std::uint8_t> occupied;
  Raster<std::uint8_t> strong;
  Raster<std::uint8_t> seen;
  Raster<std::uint16_t> hits;
};

template <class T>
Raster<T> raster(std::int32_t width, std::int32_t height) {
  return Raster<T>(width, height);
}

Marks marks_of(const EvidenceGrid& grid, const CellBox& box) {
  const auto width = static_cast<std::int32_t>(box.width());
  const auto height = static_cast<std::int32_t>(box.height());
  Marks marks{raster<std::uint8_t>(width, height), raster<std::uint8_t>(width, height),
              raster<std::uint8_t>(width, height), raster<std::uint16_t>(width, height)};
  grid.for_each_row([&](CellIndex first, std::span<const EvidenceCell> row) {
    std::size_t at = marks.seen.offset(first.x - box.min.x, first.y - box.min.y);
    for (const EvidenceCell& cell : row) {
      marks.occupied.cells[at] = cell.occupied() ? 1 : 0;
      marks.strong.cells[at] = cell.strong() ? 1 : 0;
      marks.seen.cells[at] = cell.seen() ? 1 : 0;
      marks.hits.cells[at] = cell.hits;
      ++at;
    }
  });
  return marks;
}

/// Hits in the occupied cells around one: how many cells, and their moments about the middle cell.
struct Moments {
  int cells{0};
  double weight{0};
  double x{0}, y{0}, xx{0}, xy{0}, yy{0};
};

Moments moments_around(const Marks& marks, std::int32_t x, std::int32_t y, int radius) {
  Moments sum;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      if (dx * dx + dy * dy > radius * radius || !marks.occupied.contains(x + dx, y + dy)) { continue; }
      const std::size_t at = marks.occupied.offset(x + dx, y + dy);
      if (marks.occupied.cells[at] == 0) { continue; }
      const double w = marks.hits.cells[at];
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

/// Centre and main direction of the hits around an occupied cell. Where hits are sparse, a wider neighbourhood tells
/// the direction that a lone cell does not have; nothing where even that holds too few cells to tell.
std::optional<LinePiece> line_piece(const Marks& marks, std::int32_t x, std::int32_t y, int radius, double cell_size) {
  constexpr int enough_cells = 4;
  Moments sum = moments_around(marks, x, y, radius);
  for (int factor = 2; factor <= 4 && sum.cells < enough_cells; factor *= 2) {
    sum = moments_around(marks, x, y, factor * radius);
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
  return LinePiece{static_cast<float>((x + 0.5 + mean_x) * cell_size),
                   static_cast<float>((y + 0.5 + mean_y) * cell_size), static_cast<float>(-std::sin(along)),
                   static_cast<float>(std::cos(along)), static_cast<float>((mean - root) / (mean + root))};
}

/// Number of whole cells that a ray from any point of a cell may go before it can meet a marked one: centres are
/// `distance` cells apart, and both points may lie half a diagonal off.
double clear_cells(const CellOffset& marked) {
  const double beyond_reach = longest_reach;
  const bool none = marked.squared_distance == CellOffset::none;
  return std::max(0.0, (none ? beyond_reach : std::sqrt(marked.squared_distance)) - std::numbers::sqrt2);
}

/// For each cell how far a ray may go before it can meet a solid one, in cells: by the distance transform at full
/// resolution, and far from all walls by one over blocks of 4 × 4 cells, which reaches four times as far.
Raster<std::uint8_t> clearance_over(const Raster<std::uint8_t>& solid) {
  constexpr std::int32_t block = 4;
  Raster<std::uint8_t> solid_blocks =
      raster<std::uint8_t>((solid.width + block - 1) / block, (solid.height + block - 1) / block);
  for (std::int32_t y = 0; y < solid.height; ++y) {
    for (std::int32_t x = 0; x < solid.width; ++x) { solid_blocks.at(x / block, y / block) |= solid.at(x, y); }
  }
  const std::vector<CellOffset> near = nearest_cells(solid.cells, static_cast<std::size_t>(solid.width), longest_reach);
  const std::vector<CellOffset> far =
      nearest_cells(solid_blocks.cells, static_cast<std::size_t>(solid_blocks.width), longest_reach);
  Raster<std::uint8_t> clearance = raster<std::uint8_t>(solid.width, solid.height);
  for (std::int32_t y = 0; y < solid.height; ++y) {
    for (std::int32_t x = 0; x < solid.width; ++x) {
      const CellOffset& offset = near[solid.offset(x, y)];
      double clear = clear_cells(offset);
      if (offset.squared_distance == CellOffset::none) {
        clear = std::max(clear, block * clear_cells(far[solid_blocks.offset(x / block, y / block)]));
      }
      clearance.at(x, y) = solid.at(x, y) != 0 ? MapFields::solid : static_cast<std::uint8_t>(clear);
    }
  }
  return clearance;
}

void fill_fine_layers(MapFields& fields, const Marks& marks, const MapFieldParams& params) {
  const std::int32_t width = marks.seen.width;
  const std::int32_t height = marks.seen.height;
  const int reach = std::clamp(static_cast<int>(std::lround(params.reach / fields.cell_size)), 1, longest_reach);
  const auto columns = static_cast<std::size_t>(width);
  const std::vector<CellOffset> to_occupied = nearest_cells(marks.occupied.cells, columns, reach);
  fields.agreement = raster<std::uint8_t>(width, height);
  fields.clearance = clearance_over(marks.strong);
  fields.line = raster<std::uint32_t>(width, height);

  const int radius = std::max(1, static_cast<int>(std::lround(params.line_radius / fields.cell_size)));
  std::vector<std::uint32_t> line_of(marks.occupied.cells.size());
  for (std::int32_t y = 0; y < height; ++y) {
    for (std::int32_t x = 0; x < width; ++x) {
      if (marks.occupied.at(x, y) == 0) { continue; }
      const std::optional<LinePiece> piece = line_piece(marks, x, y, radius, fields.cell_size);
      if (!piece) { continue; }
      fields.lines.push_back(*piece);
      line_of[marks.occupied.offset(x, y)] = static_cast<std::uint32_t>(fields.lines.size());
    }
  }
  for (std::size_t at = 0; at < to_occupied.size(); ++at) {
    const CellOffset& nearest = to_occupied[at];
    const int state = marks.seen.cells[at] == 0       ? Agreement::unknown
                      : marks.occupied.cells[at] == 0 ? Agreement::free
                                                      : 0;
    fields.agreement.cells[at] =
        static_cast<std::uint8_t>(state | std::min<int>(nearest.squared_distance, Agreement::distance_mask));
    if (nearest.squared_distance == CellOffset::none) { continue; }
    const auto step = static_cast<std::ptrdiff_t>(nearest.dy) * width + nearest.dx;
    fields.line.cells[at] = line_of[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + step)];
  }
}

/// What the fine cells of one coarse cell are.
struct CoarseCell {
  int nearest{Agreement::distance_mask};  // cells², least squared distance to something occupied
  int free{0};
};

CoarseCell coarse_cell(const Raster<std::uint8_t>& agreement, std::int32_t x, std::int32_t y, std::int32_t factor) {
  CoarseCell coarse;
  for (std::int32_t v = y * factor; v < std::min((y + 1) * factor, agreement.height); ++v) {
    for (std::int32_t u = x * factor; u < std::min((x + 1) * factor, agreement.width); ++u) {
      const std::uint8_t cell = agreement.at(u, v);
      coarse.nearest = std::min(coarse.nearest, cell & Agreement::distance_mask);
      coarse.free += (cell & Agreement::free) != 0 ? 1 : 0;
    }
  }
  return coarse;
}

/// Value of a coarse cell: by its best fine cell where something occupied is near, less where most of it is free.
CoarseField coarse_field(const MapFields& fields, const MapFieldParams& params) {
  const auto factor = static_cast<std::int32_t>(params.coarse_factor);
  const std::int32_t width = (fields.agreement.width + factor - 1) / factor;
  const std::int32_t height = (fields.agreement.height + factor - 1) / factor;
  CoarseField coarse =
      unknown_field(width, height, factor * fields.cell_size, static_cast<std::uint8_t>(params.free_penalty),
                    static_cast<std::uint8_t>(params.free_penalty + params.coarse_peak));
  const double sigma = params.likelihood_sigma / fields.cell_size;
  for (std::int32_t y = 0; y < height; ++y) {
    for (std::int32_t x = 0; x < width; ++x) {
      const CoarseCell cell = coarse_cell(fields.agreement, x, y, factor);
      const bool far = cell.nearest == Agreement::distance_mask;
      const double likelihood = far ? 0.0 : std::exp(-cell.nearest / (2 * sigma * sigma));
      const bool is_free = 2 * cell.free > factor * factor;
      const double value = params.coarse_peak * likelihood + (is_free ? 0.0 : params.free_penalty);
      set_cell(coarse, {x, y}, static_cast<std::uint8_t>(std::lround(value)), cell.free > 0);
    }
  }
  finish(coarse, {0, 0}, {width, height});
  return coarse;
}

}  // namespace

std::size_t MapFields::bytes() const {
  return agreement.cells.size() + clearance.cells.size() + line.cells.size() * sizeof(line.cells[0]) +
         lines.size() * sizeof(LinePiece) + coarse.bytes();
}

MapFields map_fields(const EvidenceGrid& grid, const MapFieldParams& params) {
  MapFields fields;
  fields.cell_size = grid.params().cell_size;
  const auto box = grid.bounds();
  if (!box) { return fields; }
  fields.origin = {box->min.x * fields.cell_size, box->min.y * fields.cell_size};
  const Marks marks = marks_of(grid, *box);
  fill_fine_layers(fields, marks, params);
  fields.coarse = coarse_field(fields, params);
  return fields;
}

}  // namespace flirt
