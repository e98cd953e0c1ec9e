#include "flirt/features/describe.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace flirt {
namespace {

constexpr std::uint32_t floats_per_block = 16;

Descriptors empty_rows(std::uint32_t dimension, std::size_t count) {
  const std::uint32_t stride = (dimension + floats_per_block - 1) / floats_per_block * floats_per_block;
  Descriptors descriptors;
  descriptors.dimension = dimension;
  descriptors.stride = stride;
  descriptors.rows.resize(count * stride);
  descriptors.roots.resize(count * stride);
  return descriptors;
}

/// Normalises in double and rounds once; uniform when there is nothing to normalise.
void write_row(Descriptors& descriptors, std::size_t i, std::span<const double> values, double sum) {
  float* const row = descriptors.rows.data() + i * descriptors.stride;
  float* const roots = descriptors.roots.data() + i * descriptors.stride;
  const double factor = sum > 0 ? 1.0 / sum : 0.0;
  const double constant = sum > 0 ? 0.0 : 1.0 / static_cast<double>(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    row[k] = static_cast<float>(factor * values[k] + constant);
    roots[k] = std::sqrt(row[k]);
  }
}

template <class T, class U>
void append(std::vector<T>& all, const U& some) {
  all.insert(all.end(), some.begin(), some.end());
}

Descriptors rows_of(BetaGrid& grid, const BeamFan& fan, std::span<const Keypoint> keypoints, DescriptorTrace* trace) {
  Descriptors descriptors = empty_rows(grid.dimension(), keypoints.size());
  descriptors.variances.resize(descriptors.rows.size());
  std::vector<double> mean(grid.dimension());
  std::vector<double> variance(grid.dimension());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    grid.count(fan, keypoints[i]);
    double sum = 0;
    for (std::size_t k = 0; k < mean.size(); ++k) {
      const Occupancy bin = occupancy(grid.hits()[k], grid.misses()[k], grid.params());
      mean[k] = bin.mean;
      variance[k] = bin.variance;
      sum += bin.mean;
    }
    write_row(descriptors, i, mean, sum);
    float* const variances = descriptors.variances.data() + i * descriptors.stride;
    const double factor = sum > 0 ? 1.0 / (sum * sum) : 0.0;
    for (std::size_t k = 0; k < mean.size(); ++k) { variances[k] = static_cast<float>(factor * variance[k]); }
    if (trace == nullptr) { continue; }
    append(trace->hits, grid.hits());
    append(trace->misses, grid.misses());
    append(trace->mean, mean);
    append(trace->variance, variance);
  }
  return descriptors;
}

Descriptors rows_of(ShapeContext& shape, const BeamFan& fan, std::span<const Keypoint> keypoints,
                    DescriptorTrace* trace) {
  Descriptors descriptors = empty_rows(shape.dimension(), keypoints.size());
  std::vector<double> points(shape.dimension());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    shape.count(fan, keypoints[i]);
    double sum = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k] = shape.points()[k];
      sum += points[k];
    }
    write_row(descriptors, i, points, sum);
    if (trace != nullptr) { append(trace->hits, shape.points()); }
  }
  return descriptors;
}

std::variant<BetaGrid, ShapeContext> method_of(const DescriptorParams& params) {
  if (const auto* beta_grid = std::get_if<BetaGridParams>(&params)) { return BetaGrid(*beta_grid); }
  return ShapeContext(std::get<ShapeContextParams>(params));
}

NoReturnMeaning no_return_of(const BetaGrid& grid) {
  return grid.params().no_return;
}
NoReturnMeaning no_return_of(const ShapeContext& /*shape*/) {
  return NoReturnMeaning::ignored;
}

}  // namespace

std::string_view descriptor_name(const DescriptorParams& params) {
  return descriptor_names[params.index()];
}

std::optional<DescriptorParams> descriptor_from_name(std::string_view name) {
  if (name == descriptor_names[0]) { return BetaGridParams{}; }
  if (name == descriptor_names[1]) { return ShapeContextParams{}; }
  return std::nullopt;
}

Describer::Describer(const DescriptorParams& params) : method_(method_of(params)) {}

Descriptors Describer::describe(const Scan& scan, std::span<const Keypoint> keypoints, DescriptorTrace* trace) {
  return std::visit(
      [&](auto& method) {
        if (trace != nullptr) { *trace = {method.dimension(), {}, {}, {}, {}}; }
        fan_.assign(scan, no_return_of(method));
        return rows_of(method, fan_, keypoints, trace);
      },
      method_);
}

Descriptors describe(const Scan& scan, std::span<const Keypoint> keypoints, const DescriptorParams& params,
                     DescriptorTrace* trace) {
  return Describer(params).describe(scan, keypoints, trace);
}

}  // namespace flirt
