// flirt/slam/rbpf_map.hpp: the grid of one particle. Copies share their tiles until one of them changes a tile.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/grid/beam_traversal.hpp"
#include "flirt/grid/evidence_grid.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace flirt {

/// Evidence of a cell, and where in it beams ended.
struct RbpfCell {
  EvidenceCell evidence{};
  float x{0}, y{0};  ///< mean place of those ends, cells from the lower corner
};

/// Hits and passes of a particle's scans in tiles of 32 × 32 cells, 12 kB each, and those in blocks of 32 × 32 tiles. A
/// copy costs a pointer a block; the first change to a shared block or tile copies it. Different maps may be used from
/// different threads though they share tiles.
class RbpfMap {
 public:
  static constexpr std::int32_t tile_side = 32;  ///< cells

  explicit RbpfMap(double cell_size) : cell_size_(cell_size) {}

  /// One pass for each cell that a beam crosses, one hit where it ends. O(cells crossed).
  void add(Point2 sensor_in_robot, std::span<const Point2> ends_in_robot, const Pose2& map_from_robot);

  /// Squared distance, m², from a place to the mean end point of the nearest occupied cell of the 3 × 3 around it;
  /// `nothing_near` in seen space and `unseen` elsewhere when there is none.
  static constexpr double nothing_near = -1;
  static constexpr double unseen = -2;
  [[nodiscard]] double squared_distance(Point2 in_map) const;

  [[nodiscard]] RbpfCell cell(CellIndex index) const;
  [[nodiscard]] double cell_size() const { return cell_size_; }

  struct Tile {
    std::array<std::uint32_t, tile_side> occupied{};  ///< a bit a cell, row by row
    std::array<RbpfCell, static_cast<std::size_t>(tile_side* tile_side)> cells{};
  };
  /// The tiles that exist: for counting what several maps hold together.
  [[nodiscard]] std::vector<const Tile*> tiles() const;

 private:
  struct Block {
    std::array<std::shared_ptr<Tile>, static_cast<std::size_t>(tile_side* tile_side)> tiles{};
  };
  /// The blocks of a box, in blocks: a particle that loses its way goes far, and must not pay for all that lies
  /// between.
  struct Table {
    CellIndex low{};
    std::int32_t width{0};
    std::int32_t height{0};
    std::vector<std::shared_ptr<Block>> blocks{};
  };
  [[nodiscard]] const Tile* find(std::int32_t tile_x, std::int32_t tile_y) const;
  [[nodiscard]] bool is_occupied(std::int32_t x, std::int32_t y) const;
  void include(CellIndex low, CellIndex high);
  Tile& own_tile(std::int32_t tile_x, std::int32_t tile_y);
  [[nodiscard]] std::size_t slot(std::int32_t block_x, std::int32_t block_y) const {
    return static_cast<std::size_t>(block_y - table_.low.y) * static_cast<std::size_t>(table_.width) +
           static_cast<std::size_t>(block_x - table_.low.x);
  }

  double cell_size_;
  Table table_{};
};

}  // namespace flirt
