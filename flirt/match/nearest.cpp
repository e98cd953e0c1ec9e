// flirt/match/nearest.cpp: dot products of 16 queries at a time with 4 references, then exact distances of the rest.
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

/// Of each of 16 queries the largest product so far and its row: a first guess at the nearest.
template <class Bound>
struct LargestProducts {
  using Tag = hn::Rebind<typename Bound::Product, Floats>;
  using Indices = hn::RebindToUnsigned<Floats>;
  hn::Vec<Tag> product[parts];
  hn::Vec<Indices> row[parts];
};

/// products[r · 16 + lane] for `Rows` rows from row `first`.
template <std::size_t Rows, class Bound>
HWY_INLINE void add_products(const typename Bound::Element* columns, const DescriptorRows& reference,
                             std::uint32_t first, typename Bound::Product* products, LargestProducts<Bound>& largest) {
  const typename LargestProducts<Bound>::Tag d;
  const typename LargestProducts<Bound>::Indices indices;
  const std::size_t stride = Bound::stride(reference);
  // A few of these rows will be compared exactly, and which is known late: they are fetched while there is other work.
  const float* const rows = reference.rows + std::size_t{first} * reference.stride;
  for (std::size_t i = 0; i < Rows * reference.stride; i += 16) { hwy::Prefetch(rows + i); }
  hn::Vec<decltype(d)> sum[Rows][parts];
  Bound::multiply(columns, Bound::rows(reference) + first * stride, stride, sum);
  for (std::uint32_t r = 0; r < Rows; ++r) {
    for (std::size_t part = 0; part < parts; ++part) {
      hn::StoreU(sum[r][part], d, products + (first + r) * 16 + part * lanes);
      const auto larger = hn::Gt(sum[r][part], largest.product[part]);
      largest.product[part] = hn::IfThenElse(larger, sum[r][part], largest.product[part]);
      largest.row[part] =
          hn::IfThenElse(hn::RebindMask(indices, larger), hn::Set(indices, first + r), largest.row[part]);
    }
  }
}

/// All products; guess[lane] is the row of the largest.
template <class Bound>
HWY_INLINE void all_products(const typename Bound::Element* columns, const DescriptorRows& reference,
                             typename Bound::Product* products, std::uint32_t (&guess)[16]) {
  const typename LargestProducts<Bound>::Tag d;
  const typename LargestProducts<Bound>::Indices indices;
  LargestProducts<Bound> largest;
  for (std::size_t part = 0; part < parts; ++part) {
    largest.product[part] = hn::Set(d, typename Bound::Product{-1});
    largest.row[part] = hn::Zero(indices);
  }
  if (reference.count < rows_at_once) {
    for (std::uint32_t j = 0; j < reference.count; ++j) { add_products<1>(columns, reference, j, products, largest); }
  } else {
    for (std::uint32_t j = 0; j < reference.count; j += rows_at_once) {  // the last few rows perhaps twice
      add_products<rows_at_once>(columns, reference, std::min(j, reference.count - rows_at_once), products, largest);
    }
  }
  for (std::size_t part = 0; part < parts; ++part) { hn::StoreU(largest.row[part], indices, guess + part * lanes); }
}

/// Bits of the queries, lane by lane, whose product with the row of `products` exceeds `least`.
template <class Product>
HWY_INLINE std::uint16_t exceeding(const Product* products, const Product (&least)[16]) {
  const hn::Rebind<Product, Floats> d;
  return bits_of_group([&](std::size_t part) HWY_ATTR {
    return hn::RebindMask(Floats{}, hn::Gt(hn::LoadU(d, products + part * lanes), hn::LoadU(d, least + part * lanes)));
  });
}

/// Smaller for what is nearer, of equally near rows for the first. Distances are not negative, so that their bits
/// are in their order.
HWY_INLINE std::uint64_t key_of(Nearest nearest) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(nearest.distance)} << 32U | nearest.reference;
}
HWY_INLINE Nearest nearest_of(std::uint64_t key) {
  return {static_cast<std::uint32_t>(key), std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32U))};
}

/// Nearest rows of up to 16 queries, `query` their first row, `columns` their roots or sketches side by side. Branches
/// that depend on the data are few: nobody can foresee them.
template <class Bound>
HWY_INLINE void nearest_of_block(const typename Bound::Element* columns, const float* query, std::size_t queries,
                                 const DescriptorRows& reference, float limit, typename Bound::Product* products,
                                 Nearest* nearest) {
  using Product = typename Bound::Product;
  const std::size_t stride = reference.stride;
  std::uint32_t guess[16];
  all_products<Bound>(columns, reference, products, guess);
  const auto compared = [&](std::size_t lane, std::uint32_t j) HWY_ATTR {
    return key_of({j, chi_square(query + lane * stride, reference.rows + j * stride, stride)});
  };
  Product least[16];
  std::uint64_t keys[16];
  std::ranges::fill(least, std::numeric_limits<Product>::max());
  for (std::size_t lane = 0; lane < queries; ++lane) {
    keys[lane] = std::min(key_of({reference.count, limit}), compared(lane, guess[lane]));
    least[lane] = Bound::least_product(nearest_of(keys[lane]).distance);
    products[std::size_t{guess[lane]} * 16 + lane] = std::numeric_limits<Product>::lowest();  // done
  }
  for (std::uint32_t first = 0; first < reference.count; first += rows_at_once) {
    std::uint64_t bits = 0;
    const std::uint32_t rows = std::min<std::uint32_t>(rows_at_once, reference.count - first);
    for (std::uint32_t r = 0; r < rows; ++r) {
      bits |= std::uint64_t{exceeding(products + (std::size_t{first} + r) * 16, least)} << (16 * r);
    }
    for (; bits != 0; bits &= bits - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
      const std::size_t lane = bit % 16;
      keys[lane] = std::min(keys[lane], compared(lane, first + bit / 16));
    }
  }
  for (std::size_t lane = 0; lane < queries; ++lane) { nearest[lane] = nearest_of(keys[lane]); }
}

void nearest_by_roots(const float* columns, const float* query, std::size_t queries, const DescriptorRows& reference,
                      float limit, float* products, Nearest* nearest) {
  nearest_of_block<RootProducts>(columns, query, queries, reference, limit, products, nearest);
}

void nearest_by_sketches(const std::int16_t* columns, const float* query, std::size_t queries,
                         const DescriptorRows& reference, float limit, std::int32_t* products, Nearest* nearest) {
  nearest_of_block<SketchProducts>(columns, query, queries, reference, limit, products, nearest);
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
                      std::vector<Element>& columns) {
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
  query_ = query;
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
  const std::size_t products = std::size_t{reference.count} * 16;
  const bool by_sketches = query_.sketches != nullptr && reference.sketches != nullptr;
  if (by_sketches) {
    sketch_products_.resize(std::max(sketch_products_.size(), products));
  } else {
    root_products_.resize(std::max(root_products_.size(), products));
  }
  for (std::size_t first = 0; first < query_.count; first += 16) {
    const std::size_t queries = std::min<std::size_t>(16, query_.count - first);
    const float* rows = query_.rows + first * query_.stride;
    if (by_sketches) {
      HWY_DYNAMIC_DISPATCH(nearest_by_sketches)
      (sketch_columns_.data() + first * sketch_size, rows, queries, reference, limit, sketch_products_.data(),
       nearest_.data() + first);
    } else {
      HWY_DYNAMIC_DISPATCH(nearest_by_roots)
      (root_columns_.data() + first * query_.stride, rows, queries, reference, limit, root_products_.data(),
       nearest_.data() + first);
    }
  }
  for (Nearest& nearest : nearest_) {
    if (!(nearest.distance < limit)) { nearest = {}; }
  }
  return nearest_;
}

}  // namespace flirt
#endif
