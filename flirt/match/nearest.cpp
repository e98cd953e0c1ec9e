// flirt/match/nearest.cpp: products of 16 or 32 queries at once with 4 references, then exact distances of the rest.
#define HWY_WANT_AVX3_DL  // instructions for sums of products of small integers, left out by default
#include "flirt/match/nearest.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/match/nearest.cpp"
#include <hwy/foreach_target.h>
#include <hwy/cache_control.h>
#include <hwy/highway.h>
#include "flirt/match/products-inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

constexpr std::uint32_t rows_at_once = 4;
constexpr std::size_t blocks_at_once = parts == 1 ? 2 : 1;  // as registers allow

/// Of 16 queries a block the largest product so far and its row: a first guess at the nearest.
template <class Bound, std::size_t Vectors>
struct LargestProducts {
  using Tag = hn::Rebind<typename Bound::Product, Floats>;
  using Indices = hn::RebindToUnsigned<Floats>;
  hn::Vec<Tag> product[Vectors];
  hn::Vec<Indices> row[Vectors];
};

/// products[(block · rows + r) · 16 + lane] for `Rows` rows from row `first`.
template <std::size_t Rows, class Bound, std::size_t Vectors>
HWY_INLINE void add_products(const typename Bound::Element* columns, const DescriptorRows& reference,
                             std::uint32_t first, typename Bound::Product* products,
                             LargestProducts<Bound, Vectors>& largest) {
  const typename LargestProducts<Bound, Vectors>::Tag d;
  const typename LargestProducts<Bound, Vectors>::Indices indices;
  const std::size_t stride = Bound::stride(reference);
  // A few of these rows will be compared exactly, and which is known late: they are fetched while there is other work.
  const float* const rows = reference.rows + std::size_t{first} * reference.stride;
  for (std::size_t i = 0; i < Rows * reference.stride; i += 16) { hwy::Prefetch(rows + i); }
  hn::Vec<decltype(d)> sum[Rows][Vectors];
  Bound::multiply(columns, Bound::rows(reference) + first * stride, stride, sum);
  for (std::uint32_t r = 0; r < Rows; ++r) {
    for (std::size_t v = 0; v < Vectors; ++v) {
      hn::StoreU(sum[r][v], d, products + (v / parts * reference.count + first + r) * 16 + v % parts * lanes);
      const auto larger = hn::Gt(sum[r][v], largest.product[v]);
      largest.product[v] = hn::Max(sum[r][v], largest.product[v]);
      largest.row[v] = hn::IfThenElse(hn::RebindMask(indices, larger), hn::Set(indices, first + r), largest.row[v]);
    }
  }
}

/// All products of so many blocks; guess[lane] is the row of the largest.
template <class Bound, std::size_t Blocks>
HWY_INLINE void all_products(const typename Bound::Element* columns, const DescriptorRows& reference,
                             typename Bound::Product* products, std::uint32_t (&guess)[16 * Blocks]) {
  constexpr std::size_t vectors = Blocks * parts;
  const typename LargestProducts<Bound, vectors>::Tag d;
  const typename LargestProducts<Bound, vectors>::Indices indices;
  LargestProducts<Bound, vectors> largest;
  for (std::size_t v = 0; v < vectors; ++v) {
    largest.product[v] = hn::Set(d, typename Bound::Product{-1});
    largest.row[v] = hn::Zero(indices);
  }
  if (reference.count < rows_at_once) {
    for (std::uint32_t j = 0; j < reference.count; ++j) { add_products<1>(columns, reference, j, products, largest); }
  } else {
    for (std::uint32_t j = 0; j < reference.count; j += rows_at_once) {  // the last few rows perhaps twice
      add_products<rows_at_once>(columns, reference, std::min(j, reference.count - rows_at_once), products, largest);
    }
  }
  for (std::size_t v = 0; v < vectors; ++v) { hn::StoreU(largest.row[v], indices, guess + v * lanes); }
}

/// Smaller for what is nearer, of equally near rows for the first. Distances are not negative, so that their bits
/// are in their order.
HWY_INLINE std::uint64_t key_of(Nearest nearest) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(nearest.distance)} << 32U | nearest.reference;
}
HWY_INLINE Nearest nearest_of(std::uint64_t key) {
  return {static_cast<std::uint32_t>(key), std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32U))};
}

/// Nearest rows of up to 16 queries, `query` their first row, from the products of all rows and the row of the largest
/// of each. Branches that depend on the data are few: nobody can foresee them.
template <class Bound>
HWY_INLINE void nearest_of_block(const float* query, std::size_t queries, const DescriptorRows& reference, float limit,
                                 typename Bound::Product* products, const std::uint32_t* guess, Nearest* nearest) {
  using Product = typename Bound::Product;
  const std::size_t stride = reference.stride;
  const auto compared = [&](std::size_t lane, std::uint32_t j) HWY_ATTR {
    return key_of({j, chi_square(query + lane * stride, reference.rows + j * stride, stride)});
  };
  const Floats d;
  const hn::Rebind<Product, Floats> dp;
  alignas(64) float distance[16];
  std::uint64_t keys[16];
  std::ranges::fill(distance, 0.0F);  // the products of missing queries are 0, too few for that
  for (std::size_t lane = 0; lane < queries; ++lane) {
    keys[lane] = std::min(key_of({reference.count, limit}), compared(lane, guess[lane]));
    distance[lane] = nearest_of(keys[lane]).distance;
    products[std::size_t{guess[lane]} * 16 + lane] = std::numeric_limits<Product>::lowest();  // done
  }
  hn::Vec<decltype(dp)> least[parts];
  for (std::size_t part = 0; part < parts; ++part) {
    least[part] = Bound::least_products(hn::Load(d, distance + part * lanes));
  }
  for (std::uint32_t first = 0; first < reference.count; first += rows_at_once) {
    std::uint64_t bits = 0;
    const std::uint32_t rows = std::min<std::uint32_t>(rows_at_once, reference.count - first);
    for (std::uint32_t r = 0; r < rows; ++r) {
      const Product* row = products + (std::size_t{first} + r) * 16;
      const auto exceed = [&](std::size_t part) HWY_ATTR {
        return hn::RebindMask(d, hn::Gt(hn::LoadU(dp, row + part * lanes), least[part]));
      };
      bits |= std::uint64_t{bits_of_group(exceed)} << (16 * r);
    }
    for (; bits != 0; bits &= bits - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
      const std::size_t lane = bit % 16;
      keys[lane] = std::min(keys[lane], compared(lane, first + bit / 16));
    }
  }
  for (std::size_t lane = 0; lane < queries; ++lane) { nearest[lane] = nearest_of(keys[lane]); }
}

/// The same for so many blocks of 16, `columns` their roots or sketches side by side.
template <class Bound, std::size_t Blocks>
HWY_INLINE void nearest_of_blocks(const typename Bound::Element* columns, const float* query, std::size_t queries,
                                  const DescriptorRows& reference, float limit, typename Bound::Product* products,
                                  Nearest* nearest) {
  std::uint32_t guess[16 * Blocks];
  all_products<Bound, Blocks>(columns, reference, products, guess);
  for (std::size_t first = 0; first < queries; first += 16) {
    nearest_of_block<Bound>(query + first * reference.stride, std::min<std::size_t>(16, queries - first), reference,
                            limit, products + first * reference.count, guess + first, nearest + first);
  }
}

template <class Bound>
HWY_INLINE void nearest_of_all(const typename Bound::Element* columns, const DescriptorRows& query,
                               const DescriptorRows& reference, float limit, typename Bound::Product* products,
                               Nearest* nearest) {
  for (std::size_t first = 0; first < query.count;) {
    const std::size_t left = query.count - first;
    const auto* block = columns + first * Bound::stride(query);
    const float* rows = query.rows + first * query.stride;
    if (left <= 16) {
      nearest_of_blocks<Bound, 1>(block, rows, left, reference, limit, products, nearest + first);
      return;
    }
    const std::size_t queries = std::min(left, 16 * blocks_at_once);
    nearest_of_blocks<Bound, blocks_at_once>(block, rows, queries, reference, limit, products, nearest + first);
    first += queries;
  }
}

void nearest_by_roots(const float* columns, const DescriptorRows& query, const DescriptorRows& reference, float limit,
                      float* products, Nearest* nearest) {
  nearest_of_all<RootProducts>(columns, query, reference, limit, products, nearest);
}

void nearest_by_sketches(const std::int16_t* columns, const DescriptorRows& query, const DescriptorRows& reference,
                         float limit, std::int32_t* products, Nearest* nearest) {
  nearest_of_all<SketchProducts>(columns, query, reference, limit, products, nearest);
}

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt {
namespace {

HWY_EXPORT(nearest_by_roots);
HWY_EXPORT(nearest_by_sketches);

/// The bound holds for rows that sum to 1 only.
[[maybe_unused]] bool is_normalised(const DescriptorRows& table) {
  for (std::size_t i = 0; i < table.count; ++i) {
    const float* row = table.rows + i * table.stride;
    if (!(std::abs(std::accumulate(row, row + table.stride, 0.0) - 1.0) < 1e-5)) { return false; }
  }
  return true;
}

/// Rows of 16 queries side by side, `together` neighbouring elements of each; zeros for queries that are missing.
template <class Element>
void lay_side_by_side(const Element* rows, std::size_t count, std::size_t stride, std::size_t together,
                      AlignedVector<Element>& columns) {
  columns.assign((count + 15) / 16 * 16 * stride, Element{0});
  for (std::size_t i = 0; i < count; ++i) {
    Element* block = columns.data() + i / 16 * 16 * stride;
    for (std::size_t k = 0; k < stride; ++k) {
      block[(k / together * 16 + i % 16) * together + k % together] = rows[i * stride + k];
    }
  }
}

}  // namespace

void NearestRows::set_query(const DescriptorRows& query) {
  FLIRT_ASSERT(is_normalised(query));
  query_rows_.assign(query.rows, query.rows + std::size_t{query.count} * query.stride);
  query_ = query;
  query_.rows = query_rows_.data();
  lay_side_by_side(query.roots, query.count, query.stride, 1, root_columns_);
  if (query.sketches != nullptr) { lay_side_by_side(query.sketches, query.count, sketch_size, 2, sketch_columns_); }
  nearest_.resize(query.count);
}

std::span<const Nearest> NearestRows::search(const DescriptorRows& reference, float limit) {
  if (reference.count == 0) {
    std::fill(nearest_.begin(), nearest_.end(), Nearest{});
    return nearest_;
  }
  FLIRT_ASSERT(query_.count == 0 || query_.stride == reference.stride);
  FLIRT_ASSERT(is_normalised(reference));
  const std::size_t products = std::size_t{reference.count} * 32;  // of two blocks at most
  if (query_.sketches != nullptr && reference.sketches != nullptr) {
    sketch_products_.resize(std::max(sketch_products_.size(), products));
    HWY_DYNAMIC_DISPATCH(nearest_by_sketches)
    (sketch_columns_.data(), query_, reference, limit, sketch_products_.data(), nearest_.data());
  } else {
    root_products_.resize(std::max(root_products_.size(), products));
    HWY_DYNAMIC_DISPATCH(nearest_by_roots)
    (root_columns_.data(), query_, reference, limit, root_products_.data(), nearest_.data());
  }
  for (Nearest& nearest : nearest_) {
    if (!(nearest.distance < limit)) { nearest = {}; }
  }
  return nearest_;
}

}  // namespace flirt
#endif
