// flirt/match/distance.cpp: the sums over descriptor rows, compiled once per instruction set.
#include "flirt/match/distance.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <cmath>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/match/distance.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
#include "flirt/match/lanes-inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

constexpr float log2_e = 1.44269504F;
constexpr float tiny_sum = 1.17549435e-38F;  ///< turns 0/0 into 0, see chi_square

float variance_chi_square(const DescriptorRows& query, std::size_t i, const DescriptorRows& reference, std::size_t j) {
  const Floats d;
  const float* p_row = query.rows + i * query.stride;
  const float* q_row = reference.rows + j * query.stride;
  const float* p_variance = query.variances == nullptr ? nullptr : query.variances + i * query.stride;
  const float* q_variance = reference.variances == nullptr ? nullptr : reference.variances + j * query.stride;
  const auto load = [d](const float* row, std::size_t k)
                        HWY_ATTR { return row == nullptr ? hn::Zero(d) : hn::LoadU(d, row + k); };
  return 0.5F * sum_over_row(query.stride, [&](std::size_t k) HWY_ATTR {
           const auto p = hn::LoadU(d, p_row + k);
           const auto q = hn::LoadU(d, q_row + k);
           const auto deviation = hn::Sqrt(hn::Add(load(p_variance, k), load(q_variance, k)));
           const auto difference = hn::Sub(p, q);
           const auto weight = hn::Add(hn::Add(hn::Add(p, q), deviation), hn::Set(d, tiny_sum));
           return hn::Div(hn::Mul(difference, difference), weight);
         });
}

float squared_euclidean(const float* p_row, const float* q_row, std::size_t stride) {
  const Floats d;
  return sum_over_row(stride, [=](std::size_t k) HWY_ATTR {
    const auto difference = hn::Sub(hn::LoadU(d, p_row + k), hn::LoadU(d, q_row + k));
    return hn::Mul(difference, difference);
  });
}

/// Bhattacharyya coefficient Σ√(pq), from the rows of square roots.
float dot(const float* p_root, const float* q_root, std::size_t stride) {
  const Floats d;
  return sum_over_row(
      stride, [=](std::size_t k) HWY_ATTR { return hn::Mul(hn::LoadU(d, p_root + k), hn::LoadU(d, q_root + k)); });
}

float jensen_shannon(const float* p_row, const float* q_row, std::size_t stride) {
  const Floats d;
  const auto tiny = hn::Set(d, tiny_sum);
  const auto sum = sum_over_row(stride, [=](std::size_t k) HWY_ATTR {
    const auto p = hn::LoadU(d, p_row + k);
    const auto q = hn::LoadU(d, q_row + k);
    const auto half_sum = hn::Max(hn::Mul(hn::Set(d, 0.5F), hn::Add(p, q)), tiny);
    const auto of_p = hn::Mul(p, hn::Log(d, hn::Max(hn::Div(p, half_sum), tiny)));
    const auto of_q = hn::Mul(q, hn::Log(d, hn::Max(hn::Div(q, half_sum), tiny)));
    return hn::Add(of_p, of_q);
  });
  return std::max(0.0F, 0.5F * log2_e * sum);
}

/// Beyond the dimension both rows are uniform / bins, so that padding adds ln 1 = 0.
float kullback_leibler(const float* p_row, const float* q_row, std::size_t stride, std::uint32_t dimension) {
  const Floats d;
  const auto kept = hn::Set(d, 0.99F);
  const auto uniform = hn::Set(d, 0.01F / static_cast<float>(std::max(1U, dimension)));
  const auto sum = sum_over_row(stride, [=](std::size_t k) HWY_ATTR {
    const auto p = hn::Add(hn::Mul(kept, hn::LoadU(d, p_row + k)), uniform);
    const auto q = hn::Add(hn::Mul(kept, hn::LoadU(d, q_row + k)), uniform);
    return hn::Mul(p, hn::Log(d, hn::Div(p, q)));
  });
  return std::max(0.0F, sum);
}

/// One distance; `distance` is the same for a whole table, so its branch is foreseen.
HWY_INLINE float one_distance(Distance distance, const DescriptorRows& query, std::size_t i,
                              const DescriptorRows& reference, std::size_t j) {
  const std::size_t stride = query.stride;
  const float* p = query.rows + i * stride;
  const float* q = reference.rows + j * stride;
  const auto coefficient = [&] {
    return std::clamp(dot(query.roots + i * stride, reference.roots + j * stride, stride), 0.0F, 1.0F);
  };
  switch (distance) {
    case Distance::chi_square:
      return chi_square(p, q, stride);
    case Distance::variance_chi_square:
      return variance_chi_square(query, i, reference, j);
    case Distance::euclidean:
      return std::sqrt(squared_euclidean(p, q, stride));
    case Distance::hellinger:
      return std::sqrt(1.0F - coefficient());
    case Distance::bhattacharyya:
      return std::abs(std::log(coefficient()));
    case Distance::jensen_shannon:
      return jensen_shannon(p, q, stride);
    case Distance::kullback_leibler:
      return kullback_leibler(p, q, stride, query.dimension);
  }
  return 0.0F;
}

void distances_of_row(Distance distance, const DescriptorRows& query, std::size_t i, const DescriptorRows& reference,
                      std::size_t first, std::size_t last, float* out) {
  for (std::size_t j = first; j < last; ++j) { out[j - first] = one_distance(distance, query, i, reference, j); }
}

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt {
namespace {

HWY_EXPORT(distances_of_row);

void distances(Distance distance, const DescriptorRows& query, std::size_t i, const DescriptorRows& reference,
               std::size_t first, std::size_t last, float* out) {
  FLIRT_ASSERT(i < query.count && last <= reference.count);
  FLIRT_ASSERT(query.stride == reference.stride && query.dimension == reference.dimension);
  FLIRT_ASSERT(query.stride % 16 == 0);
  HWY_DYNAMIC_DISPATCH(distances_of_row)(distance, query, i, reference, first, last, out);
}

}  // namespace

DescriptorRows rows_of(const Descriptors& descriptors) {
  FLIRT_ASSERT(descriptors.roots.size() == descriptors.rows.size());
  FLIRT_ASSERT(descriptors.variances.empty() || descriptors.variances.size() == descriptors.rows.size());
  return {descriptors.rows.data(),
          descriptors.roots.data(),
          descriptors.variances.empty() ? nullptr : descriptors.variances.data(),
          static_cast<std::uint32_t>(descriptors.size()),
          descriptors.dimension,
          descriptors.stride,
          nullptr};
}

void descriptor_distances(Distance distance, const DescriptorRows& query, std::size_t i,
                          const DescriptorRows& reference, std::span<float> out) {
  FLIRT_ASSERT(out.size() == reference.count);
  distances(distance, query, i, reference, 0, out.size(), out.data());
}

float descriptor_distance(Distance distance, const DescriptorRows& query, std::size_t i,
                          const DescriptorRows& reference, std::size_t j) {
  float out = 0.0F;
  distances(distance, query, i, reference, j, j + 1, &out);
  return out;
}

}  // namespace flirt
#endif
