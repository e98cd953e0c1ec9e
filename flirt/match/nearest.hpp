// flirt/match/nearest.hpp: exact nearest neighbours of descriptors under symmetric χ², pruned by a dot product.
//
// For rows that sum to 1 the bound is, bin by bin, (p−q)² = (√p−√q)² (√p+√q)² ≥ (√p−√q)² (p+q), hence
//   χ² = ½ Σ (p−q)²/(p+q) ≥ ½ Σ (√p−√q)² = 1 − Σ√(pq):
// a row whose roots have a small dot product with the query's can't be nearest, and needs no division.
#pragma once

#include "flirt/core/aligned_vector.hpp"
#include "flirt/match/distance.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace flirt {

struct Nearest {
  std::uint32_t reference{0};
  float distance{std::numeric_limits<float>::infinity()};  ///< infinite: nothing within the limit

  friend bool operator==(const Nearest&, const Nearest&) = default;
};

/// The nearest reference row of each query row. Keeps one query for many references; allocates nothing after the
/// largest pair of scans has been seen.
class NearestRows {
 public:
  /// The rows must outlive the searches.
  void set_query(const DescriptorRows& query);

  /// For each query row the reference row of smallest χ² below `limit`; of equal ones the first. The same as comparing
  /// all pairs, bit by bit. O(query · reference · stride) multiply-adds, and some divisions.
  [[nodiscard]] std::span<const Nearest> search(const DescriptorRows& reference, float limit);

 private:
  DescriptorRows query_{};
  AlignedVector<float> query_rows_{};
  AlignedVector<float> root_columns_{};           ///< the roots of 16 queries side by side, and so on
  AlignedVector<std::int16_t> sketch_columns_{};  ///< their sketches
  AlignedVector<float> root_products_{};          ///< reference × 16, of the block at work
  AlignedVector<std::int32_t> sketch_products_{};
  std::vector<Nearest> nearest_{};
};

}  // namespace flirt
