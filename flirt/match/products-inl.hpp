// flirt/match/products-inl.hpp: dot products of descriptors with those of 16 queries at a time, which bound χ² from
// below. Included once per instruction set by nearest.cpp.
#if defined(FLIRT_MATCH_PRODUCTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef FLIRT_MATCH_PRODUCTS_INL
#undef FLIRT_MATCH_PRODUCTS_INL
#else
#define FLIRT_MATCH_PRODUCTS_INL
#endif

#include "flirt/match/distance.hpp"
#include "flirt/match/lanes-inl.hpp"
#include "flirt/match/sketch.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

using Integers = hn::RebindToSigned<Floats>;

/// Dot products of the roots: χ² ≥ 1 − product − slack.
struct RootProducts {
  using Element = float;
  using Product = float;

  /// Rows nearer than `distance` have larger products than these; covers the rounding of a dot product of normalised
  /// rows, and of their normalisation, with room to spare.
  static HWY_INLINE FloatVector least_products(FloatVector distance) {
    return hn::Sub(hn::Set(Floats{}, 1.0F - 1e-5F), distance);
  }
  static const Element* rows(const DescriptorRows& table) { return table.roots; }
  static std::size_t stride(const DescriptorRows& table) { return table.stride; }

  template <std::size_t Rows, std::size_t Vectors>
  static HWY_INLINE void multiply(const Element* columns, const Element* rows, std::size_t stride,
                                  FloatVector (&sum)[Rows][Vectors]) {
    const Floats d;
    for (auto& row : sum) {
      for (auto& part : row) { part = hn::Zero(d); }
    }
    for (std::size_t k = 0; k < stride; ++k) {
      FloatVector column[Vectors];
      for (std::size_t v = 0; v < Vectors; ++v) {
        column[v] = hn::LoadU(d, columns + (v / parts * stride + k) * 16 + v % parts * lanes);
      }
      for (std::size_t r = 0; r < Rows; ++r) {
        const auto root = hn::Set(d, rows[r * stride + k]);
        for (std::size_t v = 0; v < Vectors; ++v) { sum[r][v] = hn::MulAdd(column[v], root, sum[r][v]); }
      }
    }
  }
};

/// Dot products of the sketches, in integers.
struct SketchProducts {
  using Element = std::int16_t;
  using Product = std::int32_t;

  static HWY_INLINE hn::Vec<Integers> least_products(FloatVector distance) {
    const Floats d;
    const auto at_most = hn::Min(distance, hn::Set(d, 2.0F));  // χ² never exceeds 1, a limit may
    const auto least = hn::Sub(hn::Set(d, 1.0F - sketch_slack), at_most);
    return hn::ConvertTo(Integers{}, hn::Mul(least, hn::Set(d, sketch_scale * sketch_scale)));
  }
  static const Element* rows(const DescriptorRows& table) { return table.sketches; }
  static std::size_t stride(const DescriptorRows& /*table*/) { return sketch_size; }

  template <std::size_t Rows, std::size_t Vectors>
  static HWY_INLINE void multiply(const Element* columns, const Element* rows, std::size_t stride,
                                  hn::Vec<Integers> (&sum)[Rows][Vectors]) {
    const Integers d;
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t r = 0; r < Rows; ++r) {
      for (std::size_t v = 0; v < Vectors; ++v) {
        Product product = 0;
        for (std::size_t k = 0; k < stride; ++k) {
          product +=
              Product{columns[(v / parts * stride + k / 2 * 2) * 16 + v % parts * 2 + k % 2]} * rows[r * stride + k];
        }
        sum[r][v] = hn::Set(d, product);
      }
    }
#else
    const hn::Repartition<std::int16_t, Integers> pairs;
    hn::Vec<Integers> upper[Rows][Vectors];  // some instruction sets sum into two halves
    for (std::size_t r = 0; r < Rows; ++r) {
      for (std::size_t v = 0; v < Vectors; ++v) { sum[r][v] = upper[r][v] = hn::Zero(d); }
    }
    for (std::size_t k = 0; k < stride; k += 2) {
      hn::Vec<decltype(pairs)> column[Vectors];
      for (std::size_t v = 0; v < Vectors; ++v) {
        column[v] = hn::LoadU(pairs, columns + (v / parts * stride + k) * 16 + v % parts * 2 * lanes);
      }
      for (std::size_t r = 0; r < Rows; ++r) {
        std::int32_t two = 0;
        std::memcpy(&two, rows + r * stride + k, sizeof two);
        const auto both = hn::BitCast(pairs, hn::Set(d, two));
        for (std::size_t v = 0; v < Vectors; ++v) {
#if HWY_TARGET == HWY_AVX3_DL && HWY_COMPILER_GCC
          // Highway 1.0.3 takes two instructions for this, and names its target so that the intrinsic won't do.
          auto raw = sum[r][v].raw;
          asm("vpdpwssd %2, %1, %0" : "+v"(raw) : "v"(column[v].raw), "v"(both.raw));
          sum[r][v].raw = raw;
#else
          sum[r][v] = hn::ReorderWidenMulAccumulate(d, column[v], both, sum[r][v], upper[r][v]);
#endif
        }
      }
    }
    for (std::size_t r = 0; r < Rows; ++r) {
      for (std::size_t v = 0; v < Vectors; ++v) { sum[r][v] = hn::RearrangeToOddPlusEven(sum[r][v], upper[r][v]); }
    }
#endif
  }
};

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
