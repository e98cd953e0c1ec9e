// flirt/registration/dense_kernels.hpp: the two inner loops of the dense search, in vector registers.
#pragma once

#include "flirt/grid/beam_traversal.hpp"
#include "flirt/registration/coarse_field.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt::dense {

/// End points turned to one heading, as steps in coarse cells, split for the peaks.
class Steps {
 public:
  explicit Steps(std::size_t points);
  void set(std::size_t i, std::int32_t dx, std::int32_t dy);

  std::size_t count;
  std::vector<std::int32_t> x;         ///< cells; these and the next are filled up with 0 to whole vectors
  std::vector<std::int32_t> y;         ///< cells
  std::vector<std::int32_t> tile_x;    ///< ⌊x / 4⌋
  std::vector<std::int32_t> peak_row;  ///< 16 · ⌊y / 4⌋ + 4 · (y mod 4) + x mod 4, as CoarseField::peaks lie
};

/// Upper bounds of the sums in the pairs of a panel, in sixteenths rounded up: no sum in a pair exceeds 16 times its
/// bound unless that is 255, which bounds nothing; 0 where nobody can stand.
using PanelBounds = std::array<std::uint8_t, CoarseField::panel_pairs>;
void bound_panel(const CoarseField& field, const CoarseField::Panel& panel, const Steps& steps, std::uint8_t* bounds);

/// For both tiles of a pair the largest of 16 · sum + 4 · row + column over the cells in which one can stand, else 0;
/// 0, too, once it is sure that no sum reaches `least`.
using PairKeys = std::array<std::uint16_t, 2>;
PairKeys search_pair(const CoarseField& field, CellIndex corner, const std::uint8_t* standable, const Steps& steps,
                     int least);

}  // namespace flirt::dense
