// flirt/grid/evidence_grid.hpp: what many scans at known poses say about each place: how often a beam ended there, and
// how often one passed.
//
//   EvidenceGrid grid;
//   for (std::size_t i = 0; i < log.scans.size(); ++i) { grid.add(log.scans[i], log.map_from_sensor(i)); }
//   grid.remove(log.scans[7], log.map_from_sensor(7));       // as if scan 7 had never been added, bit for bit
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/grid/beam_traversal.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace flirt {

struct EvidenceGridParams {
  double cell_size{0.05};  ///< m
  double range_min{0.05};  ///< m, shorter readings say nothing
  double range_max{50.0};  ///< m, longer readings say nothing

  friend bool operator==(const EvidenceGridParams&, const EvidenceGridParams&) = default;
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, EvidenceGridParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.cell_size, Field{"cell_size", "m", "side of a cell of the evidence grid", 0.01, 1.0});
  visit(params.range_min, Field{"range_min", "m", "shorter readings leave no evidence", 0.0, 10.0});
  visit(params.range_max, Field{"range_max", "m", "longer readings leave no evidence", 0.1, 100.0});
}

/// What the beams said about one cell.
struct EvidenceCell {
  std::uint16_t hits{0};    ///< beams that ended here
  std::uint16_t passes{0};  ///< beams that crossed the cell before their end cell, one per beam

  [[nodiscard]] bool seen() const { return hits != 0 || passes != 0; }
  /// Share of the beams that ended here; 0 for a cell never seen.
  [[nodiscard]] double hit_ratio() const { return seen() ? hits / static_cast<double>(hits + passes) : 0.0; }
  /// Something stands here, at least at its edge or at times: hit ratio ≥ 0.15.
  [[nodiscard]] bool occupied() const { return hits != 0 && 20 * hits >= 3 * (hits + passes); }
  /// Something solid: ≥ 2 hits, and not fewer than passes.
  [[nodiscard]] bool strong() const { return hits >= 2 && hits >= passes; }
  [[nodiscard]] bool free() const { return seen() && !occupied(); }
  friend bool operator==(const EvidenceCell&, const EvidenceCell&) = default;
};

/// Cells [min, max) of a grid.
struct CellBox {
  CellIndex min;
  CellIndex max;

  [[nodiscard]] constexpr std::size_t width() const { return static_cast<std::size_t>(max.x - min.x); }
  [[nodiscard]] constexpr std::size_t height() const { return static_cast<std::size_t>(max.y - min.y); }
  friend bool operator==(const CellBox&, const CellBox&) = default;
};

/// Hits and passes of all beams of many scans, in tiles of 64 × 64 cells that exist where a beam has been: 16 kB per
/// 10 m² of seen area at 0.05 m, wherever the map's origin is. Counts depend on the set of scans only, never on the
/// order in which they came. A count that reaches 65535 stays there; `lost_counts` says how often that happened.
class EvidenceGrid {
 public:
  static constexpr std::int32_t tile_side = 64;  ///< cells

  explicit EvidenceGrid(const EvidenceGridParams& params = {}) : params_(params) {}
  /// The grid that `save_tiles` took apart: cells of each tile row by row, tile after tile. `cells` holds
  /// tile_side² · tiles.size() values, and no tile comes twice.
  EvidenceGrid(const EvidenceGridParams& params, std::span<const CellIndex> tiles, std::span<const EvidenceCell> cells);

  /// Counts each beam of `scan` with a reading in [range_min, range_max): one pass for each cell before its end cell,
  /// one hit there. Beams without a return leave no evidence: how far they were free is not known. The pose must be
  /// finite and within 10⁷ m. O(cells crossed).
  void add(const Scan& scan, const Pose2& map_from_sensor);

  /// Takes back an earlier `add` of the same scan at the same pose; the grid then equals one that never had it, unless
  /// counts were lost.
  void remove(const Scan& scan, const Pose2& map_from_sensor);

  [[nodiscard]] const EvidenceGridParams& params() const { return params_; }
  /// The cell at a place of the map.
  [[nodiscard]] CellIndex index(Point2 in_map) const {
    return {static_cast<std::int32_t>(std::floor(in_map.x / params_.cell_size)),
            static_cast<std::int32_t>(std::floor(in_map.y / params_.cell_size))};
  }
  [[nodiscard]] EvidenceCell cell(CellIndex index) const;

  /// Smallest box of whole tiles around everything seen; nothing for an empty grid.
  [[nodiscard]] std::optional<CellBox> bounds() const;
  /// Counts that were not counted because a cell was full; 0 means that every add can be taken back exactly.
  [[nodiscard]] std::uint64_t lost_counts() const { return lost_counts_; }
  /// Bytes of the tiles.
  [[nodiscard]] std::size_t bytes() const { return tiles_.size() * sizeof(Tile); }

  /// Indices of all tiles (in tiles) in the order of rows, then columns, and their cells in the same order.
  struct SavedTiles {
    std::vector<CellIndex> tiles;
    std::vector<EvidenceCell> cells;
  };
  [[nodiscard]] SavedTiles save_tiles() const;

  /// Adds counts to a cell: for evidence that does not come from scans, such as a grid map.
  void count(CellIndex index, EvidenceCell evidence);

  /// Calls visit(CellIndex first, std::span<const EvidenceCell> row) for each row of each tile, a tile's rows one after
  /// the other, tiles in no particular order.
  template <class Visit>
  void for_each_row(const Visit& visit) const;

  /// Calls visit(CellIndex tile, std::span<const EvidenceCell> cells) for each tile, its cells row by row; tiles in no
  /// particular order, their indices in tiles.
  template <class Visit>
  void for_each_tile(const Visit& visit) const {
    for (const Tile& tile : tiles_) { visit(tile.index, std::span<const EvidenceCell>(tile.cells)); }
  }

  /// Equal evidence in every cell, and equal parameters.
  friend bool operator==(const EvidenceGrid& a, const EvidenceGrid& b);

 private:
  using Cells = std::array<EvidenceCell, static_cast<std::size_t>(tile_side* tile_side)>;
  struct Tile {
    CellIndex index;          // in tiles
    std::uint64_t counts{0};  // hits and passes in all cells; a tile without any is dropped
    Cells cells{};
  };
  struct TileHash {
    std::size_t operator()(CellIndex index) const {
      const auto key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(index.x)) << 32U) |
                       static_cast<std::uint32_t>(index.y);
      return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 16U);
    }
  };
  enum class Change : std::uint8_t { add, remove };

  template <Change change>
  void count_beams(const Scan& scan, const Pose2& map_from_sensor);
  [[nodiscard]] std::uint32_t tile_at(CellIndex index);
  [[nodiscard]] const Tile* find(CellIndex index) const;
  void drop_empty_tiles();

  EvidenceGridParams params_;
  std::vector<Tile> tiles_;
  std::unordered_map<CellIndex, std::uint32_t, TileHash> tile_of_;
  std::uint64_t lost_counts_{0};
};

template <class Visit>
void EvidenceGrid::for_each_row(const Visit& visit) const {
  for (const Tile& tile : tiles_) {
    for (std::int32_t row = 0; row < tile_side; ++row) {
      const CellIndex first{tile.index.x * tile_side, tile.index.y * tile_side + row};
      visit(first,
            std::span<const EvidenceCell>(tile.cells).subspan(static_cast<std::size_t>(row) * tile_side, tile_side));
    }
  }
}

}  // namespace flirt
