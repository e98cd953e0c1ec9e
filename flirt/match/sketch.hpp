// flirt/match/sketch.hpp: descriptors as a few small integers whose dot product tells when χ² must be large.
//
// For one bin let w = ln p − ln q. Then 2pq/(p+q) = √(pq) / cosh(w/2) ≤ √(pq) (1 − a + a cos w) for a = 0.244 and any
// w, so for rows that sum to 1
//   χ² = 1 − Σ 2pq/(p+q) ≥ 1 − φ(p)·φ(q),  φ(p) = √p (√(1−a), √a cos ln p, √a sin ln p) in each bin, |φ(p)| = 1.
// Of φ, three numbers a bin, a sketch keeps the coordinates along a few orthonormal axes, and as its last number the
// length of what is left, which makes the product of two sketches no smaller than φ(p)·φ(q) (Cauchy and Schwarz). The
// axes are those along which the descriptors of a map vary most; with any others the bound would hold as well.
// Σ√(pq) (nearest.hpp) is the same bound with a = 0: looser, but it needs no axes.
#pragma once

#include "flirt/match/distance.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

inline constexpr std::size_t sketch_size = 32;  ///< integers of a sketch

/// Numbers of a sketch are multiples of 1 / sketch_scale.
inline constexpr float sketch_scale = 32767.0F;

/// χ² ≥ 1 − product / sketch_scale² − this: rounding of the sketches (√32 / sketch_scale = 1.7e-4), and of floats.
inline constexpr float sketch_slack = 2.5e-4F;

/// Only sketches of the same axes can be compared.
struct SketchAxes {
  std::uint32_t dimension{0};  ///< bins of the descriptor
  std::uint32_t stride{0};     ///< floats from row to row of the descriptor
  std::vector<float> axes{};   ///< 3 · stride × sketch_size: in each row one element of φ along all axes; orthonormal
};

/// Axes for the descriptors of a map, from some of them. O(stride).
[[nodiscard]] SketchAxes fit_sketch_axes(const DescriptorRows& descriptors);

/// Sketches of all rows: count × sketch_size. O(count · stride).
[[nodiscard]] std::vector<std::int16_t> sketches_of(const SketchAxes& axes, const DescriptorRows& descriptors);
/// The same for rows [first, last), to `out`.
void sketch_rows(const SketchAxes& axes, const DescriptorRows& descriptors, std::size_t first, std::size_t last,
                 std::span<std::int16_t> out);

}  // namespace flirt
