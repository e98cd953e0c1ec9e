#include "flirt/features/curve_smoothing.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/features/curve_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace flirt {
namespace {

void resize_padded(AlignedDoubles& values, std::size_t n) {
  values.resize(n + curve_kernels::padding);
}

/// k_ij of two points at a geodesic `distance`.
double kernel_value(double distance, double t, double reach) {
  const double relative = distance / t;
  return relative <= reach ? std::exp(-0.5 * relative * relative) : 0.0;
}

}  // namespace

double gaussian_reach(double lost_mass) {
  if (!(lost_mass > 0.0)) { return std::numeric_limits<double>::infinity(); }
  double low = 0.0;
  double high = 40.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::numbers::sqrt2) > lost_mass ? low : high) = middle;
  }
  return high;
}

void CurveSmoother::lay_out(std::span<const double> arc, bool closed, double length, double reach) {
  const std::size_t n = arc.size();
  extended_ = n;
  if (closed) {  // ghosts: the points that the last rows meet again after going around
    while (extended_ < 2 * n - 1 && arc[extended_ - n] + length - arc[n - 1] <= reach) { ++extended_; }
  }
  resize_padded(arc_, extended_);
  std::ranges::copy(arc, arc_.begin());
  for (std::size_t j = n; j < extended_; ++j) { arc_[j] = arc[j - n] + length; }
  std::fill(arc_.begin() + static_cast<std::ptrdiff_t>(extended_), arc_.end(), arc_[extended_ - 1]);

  end_.resize(n);
  std::size_t end = 0;
  for (std::size_t i = 0; i < n; ++i) {
    end = std::max(end, i + 1);
    const auto pairs = [&](std::size_t j) {
      const double distance = arc_[j] - arc_[i];
      const double other_way = length - distance;
      // The shorter way around; when both are equally long, once.
      return distance <= reach && (!closed || distance < other_way || (distance == other_way && j < n));
    };
    while (end < extended_ && pairs(end)) { ++end; }
    end_[i] = static_cast<std::uint32_t>(end);
  }
}

/// Adds what the ghosts have collected to the points that they stand for.
void CurveSmoother::fold(AlignedDoubles& sums, std::size_t n) const {
  for (std::size_t j = n; j < extended_; ++j) { sums[j - n] += sums[j]; }
}

void CurveSmoother::smooth(std::span<const double> x, std::span<const double> y, std::span<const double> arc,
                           bool closed, double length, double t, double reach, SmoothedCurve& out) {
  const std::size_t n = x.size();
  out.x.resize(n);
  out.y.resize(n);
  if (n == 0) { return; }
  lay_out(arc, closed, length, reach * t);
  const curve_kernels::Rows rows{arc_.data(), end_.data(), n};
  const std::size_t size = curve_kernels::kernel_size(rows);
  if (kernel_.size() < size) { kernel_.resize(size); }

  sum_.assign(extended_ + curve_kernels::padding, 0.0);
  std::fill_n(sum_.begin(), n, 1.0);  // k_ii
  curve_kernels::gaussian_rows(rows, 0.5 * std::numbers::log2e / (t * t), kernel_.data(), sum_.data());
  fold(sum_, n);

  for (AlignedDoubles* column : {&weight_, &weighted_x_, &weighted_y_, &sum_x_, &sum_y_}) {
    column->assign(extended_ + curve_kernels::padding, 0.0);
  }
  for (std::size_t j = 0; j < extended_; ++j) {
    const std::size_t point = j < n ? j : j - n;
    weight_[j] = 1.0 / sum_[point];
    weighted_x_[j] = x[point] * weight_[j];
    weighted_y_[j] = y[point] * weight_[j];
  }
  std::fill(sum_.begin(), sum_.end(), 0.0);
  std::copy_n(weight_.begin(), n, sum_.begin());
  std::copy_n(weighted_x_.begin(), n, sum_x_.begin());
  std::copy_n(weighted_y_.begin(), n, sum_y_.begin());
  curve_kernels::weighted_rows(rows, kernel_.data(), {weight_.data(), weighted_x_.data(), weighted_y_.data()},
                               {sum_.data(), sum_x_.data(), sum_y_.data()});
  for (AlignedDoubles* sums : {&sum_, &sum_x_, &sum_y_}) { fold(*sums, n); }
  for (std::size_t i = 0; i < n; ++i) {
    out.x[i] = sum_x_[i] / sum_[i];
    out.y[i] = sum_y_[i] / sum_[i];
  }
}

void CurveSmoother::smooth(std::span<const double> x, std::span<const double> y, const GeodesicNeighbours& neighbours,
                           double t, double reach, SmoothedCurve& out) {
  const std::size_t n = x.size();
  FLIRT_ASSERT(neighbours.first.size() == n + 1);
  out.x.resize(n);
  out.y.resize(n);
  weight_.resize(n);
  kernel_.resize(neighbours.distance.size());
  for (std::size_t i = 0; i < n; ++i) {
    double density = 0.0;
    for (std::size_t k = neighbours.first[i]; k < neighbours.first[i + 1]; ++k) {
      kernel_[k] = kernel_value(neighbours.distance[k], t, reach);
      density += kernel_[k];
    }
    weight_[i] = 1.0 / density;
  }
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0.0;
    double sum_x = 0.0;
    double sum_y = 0.0;
    for (std::size_t k = neighbours.first[i]; k < neighbours.first[i + 1]; ++k) {
      const std::size_t j = neighbours.point[k];
      const double weight = kernel_[k] * weight_[j];
      sum += weight;
      sum_x += weight * x[j];
      sum_y += weight * y[j];
    }
    out.x[i] = sum_x / sum;
    out.y[i] = sum_y / sum;
  }
}

void damped_displacement(std::span<const double> x, std::span<const double> y, const SmoothedCurve& smoothed, double t,
                         std::vector<double>& response) {
  response.resize(x.size());
  curve_kernels::damped_displacement({x.data(), y.data(), smoothed.x.data(), smoothed.y.data()}, x.size(), 2.0 / t,
                                     response.data());
}

}  // namespace flirt
