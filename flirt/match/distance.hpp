// flirt/match/distance.hpp: how different two descriptors are.
#pragma once

#include "flirt/features/features.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

namespace flirt {

/// Distances between descriptor rows p and q, each normalised to sum 1; 0/0 counts as 0, all sums run over the bins.
enum class Distance : std::uint8_t {
  chi_square,           ///< ½ Σ (p−q)²/(p+q), in [0, 1]; symmetric; the papers' choice
  variance_chi_square,  ///< ½ Σ (p−q)²/(p+q+√(v_p+v_q)), v the bins' variances (0 where a descriptor has none): an
                        ///< uncertain bin says less; symmetric, never above chi_square
  euclidean,            ///< √Σ (p−q)², in [0, √2]
  hellinger,            ///< √(1 − Σ√(pq)), in [0, 1]
  bhattacharyya,        ///< −ln Σ√(pq), in [0, ∞]
  jensen_shannon,       ///< ½ Σ p log₂(2p/(p+q)) + ½ Σ q log₂(2q/(p+q)), bits, in [0, 1]
  kullback_leibler,     ///< Σ p' ln(p'/q') with p' = 0.99 p + 0.01/bins (so for q'): a hundredth of uniform keeps it
                        ///< finite where q is 0; nats, from query p to reference q, not symmetric
};

constexpr auto enum_names(Distance /*tag*/) {
  using enum Distance;
  return std::array<std::pair<Distance, std::string_view>, 7>{{{chi_square, "chi-square"},
                                                               {variance_chi_square, "variance-chi-square"},
                                                               {euclidean, "euclidean"},
                                                               {hellinger, "hellinger"},
                                                               {bhattacharyya, "bhattacharyya"},
                                                               {jensen_shannon, "jensen-shannon"},
                                                               {kullback_leibler, "kullback-leibler"}}};
}

/// Read-only rows of `count` descriptors, wherever they lie: in a Descriptors, or in the middle of a map's columns.
/// All three tables are count × stride, stride a multiple of 16, zeros beyond `dimension`.
struct DescriptorRows {
  const float* rows{nullptr};       ///< normalised to sum 1
  const float* roots{nullptr};      ///< square roots of `rows`
  const float* variances{nullptr};  ///< of the entries of `rows`; null when the descriptor has none
  std::uint32_t count{0};
  std::uint32_t dimension{0};             ///< bins that carry data
  std::uint32_t stride{0};                ///< floats from row to row
  const std::int16_t* sketches{nullptr};  ///< count × sketch_size, see sketch.hpp; null where there are none
};

[[nodiscard]] DescriptorRows rows_of(const Descriptors& descriptors);

/// Distance of row i of `query` to every row of `reference`: out[j], j < reference.count. Equal strides and dimensions.
/// O(count · stride), vectorised; chi_square gives the same bits on every instruction set.
void descriptor_distances(Distance distance, const DescriptorRows& query, std::size_t i,
                          const DescriptorRows& reference, std::span<float> out);

/// Distance of row i of `query` to row j of `reference`.
[[nodiscard]] float descriptor_distance(Distance distance, const DescriptorRows& query, std::size_t i,
                                        const DescriptorRows& reference, std::size_t j);

}  // namespace flirt
