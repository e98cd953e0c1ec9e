// flirt/registration/map_tile.hpp: a square of a map's evidence, prepared for scoring and refining poses in it.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/grid/evidence_grid.hpp"
#include "flirt/registration/raster.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

struct MapFieldParams {
  double reach{0.4};         ///< m, farther from anything occupied an end point is of no wall; scores look 0.4 m far
  double line_radius{0.15};  ///< m, neighbourhood of occupied cells that makes a piece of line
  double likelihood_sigma{0.2};    ///< m, of the coarse likelihood: grid and angle steps blur the end points this much
  std::uint32_t coarse_factor{4};  ///< cells per side of a coarse cell
  std::uint32_t free_penalty{3};   ///< coarse value of unknown space, of `coarse_peak`; free space is worth 0
  std::uint32_t coarse_peak{12};   ///< what an occupied coarse cell is worth more than unknown space

  friend bool operator==(const MapFieldParams&, const MapFieldParams&) = default;
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, MapFieldParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.reach,
        Field{"reach", "m", "farther from anything occupied an end point agrees with nothing", 0.1, 0.75});
  visit(params.line_radius, Field{"line_radius", "m", "neighbourhood that makes a piece of line", 0.05, 1.0});
  visit(params.likelihood_sigma, Field{"coarse_sigma", "m", "width of the coarse likelihood", 0.05, 2.0});
  visit(params.coarse_factor, Field{"coarse_factor", "", "cells per side of a coarse cell", 1, 16});
  visit(params.free_penalty, Field{"free_penalty", "", "coarse value of unknown space; free space is worth 0", 0, 10});
  visit(params.coarse_peak, Field{"coarse_peak", "", "coarse value of occupied above unknown space", 1, 50});
}

/// A piece of wall around an occupied cell, from the hits in the occupied cells around it.
struct LinePiece {
  float x{0};         ///< m from the lower left corner of the tile, centre of the hits
  float y{0};         ///< m
  float normal_x{1};  ///< unit vector along the smaller spread
  float normal_y{0};
  float roundness{1};  ///< smaller over larger variance of the hits: 0 on a line, 1 in a heap

  friend bool operator==(const LinePiece&, const LinePiece&) = default;
};

/// What a fine cell is: bits of `MapTile::agreement`.
struct Agreement {
  static constexpr std::uint8_t distance_mask = 63;  ///< squared distance to the nearest occupied cell, cells², ≤ 63
  static constexpr std::uint8_t free = 64;           ///< seen, not occupied
  static constexpr std::uint8_t unknown = 128;       ///< never seen
};

/// A tile of the evidence grid and what its cells mean to scans, which also depends on the tiles around it. Where the
/// tile lies in the map makes no difference.
struct MapTile {
  static constexpr std::int32_t side = EvidenceGrid::tile_side;  ///< cells
  static constexpr std::size_t cell_count = row_offset(0, side, side);
  static constexpr std::uint8_t solid = 255;  ///< `clearance` of a solid cell
  static constexpr std::uint8_t clear = 54;   ///< `clearance` of cells far from anything solid

  /// Of what the layers were made: tiles with equal sources are equal. Hashes, so that no evidence need be kept.
  struct Sources {
    std::uint64_t agreement{0};
    std::uint64_t clearance{0};
    std::uint64_t line{0};

    friend bool operator==(const Sources&, const Sources&) = default;
  };

  std::array<std::uint8_t, cell_count> agreement{};  ///< see Agreement
  std::array<std::uint8_t, cell_count> clearance{};  ///< cells that a ray may go without meeting anything solid
  std::array<std::uint16_t, cell_count>
      line{};  ///< index into `lines` of the piece at the nearest occupied cell + 1; or 0
  std::vector<LinePiece> lines{};
  Sources sources{};

  /// Of a cell of the tile or of the map: only the place within the tile counts.
  [[nodiscard]] static std::size_t offset(std::int32_t x, std::int32_t y) {
    return static_cast<std::size_t>(((y & (side - 1)) * side) | (x & (side - 1)));
  }
  [[nodiscard]] std::size_t bytes() const { return sizeof(MapTile) + lines.size() * sizeof(LinePiece); }
};

/// What a tile's layers are made of: the evidence of the tile as marks, with a hash of each kind.
struct TileMarks {
  static constexpr std::uint8_t occupied = 1;
  static constexpr std::uint8_t strong = 2;
  static constexpr std::uint8_t seen = 4;

  std::array<std::uint8_t, MapTile::cell_count> marks{};
  std::array<std::uint16_t, MapTile::cell_count> hits{};  ///< of occupied cells, else 0
  std::uint64_t shape{0};                                 ///< hash of occupied and seen
  std::uint64_t solid{0};                                 ///< hash of strong
  std::uint64_t weight{0};                                ///< hash of hits

  explicit TileMarks(std::span<const EvidenceCell> cells);
};

/// Tiles in a square around one, row by row from the lower left; null where nothing was seen.
struct TileSurroundings {
  std::int32_t reach{1};  ///< tiles to each side
  std::vector<const TileMarks*> marks;

  [[nodiscard]] const TileMarks* at(std::int32_t dx, std::int32_t dy) const {
    return marks[row_offset(dx + reach, dy + reach, 2 * reach + 1)];
  }
};

/// How many tiles around one its layers depend on.
[[nodiscard]] std::int32_t tile_reach(const MapFieldParams& params, double cell_size);

[[nodiscard]] MapTile::Sources sources_of(const TileSurroundings& around);

/// Whether nothing was seen in the tile in the middle nor anything stands near: its layers would be blank.
[[nodiscard]] bool is_far_from_all(const TileSurroundings& around, const MapFieldParams& params, double cell_size);

/// The layers of the tile in the middle; layers whose sources are those of `before`, if any, are copied from it.
[[nodiscard]] MapTile map_tile(const TileSurroundings& around, const MapFieldParams& params, double cell_size,
                               const MapTile* before = nullptr);

/// Whether all cells are as they are far away from everything seen.
[[nodiscard]] bool is_blank(const MapTile& tile);

}  // namespace flirt
