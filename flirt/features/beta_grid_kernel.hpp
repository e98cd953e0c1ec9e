// flirt/features/beta_grid_kernel.hpp: the inner loop of the β-grid, compiled for every vector width at hand and chosen
// at run time. Only for beta_grid.cpp.
#pragma once

#include <cstddef>
#include <span>

namespace flirt::beta_grid_kernel {

/// Arrays with one element per angular bin are padded to a multiple of this.
inline constexpr std::size_t lanes{8};
/// A shorter way through a bin is rounding, of a beam that starts or turns on its edge, m.
inline constexpr double least_length{1e-9};

/// One beam as the keypoint sees it: it runs at the distance |across|, with the keypoint on its right when positive.
/// Positions along it are measured from the point nearest to the keypoint.
struct Course {
  double direction_x{0};  ///< unit length
  double direction_y{0};
  double across{0};               ///< m, not 0
  double from{0};                 ///< m; where its known part within the outer arc begins
  double to{0};                   ///< m; and where it ends
  bool ends_on_something{false};  ///< at `to`
};

/// The sides of the angular bins (less than half a turn wide) as unit vectors; zeros in the padding.
struct Wedges {
  const double* lower_x;  ///< clockwise sides
  const double* lower_y;
  const double* upper_x;  ///< counter-clockwise sides
  const double* upper_y;
  std::size_t stride;  ///< number of them, padded
};

struct Rings {
  std::span<const double> low_squared;   ///< m², inner arc of each radial bin
  std::span<const double> high_squared;  ///< m², outer arc
};

/// Whole numbers as doubles, rings × stride.
struct Counts {
  double* hits;
  double* misses;
};

/// Adds to each bin the courses that end in it (hits) and the others that pass it over more than `least_length`
/// (misses).
void count_courses(std::span<const Course> courses, const Wedges& wedges, const Rings& rings, const Counts& counts);

}  // namespace flirt::beta_grid_kernel
