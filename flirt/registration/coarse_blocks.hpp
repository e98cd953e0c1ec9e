// flirt/registration/coarse_blocks.hpp: the coarse fields of a map, from its fine layers.
#pragma once

#include "flirt/grid/beam_traversal.hpp"
#include "flirt/registration/map_fields.hpp"

#include <memory>
#include <span>
#include <vector>

namespace flirt {

/// The coarse fields of `fields`, block after block in rows; a block that no tile lies in has none. Those of `before`
/// are shared or changed where they cover the same cells: `changed` holds all tiles in which `before`, of the same box,
/// differs. O(cells of the blocks made or changed + tiles of the box).
[[nodiscard]] std::vector<std::shared_ptr<const CoarseField>> coarse_fields(
    const MapFields& fields, std::span<const std::shared_ptr<const CoarseField>> before,
    std::span<const CellIndex> changed);

}  // namespace flirt
