#include "flirt/match/sketch.hpp"

#include "flirt/core/assert.hpp"

#include <Eigen/Core>
#include <Eigen/QR>

#include <algorithm>
#include <array>
#include <cmath>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/match/sketch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
#include "flirt/match/lanes-inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

constexpr float share_of_cosine = 0.244F;  ///< a
constexpr float smallest = 1e-37F;         ///< whose logarithm stands for that of 0, where the root is 0 anyway

/// φ of one row: three times `stride` numbers.
void embed(const float* row, const float* root, std::size_t stride, float* out) {
  const Floats d;
  const auto constant_part = hn::Set(d, std::sqrt(1.0F - share_of_cosine));
  const auto turning_part = hn::Set(d, std::sqrt(share_of_cosine));
  for (std::size_t k = 0; k < stride; k += lanes) {
    const auto angle = hn::Log(d, hn::Max(hn::LoadU(d, row + k), hn::Set(d, smallest)));
    const auto length = hn::LoadU(d, root + k);
    const auto turning = hn::Mul(turning_part, length);
    hn::StoreU(hn::Mul(constant_part, length), d, out + k);
    hn::StoreU(hn::Mul(turning, hn::Cos(d, angle)), d, out + stride + k);
    hn::StoreU(hn::Mul(turning, hn::Sin(d, angle)), d, out + 2 * stride + k);
  }
}

/// Coordinates of φ along the axes, the last one 0.
void project(const float* embedded, std::size_t count, const float* axes, float* out) {
  const Floats d;
  constexpr std::size_t vectors = sketch_size / lanes;
  FloatVector sum[vectors];
  for (auto& part : sum) { part = hn::Zero(d); }
  for (std::size_t k = 0; k < count; ++k) {
    const auto value = hn::Set(d, embedded[k]);
    for (std::size_t part = 0; part < vectors; ++part) {
      sum[part] = hn::MulAdd(value, hn::LoadU(d, axes + k * sketch_size + part * lanes), sum[part]);
    }
  }
  for (std::size_t part = 0; part < vectors; ++part) { hn::StoreU(sum[part], d, out + part * lanes); }
}

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt {
namespace {

HWY_EXPORT(embed);
HWY_EXPORT(project);

constexpr std::size_t axis_count = sketch_size - 1;
constexpr std::size_t most_samples = 1024;
constexpr int rounds = 2;

/// φ of up to `most_samples` rows, spread evenly: one in each column.
Eigen::MatrixXf embedded_samples(const DescriptorRows& descriptors) {
  const std::size_t count = std::min<std::size_t>(descriptors.count, most_samples);
  Eigen::MatrixXf samples(3 * descriptors.stride, count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i * descriptors.count / count * descriptors.stride;
    HWY_DYNAMIC_DISPATCH(embed)
    (descriptors.rows + row, descriptors.roots + row, descriptors.stride,
     samples.col(static_cast<Eigen::Index>(i)).data());
  }
  return samples;
}

/// Orthonormal columns that span those of `columns`.
Eigen::MatrixXf orthonormal(const Eigen::MatrixXf& columns) {
  const Eigen::HouseholderQR<Eigen::MatrixXf> decomposition(columns);
  return decomposition.householderQ() * Eigen::MatrixXf::Identity(columns.rows(), columns.cols());
}

/// What the axes leave of φ, rounded up: rounding of floats may not make it smaller.
float length_of_rest(const float* coordinates) {
  float squared = 1.0F;
  for (std::size_t k = 0; k < axis_count; ++k) { squared -= coordinates[k] * coordinates[k]; }
  return std::sqrt(std::max(squared, 0.0F) + 2e-5F);
}

}  // namespace

SketchAxes fit_sketch_axes(const DescriptorRows& descriptors) {
  SketchAxes result{descriptors.dimension, descriptors.stride,
                    std::vector<float>(3 * std::size_t{descriptors.stride} * sketch_size, 0.0F)};
  if (descriptors.count == 0) { return result; }
  const Eigen::MatrixXf samples = embedded_samples(descriptors);
  const auto axes = static_cast<Eigen::Index>(std::min<std::size_t>(axis_count, std::size_t{3} * descriptors.stride));
  // The leading eigenvectors of the samples' second moments, roughly, by orthogonal iteration.
  Eigen::MatrixXf found(samples.rows(), axes);
  for (Eigen::Index i = 0; i < axes; ++i) { found.col(i) = samples.col(i * samples.cols() / axes); }
  found = orthonormal(found);
  for (int round = 0; round < rounds; ++round) {
    const Eigen::MatrixXf coordinates = samples.transpose() * found;
    found = orthonormal(samples * coordinates);
  }
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor>(result.axes.data(), found.rows(), sketch_size).leftCols(axes) = found;
  return result;
}

void sketch_rows(const SketchAxes& axes, const DescriptorRows& descriptors, std::size_t first, std::size_t last,
                 std::span<std::int16_t> out) {
  FLIRT_ASSERT(axes.stride == descriptors.stride && last <= descriptors.count);
  FLIRT_ASSERT(out.size() == (last - first) * sketch_size);
  std::vector<float> embedded(3 * std::size_t{axes.stride});
  std::array<float, sketch_size> coordinates{};
  for (std::size_t i = first; i < last; ++i) {
    const std::size_t row = i * descriptors.stride;
    HWY_DYNAMIC_DISPATCH(embed)(descriptors.rows + row, descriptors.roots + row, axes.stride, embedded.data());
    HWY_DYNAMIC_DISPATCH(project)(embedded.data(), embedded.size(), axes.axes.data(), coordinates.data());
    coordinates[axis_count] = length_of_rest(coordinates.data());
    for (std::size_t k = 0; k < sketch_size; ++k) {
      const float number = std::clamp(std::nearbyint(coordinates[k] * sketch_scale), -sketch_scale, sketch_scale);
      out[(i - first) * sketch_size + k] = static_cast<std::int16_t>(number);
    }
  }
}

std::vector<std::int16_t> sketches_of(const SketchAxes& axes, const DescriptorRows& descriptors) {
  std::vector<std::int16_t> sketches(std::size_t{descriptors.count} * sketch_size);
  sketch_rows(axes, descriptors, 0, descriptors.count, sketches);
  return sketches;
}

}  // namespace flirt
#endif
