#include "flirt/features/scale_space.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace flirt {
namespace {

/// Right half of e^−t I_x(t) up to where it is below rounding, by Miller's backward recurrence
/// I_{x−1} = I_{x+1} + (2x/t) I_x, normalised through e^−t (I_0 + 2 Σ I_x) = 1.
std::vector<double> bessel_half(double t) {
  const auto last = static_cast<std::size_t>(std::ceil(t + 12.0 * std::sqrt(t) + 30.0));
  std::vector<double> half(last + 1, 0.0);
  double above = 0.0;
  double current = 1e-300;
  for (std::size_t x = last; x > 0; --x) {
    half[x] = current;
    const double below = above + 2.0 * static_cast<double>(x) / t * current;
    above = current;
    current = below;
    if (current > 1e250) {  // rescale: only ratios matter
      above *= 1e-250;
      current *= 1e-250;
      for (std::size_t y = x; y <= last; ++y) { half[y] *= 1e-250; }
    }
  }
  half[0] = current;
  return half;
}

std::vector<double> gaussian_half(double t) {
  std::vector<double> half(static_cast<std::size_t>(std::ceil(9.0 * std::sqrt(t))) + 1);
  for (std::size_t x = 0; x < half.size(); ++x) {
    const auto distance = static_cast<double>(x);
    half[x] = std::exp(-0.5 * distance * distance / t);
  }
  return half;
}

void normalise(std::vector<double>& half) {
  double tail = 0.0;
  for (std::size_t x = half.size() - 1; x > 0; --x) { tail += half[x]; }  // small terms first
  const double sum = half[0] + 2.0 * tail;
  for (double& weight : half) { weight /= sum; }
}

/// Number of weights of `half` (sum 1) to keep so that at most `lost_mass` lies outside.
std::size_t width_by_mass(const std::vector<double>& half, double lost_mass) {
  double outside = 0.0;
  std::size_t size = half.size();
  while (size > 1 && outside + 2.0 * half[size - 1] <= lost_mass) {
    outside += 2.0 * half[size - 1];
    --size;
  }
  return size;
}

}  // namespace

std::string too_coarse(const ScaleParams& params) {
  const double coarsest = params.base * std::pow(params.step, params.count - 1);
  if (coarsest <= largest_scale) { return {}; }
  return "scale_base · scale_step^(scale_count − 1): expected up to " + std::to_string(largest_scale) + ", found " +
         std::to_string(coarsest);
}

std::vector<double> scale_bank(const ScaleParams& params) {
  FLIRT_ASSERT(too_coarse(params).empty());
  std::vector<double> scales;
  double t = params.base;
  for (int level = 0; level < params.count; ++level, t *= params.step) { scales.push_back(t); }
  return scales;
}

std::vector<double> smoothing_kernel(const SmoothingParams& params, double t) {
  if (!(t > 0.0)) { return {1.0}; }
  std::vector<double> half = params.kernel == SmoothingKernel::bessel ? bessel_half(t) : gaussian_half(t);
  normalise(half);
  const std::size_t size = params.truncation == Truncation::mass ? width_by_mass(half, params.lost_mass)
                                                                 : static_cast<std::size_t>(std::ceil(t)) + 1;
  half.resize(std::min(size, half.size()));
  normalise(half);
  return half;
}

void extend(std::span<const double> signal, std::size_t width, const Continuation& continuation,
            std::vector<double>& extended) {
  FLIRT_ASSERT(!signal.empty());
  const auto n = static_cast<std::ptrdiff_t>(signal.size());
  const auto at = [&](std::ptrdiff_t i) {
    if (continuation.closed) {
      const std::ptrdiff_t turns = i >= 0 ? i / n : -((n - 1 - i) / n);
      return signal[static_cast<std::size_t>(i - turns * n)] + static_cast<double>(turns) * continuation.turn_offset;
    }
    const bool about_sample = continuation.border == Border::mirror_sample;
    while (n > 1 && (i < 0 || i >= n)) {
      if (i < 0) { i = about_sample ? -i : -1 - i; }
      if (i >= n) { i = about_sample ? 2 * n - 2 - i : 2 * n - 1 - i; }
    }
    return signal[n > 1 ? static_cast<std::size_t>(i) : 0];
  };
  const auto more = static_cast<std::ptrdiff_t>(width);
  extended.resize(signal.size() + 2 * width);
  double* out = extended.data();
  for (std::ptrdiff_t i = -more; i < 0; ++i) { *out++ = at(i); }
  out = std::copy(signal.begin(), signal.end(), out);
  for (std::ptrdiff_t i = n; i < n + more; ++i) { *out++ = at(i); }
}

void convolve(std::span<const double> extended, std::span<const double> kernel, std::vector<double>& out) {
  const std::size_t width = kernel.size() - 1;
  FLIRT_ASSERT(extended.size() > 2 * width);
  const std::size_t n = extended.size() - 2 * width;
  out.resize(n);
  const double* const centre = extended.data() + width;
  for (std::size_t i = 0; i < n; ++i) { out[i] = kernel[0] * centre[i]; }
  for (std::size_t x = 1; x <= width; ++x) {
    const double weight = kernel[x];
    const double* const left = centre - x;
    const double* const right = centre + x;
    for (std::size_t i = 0; i < n; ++i) { out[i] += weight * (left[i] + right[i]); }
  }
}

void first_difference(std::span<const double> extended, double factor, std::vector<double>& out) {
  FLIRT_ASSERT(extended.size() >= 2);
  out.resize(extended.size() - 2);
  for (std::size_t i = 0; i < out.size(); ++i) { out[i] = 0.5 * factor * (extended[i + 2] - extended[i]); }
}

void second_difference(std::span<const double> extended, double factor, std::vector<double>& out) {
  FLIRT_ASSERT(extended.size() >= 2);
  out.resize(extended.size() - 2);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = factor * (extended[i] - 2.0 * extended[i + 1] + extended[i + 2]);
  }
}

}  // namespace flirt
