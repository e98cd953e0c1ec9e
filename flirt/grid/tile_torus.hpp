// flirt/grid/tile_torus.hpp: cells of an unbounded grid, stored only where something is, with constant look-up.
#pragma once

#include "flirt/grid/beam_traversal.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

/// Cells in tiles of 16 × 16 that exist where somebody holds them. Tiles are found in a table that repeats after
/// 16 · `period` cells in both directions: what lies that far apart would share its cells, so a map in use has to be
/// smaller. Freed tiles are used again; they must have been left as they were found (all cells as `Cell{}`).
template <class Cell, std::int32_t period>
class TileTorus {
 public:
  static constexpr std::int32_t tile_side = 16;  ///< cells

  TileTorus() : tile_of_(static_cast<std::size_t>(period * period), 0), tiles_(1) {}

  /// The cell; of a tile that does not exist a cell that nothing was ever written to.
  [[nodiscard]] const Cell& operator[](CellIndex index) const {
    return tiles_[tile_of_[slot(index)]].cells[offset(index)];
  }
  /// The cell of a tile that exists.
  [[nodiscard]] Cell& at(CellIndex index) { return tiles_[tile_of_[slot(index)]].cells[offset(index)]; }
  [[nodiscard]] bool exists(CellIndex index) const { return tile_of_[slot(index)] != 0; }

  /// One more user of the cell's tile, which is made when it is the first.
  void hold(CellIndex index) {
    std::uint32_t& tile = tile_of_[slot(index)];
    if (tile == 0) { tile = take(); }
    ++tiles_[tile].users;
  }
  /// One user fewer; the last one's tile is freed.
  void release(CellIndex index) {
    std::uint32_t& tile = tile_of_[slot(index)];
    if (--tiles_[tile].users != 0) { return; }
    free_.push_back(tile);
    tile = 0;
  }

  [[nodiscard]] std::size_t tiles_in_use() const { return tiles_.size() - 1 - free_.size(); }
  [[nodiscard]] std::size_t bytes() const {
    return tiles_.size() * sizeof(Tile) + tile_of_.size() * sizeof(std::uint32_t);
  }

 private:
  struct Tile {
    std::array<Cell, static_cast<std::size_t>(tile_side* tile_side)> cells{};
    std::uint32_t users{0};
  };

  static std::size_t slot(CellIndex index) {
    const auto x = static_cast<std::uint32_t>(index.x >> 4) & static_cast<std::uint32_t>(period - 1);
    const auto y = static_cast<std::uint32_t>(index.y >> 4) & static_cast<std::uint32_t>(period - 1);
    return y * static_cast<std::size_t>(period) + x;
  }
  static std::size_t offset(CellIndex index) {
    return static_cast<std::size_t>(((index.y & 15) << 4) | (index.x & 15));
  }
  std::uint32_t take() {
    if (free_.empty()) {
      tiles_.emplace_back();
      return static_cast<std::uint32_t>(tiles_.size() - 1);
    }
    const std::uint32_t tile = free_.back();
    free_.pop_back();
    return tile;
  }

  std::vector<std::uint32_t> tile_of_;  // 0: none
  std::vector<Tile> tiles_;             // tile 0 stays as it is
  std::vector<std::uint32_t> free_{};
  static_assert((period & (period - 1)) == 0, "a power of two");
};

}  // namespace flirt
