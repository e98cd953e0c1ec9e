#include "flirt/registration/coarse_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace flirt {
namespace {

constexpr std::int32_t tile_side = MapTile::side;
/// Fields begin at multiples of this many cells, so that the search's tiles are the same however a map is cut.
constexpr std::int32_t alignment = CoarseField::panel_height;
static_assert(alignment % CoarseField::pair_width == 0 && CoarseField::block_side % alignment == 0);

/// What the fine cells of one coarse cell are.
struct CoarseCell {
  int nearest{Agreement::distance_mask};  // cells², least squared distance to something occupied
  int free{0};
};

CoarseCell coarse_cell(const MapFields& fields, std::int32_t x, std::int32_t y, std::int32_t factor) {
  CoarseCell coarse;
  for (std::int32_t v = y * factor; v < (y + 1) * factor; ++v) {
    for (std::int32_t u = x * factor; u < (x + 1) * factor; ++u) {
      const MapTile* const tile = fields.tile_at(u, v);
      if (tile == nullptr) { continue; }
      const std::uint8_t cell = tile->agreement[MapTile::offset(u, v)];
      coarse.nearest = std::min(coarse.nearest, cell & Agreement::distance_mask);
      coarse.free += (cell & Agreement::free) != 0 ? 1 : 0;
    }
  }
  return coarse;
}

/// Coarse values by squared distance; by its best fine cell where something occupied is near, less where most is free.
class CoarseValues {
 public:
  explicit CoarseValues(const MapFields& fields) {
    const double sigma = fields.params.likelihood_sigma / fields.cell_size;
    for (int squared = 0; squared <= Agreement::distance_mask; ++squared) {
      const bool far = squared == Agreement::distance_mask;
      const double value = fields.params.coarse_peak * (far ? 0.0 : std::exp(-squared / (2 * sigma * sigma)));
      const auto at = static_cast<std::size_t>(squared);
      of_free_[at] = static_cast<std::uint8_t>(std::lround(value));
      of_other_[at] = static_cast<std::uint8_t>(std::lround(value + fields.params.free_penalty));
    }
  }
  [[nodiscard]] std::uint8_t of(const CoarseCell& cell, std::int32_t factor) const {
    const auto at = static_cast<std::size_t>(cell.nearest);
    return 2 * cell.free > factor * factor ? of_free_[at] : of_other_[at];
  }

 private:
  std::array<std::uint8_t, Agreement::distance_mask + 1> of_free_{};
  std::array<std::uint8_t, Agreement::distance_mask + 1> of_other_{};
};

CellBox intersection(const CellBox& a, const CellBox& b) {
  return {{std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y)},
          {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y)}};
}

bool is_nothing(const CellBox& box) {
  return box.min.x >= box.max.x || box.min.y >= box.max.y;
}

/// Fine layers, coarse cells, and how the map is cut into blocks.
class Coarsening {
 public:
  explicit Coarsening(const MapFields& fields)
      : fields_(fields),
        values_(fields),
        factor_(static_cast<std::int32_t>(fields.params.coarse_factor)),
        map_{{0, 0}, {end_of(fields.columns - 1), end_of(fields.rows - 1)}} {}

  [[nodiscard]] CellIndex blocks() const {
    constexpr std::int32_t side = CoarseField::block_side;
    return {(map_.max.x + side - 1) / side, (map_.max.y + side - 1) / side};
  }
  /// Around what is known in the block and near it; nothing when nothing in the block is.
  [[nodiscard]] CellBox box_of(CellIndex block) const;
  [[nodiscard]] CoarseField made(CellIndex block, const CellBox& box) const;
  /// Takes over those of the tiles that touch the field.
  [[nodiscard]] std::shared_ptr<const CoarseField> changed(const std::shared_ptr<const CoarseField>& before,
                                                           std::span<const CellIndex> tiles) const;

 private:
  [[nodiscard]] std::int32_t begin_of(std::int32_t tile) const { return tile * tile_side / factor_; }
  [[nodiscard]] std::int32_t end_of(std::int32_t tile) const {
    return ((tile + 1) * tile_side + factor_ - 1) / factor_;
  }
  [[nodiscard]] CellBox cells_of(CellIndex tile) const {
    return {{begin_of(tile.x), begin_of(tile.y)}, {end_of(tile.x), end_of(tile.y)}};
  }
  [[nodiscard]] CellBox core_of(CellIndex block) const {
    constexpr std::int32_t side = CoarseField::block_side;
    return intersection(map_, {{block.x * side, block.y * side}, {(block.x + 1) * side, (block.y + 1) * side}});
  }
  template <class Visit>
  void for_each_tile(const CellBox& box, const Visit& visit) const;
  void set_cells(CoarseField& field, const CellBox& box) const;

  const MapFields& fields_;
  CoarseValues values_;
  std::int32_t factor_;
  CellBox map_;
};

/// Calls visit(tile) for each tile of the map that touches a box of coarse cells.
template <class Visit>
void Coarsening::for_each_tile(const CellBox& box, const Visit& visit) const {
  const auto last = [this](std::int32_t end, std::int32_t count) {
    return std::min((end * factor_ - 1) / tile_side, count - 1);
  };
  for (std::int32_t y = box.min.y * factor_ / tile_side; y <= last(box.max.y, fields_.rows); ++y) {
    for (std::int32_t x = box.min.x * factor_ / tile_side; x <= last(box.max.x, fields_.columns); ++x) {
      if (fields_.tiles[row_offset(x, y, fields_.columns)] != nullptr) { visit(CellIndex{x, y}); }
    }
  }
}

CellBox Coarsening::box_of(CellIndex block) const {
  const CellBox core = core_of(block);
  const auto margin = static_cast<std::int32_t>(
      std::ceil(CoarseField::block_margin / (factor_ * fields_.cell_size * alignment)) * alignment);
  const CellBox around =
      intersection(map_, {{core.min.x - margin, core.min.y - margin}, {core.max.x + margin, core.max.y + margin}});
  bool any = false;
  CellBox box{around.max, around.min};
  for_each_tile(around, [&](CellIndex tile) {
    const CellBox cells = cells_of(tile);
    any |= !is_nothing(intersection(cells, core));
    box = {{std::min(box.min.x, cells.min.x), std::min(box.min.y, cells.min.y)},
           {std::max(box.max.x, cells.max.x), std::max(box.max.y, cells.max.y)}};
  });
  if (!any) { return {}; }
  box.min = {box.min.x / alignment * alignment, box.min.y / alignment * alignment};
  return intersection(box, around);
}

/// Cells of the map in a box, in which one can stand only if they are of the field's own block.
void Coarsening::set_cells(CoarseField& field, const CellBox& box) const {
  const CellBox core = core_of(field.block);
  for (std::int32_t y = box.min.y; y < box.max.y; ++y) {
    for (std::int32_t x = box.min.x; x < box.max.x; ++x) {
      const CoarseCell cell = coarse_cell(fields_, x, y, factor_);
      const bool own = x >= core.min.x && y >= core.min.y && x < core.max.x && y < core.max.y;
      set_cell(field, {x - field.first.x, y - field.first.y}, values_.of(cell, factor_), own && cell.free > 0);
    }
  }
}

CoarseField Coarsening::made(CellIndex block, const CellBox& box) const {
  const MapFieldParams& params = fields_.params;
  CoarseField field = unknown_field(static_cast<std::int32_t>(box.width()), static_cast<std::int32_t>(box.height()),
                                    factor_ * fields_.cell_size, static_cast<std::uint8_t>(params.free_penalty),
                                    static_cast<std::uint8_t>(params.free_penalty + params.coarse_peak));
  field.block = block;
  field.first = box.min;
  for_each_tile(box, [&](CellIndex tile) { set_cells(field, intersection(cells_of(tile), box)); });
  finish(field, {0, 0}, {field.width, field.height});
  return field;
}

std::shared_ptr<const CoarseField> Coarsening::changed(const std::shared_ptr<const CoarseField>& before,
                                                       std::span<const CellIndex> tiles) const {
  const CellBox all{before->first, {before->first.x + before->width, before->first.y + before->height}};
  std::shared_ptr<CoarseField> field;
  CellBox touched{all.max, all.min};
  for (const CellIndex& tile : tiles) {
    const CellBox cells = intersection(cells_of(tile), all);
    if (is_nothing(cells)) { continue; }
    if (!field) { field = std::make_shared<CoarseField>(*before); }
    set_cells(*field, cells);
    touched = {{std::min(touched.min.x, cells.min.x), std::min(touched.min.y, cells.min.y)},
               {std::max(touched.max.x, cells.max.x), std::max(touched.max.y, cells.max.y)}};
  }
  if (!field) { return before; }
  finish(*field, {touched.min.x - all.min.x, touched.min.y - all.min.y},
         {touched.max.x - all.min.x, touched.max.y - all.min.y});
  return field;
}

}  // namespace

std::vector<std::shared_ptr<const CoarseField>> coarse_fields(
    const MapFields& fields, std::span<const std::shared_ptr<const CoarseField>> before,
    std::span<const CellIndex> changed) {
  const Coarsening coarsening(fields);
  std::vector<std::shared_ptr<const CoarseField>> made;
  for (std::int32_t y = 0; y < coarsening.blocks().y; ++y) {
    for (std::int32_t x = 0; x < coarsening.blocks().x; ++x) {
      const CellBox box = coarsening.box_of({x, y});
      if (is_nothing(box)) { continue; }
      const auto same = std::ranges::find_if(before, [&](const auto& old) {
        return old->block == CellIndex{x, y} && old->first == box.min &&
               old->width == static_cast<std::int32_t>(box.width()) &&
               old->height == static_cast<std::int32_t>(box.height());
      });
      made.push_back(same != before.end() ? coarsening.changed(*same, changed)
                                          : std::make_shared<const CoarseField>(coarsening.made({x, y}, box)));
    }
  }
  return made;
}

}  // namespace flirt
