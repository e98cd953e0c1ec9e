// flirt/match/nearest.cpp: dot products of 16 queries at a time with 4 references, then exact distances of the rest.
#include "flirt/match/nearest.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/match/nearest.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include "flirt/match/lanes-inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

/// Rounding of a dot product of normalised rows, and of their normalisation, with room to spare.
constexpr float bound_slack = 1e-5F;

/// dots[r · 16 + lane] for `Rows` reference rows from `roots`.
template <std::size_t Rows>
HWY_INLINE void dots_of_rows(const float* columns, const float* roots, std::size_t stride, std::size_t dimension,
                             float* dots) {
  const Floats d;
  FloatVector sum[Rows][parts];
  for (auto& row : sum) {
    for (auto& part : row) { part = hn::Zero(d); }
  }
  for (std::size_t k = 0; k < dimension; ++k) {
    FloatVector column[parts];
    for (std::size_t part = 0; part < parts; ++part) { column[part] = hn::LoadU(d, columns + k * 16 + part * lanes); }
    for (std::size_t r = 0; r < Rows; ++r) {
      const auto root = hn::Set(d, roots[r * stride + k]);
      for (std::size_t part = 0; part < parts; ++part) { sum[r][part] = hn::MulAdd(column[part], root, sum[r][part]); }
    }
  }
  for (std::size_t r = 0; r < Rows; ++r) {
    for (std::size_t part = 0; part < parts; ++part) { hn::StoreU(sum[r][part], d, dots + r * 16 + part * lanes); }
  }
}

/// Keeps the smaller distance, and of equal ones the smaller index.
HWY_INLINE void keep_nearer(Nearest& nearest, std::uint32_t reference, float distance) {
  if (distance < nearest.distance || (distance == nearest.distance && reference < nearest.reference)) {
    nearest = {reference, distance};
  }
}

/// The row of largest dot product of each of the 16 queries: a first guess at the nearest.
HWY_INLINE void rows_of_largest_dot(const float* dots, std::uint32_t count, std::uint32_t (&row)[16]) {
  const Floats d;
  const hn::RebindToUnsigned<Floats> du;
  for (std::size_t part = 0; part < parts; ++part) {
    auto largest = hn::Set(d, -1.0F);
    auto index = hn::Zero(du);
    for (std::uint32_t j = 0; j < count; ++j) {
      const auto dot = hn::LoadU(d, dots + std::size_t{j} * 16 + part * lanes);
      const auto larger = hn::Gt(dot, largest);
      largest = hn::IfThenElse(larger, dot, largest);
      index = hn::IfThenElse(hn::RebindMask(du, larger), hn::Set(du, j), index);
    }
    hn::StoreU(index, du, row + part * lanes);
  }
}

/// Bit `lane` is set where the dot product of that query with row j is at least `needed`.
HWY_INLINE std::uint32_t reaching(const float* dots, std::size_t j, const float (&needed)[16]) {
  const Floats d;
  std::uint32_t bits = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    const auto reaches = hn::Ge(hn::LoadU(d, dots + j * 16 + part * lanes), hn::LoadU(d, needed + part * lanes));
    std::uint8_t mask[8] = {};
    hn::StoreMaskBits(d, reaches, mask);
    bits |= (static_cast<std::uint32_t>(mask[0]) | (lanes > 8 ? static_cast<std::uint32_t>(mask[1]) << 8U : 0U))
            << (part * lanes);
  }
  return bits;
}

void all_dots(const float* columns, const DescriptorRows& reference, float* dots) {
  constexpr std::size_t rows_at_once = 4;
  std::size_t j = 0;
  for (; j + rows_at_once <= reference.count; j += rows_at_once) {
    dots_of_rows<rows_at_once>(columns, reference.roots + j * reference.stride, reference.stride, reference.dimension,
                               dots + j * 16);
  }
  for (; j < reference.count; ++j) {
    dots_of_rows<1>(columns, reference.roots + j * reference.stride, reference.stride, reference.dimension,
                    dots + j * 16);
  }
}

/// Nearest rows of up to 16 queries, `query` their first row, `columns` their roots side by side.
void nearest_of_block(const float* columns, const float* query, std::size_t queries, const DescriptorRows& reference,
                      float limit, float* dots, Nearest* nearest) {
  const std::size_t stride = reference.stride;
  all_dots(columns, reference, dots);
  std::uint32_t guess[16];
  rows_of_largest_dot(dots, reference.count, guess);
  float needed[16];
  std::ranges::fill(needed, 2.0F);
  for (std::size_t lane = 0; lane < queries; ++lane) {
    nearest[lane] = {reference.count, limit};
    const std::uint32_t j = guess[lane];
    if (1.0F - dots[std::size_t{j} * 16 + lane] - bound_slack > limit) { continue; }
    keep_nearer(nearest[lane], j, chi_square(query + lane * stride, reference.rows + j * stride, stride));
    needed[lane] = 1.0F - nearest[lane].distance - bound_slack;
  }
  for (std::uint32_t j = 0; j < reference.count; ++j) {
    for (std::uint32_t bits = reaching(dots, j, needed); bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
      if (guess[lane] == j) { continue; }
      keep_nearer(nearest[lane], j, chi_square(query + lane * stride, reference.rows + j * stride, stride));
      needed[lane] = 1.0F - nearest[lane].distance - bound_slack;
    }
  }
}

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt {
namespace {

HWY_EXPORT(nearest_of_block);

/// The bound holds for rows that sum to 1 only.
[[maybe_unused]] bool is_normalised(const DescriptorRows& table) {
  for (std::size_t i = 0; i < table.count; ++i) {
    const float* row = table.rows + i * table.stride;
    if (!(std::abs(std::accumulate(row, row + table.stride, 0.0) - 1.0) < 1e-5)) { return false; }
  }
  return true;
}

}  // namespace

void NearestRows::set_query(const DescriptorRows& query) {
  FLIRT_ASSERT(is_normalised(query));
  query_ = query;
  const std::size_t blocks = (query.count + 15) / 16;
  columns_.assign(blocks * query.stride * 16, 0.0F);
  for (std::size_t i = 0; i < query.count; ++i) {
    float* column = columns_.data() + (i / 16) * query.stride * 16 + i % 16;
    for (std::size_t k = 0; k < query.dimension; ++k) { column[k * 16] = query.roots[i * query.stride + k]; }
  }
  nearest_.resize(query.count);
}

std::span<const Nearest> NearestRows::search(const DescriptorRows& reference, float limit) {
  if (reference.count == 0) {
    std::fill(nearest_.begin(), nearest_.end(), Nearest{});
    return nearest_;
  }
  FLIRT_ASSERT(query_.count == 0 || query_.stride == reference.stride);
  FLIRT_ASSERT(is_normalised(reference));
  dots_.resize(std::max(dots_.size(), std::size_t{reference.count} * 16));
  for (std::size_t first = 0; first < query_.count; first += 16) {
    HWY_DYNAMIC_DISPATCH(nearest_of_block)
    (columns_.data() + first * query_.stride, query_.rows + first * query_.stride,
     std::min<std::size_t>(16, query_.count - first), reference, limit, dots_.data(), nearest_.data() + first);
  }
  for (Nearest& nearest : nearest_) {
    if (!(nearest.distance < limit)) { nearest = {}; }
  }
  return nearest_;
}

}  // namespace flirt
#endif
