#include "flirt/registration/coarse_field.hpp"

#include <algorithm>

namespace flirt {
namespace {

constexpr std::int32_t quad_side = CoarseField::tile_side;
constexpr std::int32_t pad_x = CoarseField::pair_width;
constexpr std::int32_t pad_y = quad_side;

std::uint8_t quad_peak(const CoarseField::Quad& quad) {
  return *std::ranges::max_element(quad);
}

/// Peaks of the tiles that hold a cell of the box.
void refresh_peaks(CoarseField& field, CellIndex min, CellIndex max) {
  const std::int32_t first_x = min.x - quad_side + 1;
  const std::int32_t columns = max.x - first_x;
  const auto stride = static_cast<std::size_t>(field.peak_stride());
  std::vector<std::uint8_t> row(static_cast<std::size_t>(columns + quad_side - 1));
  for (std::int32_t y = min.y - quad_side + 1; y < max.y; ++y) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = quad_peak(field.quads.at(first_x + static_cast<std::int32_t>(i) + pad_x, y + pad_y));
    }
    // Not negative: tiles may begin up to three cells outside of the map.
    const auto tile_y = static_cast<std::size_t>(y + CoarseField::panel_height) / quad_side;
    const auto phase_y = static_cast<std::size_t>(y + CoarseField::panel_height) % quad_side;
    for (std::int32_t i = 0; i < columns; ++i) {
      const auto x = static_cast<std::size_t>(first_x + CoarseField::panel_width) + static_cast<std::size_t>(i);
      const std::size_t phase = phase_y * quad_side + x % quad_side;
      const auto at = row.begin() + i;
      field.peaks[(tile_y * CoarseField::phases + phase) * stride + x / quad_side] =
          *std::max_element(at, at + quad_side);
    }
  }
}

bool standable_in(const CoarseField& field, CellIndex corner) {
  for (std::int32_t y = corner.y; y < std::min(corner.y + quad_side, field.height); ++y) {
    for (std::int32_t x = corner.x; x < std::min(corner.x + CoarseField::pair_width, field.width); ++x) {
      if (field.standable.at(x, y) != 0) { return true; }
    }
  }
  return false;
}

CoarseField::Panel panel_at(const CoarseField& field, CellIndex corner) {
  CoarseField::Panel panel{.corner = corner};
  std::size_t pair = 0;
  for (std::int32_t row = 0; row < CoarseField::panel_rows; ++row) {
    for (std::int32_t column = 0; column < CoarseField::panel_columns; ++column, ++pair) {
      const CellIndex at{corner.x + column * CoarseField::pair_width, corner.y + row * quad_side};
      if (!standable_in(field, at)) { continue; }
      panel.pairs[pair] = 255;
      for (std::size_t i = 0; i < CoarseField::pair_cells; ++i) {
        const std::int32_t x = at.x + static_cast<std::int32_t>(i) / quad_side;
        const std::int32_t y = at.y + static_cast<std::int32_t>(i) % quad_side;
        if (field.standable.contains(x, y)) {
          panel.standable[pair * CoarseField::pair_cells + i] = field.standable.at(x, y);
        }
      }
    }
  }
  return panel;
}

/// From left to right in each band of a panel's height, each panel beginning where something is.
void place_panels(CoarseField& field) {
  field.panels.clear();
  for (std::int32_t y = 0; y < field.height; y += CoarseField::panel_height) {
    for (std::int32_t x = 0; x < field.width;) {
      bool any = false;
      for (std::int32_t row = 0; row < CoarseField::panel_rows && !any; ++row) {
        any = standable_in(field, {x, y + row * quad_side});
      }
      if (any) { field.panels.push_back(panel_at(field, {x, y})); }
      x += any ? CoarseField::panel_width : CoarseField::pair_width;
    }
  }
}

}  // namespace

std::uint8_t CoarseField::value(std::int32_t x, std::int32_t y) const {
  const bool inside = x >= 0 && y >= 0 && x < width && y < height;
  return inside ? quads.at(x + pad_x, y + pad_y)[0] : unknown;
}

double CoarseField::searched_area() const {
  return static_cast<double>(panels.size()) * panel_width * panel_height * cell_size * cell_size;
}

std::size_t CoarseField::bytes() const {
  return quads.cells.size() * sizeof(Quad) + standable.cells.size() + peaks.size() + panels.size() * sizeof(Panel);
}

CoarseField unknown_field(std::int32_t width, std::int32_t height, double cell_size, std::uint8_t unknown,
                          std::uint8_t largest) {
  CoarseField field{.cell_size = cell_size, .unknown = unknown, .largest = largest, .width = width, .height = height};
  CoarseField::Quad quad{};
  quad.fill(unknown);
  field.quads = {width + 2 * pad_x, height + 2 * pad_y, quad};
  field.standable = {width, height};
  field.peaks.assign(
      CoarseField::phases * static_cast<std::size_t>(field.peak_stride()) * static_cast<std::size_t>(field.peak_rows()),
      unknown);
  return field;
}

void set_cell(CoarseField& field, CellIndex cell, std::uint8_t value, bool standable) {
  for (std::int32_t i = 0; i < quad_side; ++i) {
    field.quads.at(cell.x + pad_x, cell.y - i + pad_y)[static_cast<std::size_t>(i)] = value;
  }
  field.standable.at(cell.x, cell.y) = standable ? 255 : 0;
}

void finish(CoarseField& field, CellIndex min, CellIndex max) {
  refresh_peaks(field, min, max);
  place_panels(field);
}

}  // namespace flirt
