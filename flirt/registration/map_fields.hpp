// flirt/registration/map_fields.hpp: a map's evidence, prepared for finding scans in it.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/grid/evidence_grid.hpp"
#include "flirt/registration/coarse_field.hpp"
#include "flirt/registration/raster.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

struct MapFieldParams {
  double reach{0.4};               ///< m, farther from anything occupied an end point agrees with nothing
  double line_radius{0.15};        ///< m, neighbourhood of occupied cells that makes a piece of line
  double likelihood_sigma{0.2};    ///< m, of the coarse likelihood: grid and angle steps blur the end points this much
  std::uint32_t coarse_factor{4};  ///< cells per side of a coarse cell
  std::uint32_t free_penalty{3};   ///< coarse value of unknown space, of `coarse_peak`; free space is worth 0
  std::uint32_t coarse_peak{12};   ///< what an occupied coarse cell is worth more than unknown space
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, MapFieldParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.reach, Field{"reach", "m", "farther from anything occupied an end point agrees with nothing", 0.1, 5.0});
  visit(params.line_radius, Field{"line_radius", "m", "neighbourhood that makes a piece of line", 0.05, 1.0});
  visit(params.likelihood_sigma, Field{"coarse_sigma", "m", "width of the coarse likelihood", 0.05, 2.0});
  visit(params.coarse_factor, Field{"coarse_factor", "", "cells per side of a coarse cell", 1, 16});
  visit(params.free_penalty, Field{"free_penalty", "", "coarse value of unknown space; free space is worth 0", 0, 10});
  visit(params.coarse_peak, Field{"coarse_peak", "", "coarse value of occupied above unknown space", 1, 50});
}

/// A piece of wall around an occupied cell, from the hits in the occupied cells around it.
struct LinePiece {
  float x{0};         ///< m from the fields' origin, centre of the hits
  float y{0};         ///< m
  float normal_x{1};  ///< unit vector along the smaller spread
  float normal_y{0};
  float roundness{1};  ///< smaller over larger variance of the hits: 0 on a line, 1 in a heap
};

/// What a fine cell is: bits of `MapFields::agreement`.
struct Agreement {
  static constexpr std::uint8_t distance_mask = 63;  ///< squared distance to the nearest occupied cell, cells², ≤ 63
  static constexpr std::uint8_t free = 64;           ///< seen, not occupied
  static constexpr std::uint8_t unknown = 128;       ///< never seen
};

/// All that finding a scan in a map needs of the map; made once, then only read, by any number of threads.
struct MapFields {
  static constexpr std::uint8_t solid = 255;  ///< `clearance` of a solid cell

  Point2 origin;                   ///< m, lower corner of the box in the map frame
  double cell_size{0.05};          ///< m
  Raster<std::uint8_t> agreement;  ///< see Agreement
  Raster<std::uint8_t> clearance;  ///< cells that a ray may go without meeting anything solid
  Raster<std::uint32_t> line;      ///< index into `lines` of the piece at the nearest occupied cell + 1; 0: none
  std::vector<LinePiece> lines;
  CoarseField coarse;

  [[nodiscard]] bool empty() const { return agreement.cells.empty(); }
  /// Bytes of all layers.
  [[nodiscard]] std::size_t bytes() const;
};

/// O(cells of the map's box · reach).
[[nodiscard]] MapFields map_fields(const EvidenceGrid& grid, const MapFieldParams& params = {});

}  // namespace flirt
