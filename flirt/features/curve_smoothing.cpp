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

void CurveSmoother::set_curve(std::span<const double> x, std::span<const double> y, std::span<const double> arc,
                              bool closed, double length) {
  points_ = x.size();
  closed_ = closed;
  length_ = length;
  resize_padded(x_, points_);
  resize_padded(y_, points_);
  std::ranges::copy(x, x_.begin());
  std::ranges::copy(y, y_.begin());
  arc_.assign(arc.begin(), arc.end());
}

/// Positions along the curve in units of `unit` (m), ghosts and padding behind. Ghosts are the points met again after
/// one turn; the last rows need those within `reach` (m).
void CurveSmoother::lay_out(double unit, double reach) {
  extended_ = points_;
  if (closed_) {
    while (extended_ + 1 < 2 * points_ && arc_[extended_ - points_] + length_ - arc_[points_ - 1] <= reach) {
      ++extended_;
    }
  }
  resize_padded(position_, extended_);
  for (std::size_t i = 0; i < points_; ++i) { position_[i] = arc_[i] / unit; }
  // A little further than one turn: of two equally long ways between two points only the one without ghosts counts.
  const double turn = length_ * (1.0 + 1e-14) / unit;
  for (std::size_t j = points_; j < extended_; ++j) { position_[j] = position_[j - points_] + turn; }
  std::fill(position_.begin() + static_cast<std::ptrdiff_t>(extended_), position_.end(),
            std::numeric_limits<double>::infinity());
}

/// Gives every ghost the value of its point, and the padding zeros: no weight.
void CurveSmoother::append_ghosts(AlignedDoubles& values) const {
  for (std::size_t j = points_; j < extended_; ++j) { values[j] = values[j - points_]; }
  std::fill(values.begin() + static_cast<std::ptrdiff_t>(extended_), values.end(), 0.0);
}

/// Adds what the ghosts have collected to their points.
void CurveSmoother::fold_ghosts(AlignedDoubles& sums) const {
  for (std::size_t j = points_; j < extended_; ++j) { sums[j - points_] += sums[j]; }
}

void CurveSmoother::smooth(double t, double reach, SmoothedCurve& out) {
  out.x.resize(points_);
  out.y.resize(points_);
  if (points_ == 0) { return; }
  const double unit = t * std::sqrt(2.0 / std::numbers::log2e);  // 2^−x² in this unit is e^−x²/2t²
  const double farthest = closed_ ? std::min(reach * t, 0.5 * length_) : reach * t;
  lay_out(unit, farthest);
  ends_.resize((points_ + 1) / 2);
  const curve_kernels::Pairs pairs{position_.data(), points_, extended_, farthest / unit, ends_.data()};
  const std::size_t size = curve_kernels::find_ends(pairs);
  if (kernel_.size() < size) { kernel_.resize(size); }
  for (AlignedDoubles* column : {&weight_, &weighted_x_, &weighted_y_, &sum_, &sum_x_, &sum_y_}) {
    resize_padded(*column, extended_);
  }

  std::ranges::fill(sum_, 0.0);
  std::fill_n(sum_.begin(), points_, 1.0);  // k_ii
  curve_kernels::gaussian_sums(pairs, kernel_.data(), sum_.data());
  fold_ghosts(sum_);

  const curve_kernels::Columns columns{weight_.data(), weighted_x_.data(), weighted_y_.data()};
  curve_kernels::prepare_columns(x_.data(), y_.data(), sum_.data(), points_, columns);
  for (AlignedDoubles* column : {&weight_, &weighted_x_, &weighted_y_}) { append_ghosts(*column); }
  const auto start_sums = [&](AlignedDoubles& sums, const AlignedDoubles& column) {  // k_ii again
    std::copy_n(column.begin(), points_, sums.begin());
    std::fill(sums.begin() + static_cast<std::ptrdiff_t>(points_), sums.end(), 0.0);
  };
  start_sums(sum_, weight_);
  start_sums(sum_x_, weighted_x_);
  start_sums(sum_y_, weighted_y_);

  const curve_kernels::Columns sums{sum_.data(), sum_x_.data(), sum_y_.data()};
  curve_kernels::weighted_sums(pairs, kernel_.data(), columns, sums);
  for (AlignedDoubles* column : {&sum_, &sum_x_, &sum_y_}) { fold_ghosts(*column); }
  curve_kernels::divide_columns(sums, points_);
  std::copy_n(sum_x_.begin(), points_, out.x.begin());
  std::copy_n(sum_y_.begin(), points_, out.y.begin());
}

void smooth_over(const GeodesicNeighbours& neighbours, std::span<const double> x, std::span<const double> y, double t,
                 double reach, SmoothedCurve& out) {
  const std::size_t n = x.size();
  FLIRT_ASSERT(neighbours.first.size() == n + 1);
  out.x.resize(n);
  out.y.resize(n);
  std::vector<double> kernel(neighbours.distance.size());
  std::vector<double> density(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = neighbours.first[i]; k < neighbours.first[i + 1]; ++k) {
      kernel[k] = kernel_value(neighbours.distance[k], t, reach);
      density[i] += kernel[k];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0.0;
    double sum_x = 0.0;
    double sum_y = 0.0;
    for (std::size_t k = neighbours.first[i]; k < neighbours.first[i + 1]; ++k) {
      const std::size_t j = neighbours.point[k];
      const double weight = kernel[k] / density[j];
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
