// flirt/registration/window_kernels.hpp: the inner loops of the window search, in vector registers.
#pragma once

#include "flirt/registration/local_map.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace flirt::window {

using RowSums = std::array<std::uint16_t, LocalMap::row_length>;
using TileSums = std::array<std::uint16_t, LocalMap::row_length / 2>;

/// Where the rows of the cells, moved by (x, y), begin in the values of a local map. `offsets` has their number.
void row_offsets(std::span<const CellIndex> cells, std::int32_t x, std::int32_t y, std::span<std::int32_t> offsets);

/// sums[k] = Σᵢ bytes[offsets[i] + k], of bytes up to LocalMap::largest. Up to 4369 offsets.
[[nodiscard]] RowSums sum_rows(const std::uint8_t* bytes, std::span<const std::int32_t> offsets);
[[nodiscard]] TileSums sum_tiles(const std::uint8_t* bytes, std::span<const std::int32_t> offsets);

}  // namespace flirt::window
