#include "flirt/features/curve_smoothing.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/features/curve_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace flirt {
namespace {

constexpr double rounding = 3e-7;  ///< relative, of distances in single precision

template <class Values>
void resize_padded(Values& values, std::size_t n) {
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
  exact_x_.assign(x.begin(), x.end());
  exact_y_.assign(y.begin(), y.end());
  const auto rounded = [](double value) { return static_cast<float>(value); };
  std::ranges::transform(x, x_.begin(), rounded);
  std::ranges::transform(y, y_.begin(), rounded);
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

/// Positions as two floats each, of points in rows, and of points and ghosts in groups; and how far each reaches:
/// `reach` in the unit of positions. Floats can't tell two nearly equal ways around a closed curve apart, so ghosts
/// reach a little less.
void CurveSmoother::split_positions(double reach) {
  using curve_kernels::padding;
  row_high_.assign(points_ + curve_kernels::rows_at_once, curve_kernels::beyond_everything);
  row_low_.assign(points_ + curve_kernels::rows_at_once, 0.0F);
  for (std::size_t i = 0; i < points_; ++i) {
    row_high_[i] = static_cast<float>(position_[i]);
    row_low_[i] = static_cast<float>(position_[i] - double{row_high_[i]});
  }
  const std::size_t size = 2 * (extended_ / padding + 2) * padding;
  position_high_.resize(size);
  position_low_.resize(size);
  reach_of_.resize(size);
  const std::size_t whole = points_ / padding * padding;
  for (std::size_t first = 0; first < whole; first += padding) {
    for (const std::size_t copy : {2 * first, 2 * first + padding}) {
      std::copy_n(&row_high_[first], padding, &position_high_[copy]);
      std::copy_n(&row_low_[first], padding, &position_low_[copy]);
    }
  }
  std::fill_n(reach_of_.begin(), 2 * whole, static_cast<float>(reach * (1.0 + rounding)));
  for (std::size_t i = whole; curve_kernels::first_copy(i) < size; ++i) {
    const bool exists = i < extended_;
    const auto high = static_cast<float>(exists ? position_[i] : std::numeric_limits<double>::infinity());
    const float low = exists ? static_cast<float>(position_[i] - double{high}) : 0.0F;
    for (const std::size_t copy : {curve_kernels::first_copy(i), curve_kernels::first_copy(i) + padding}) {
      position_high_[copy] = high;
      position_low_[copy] = low;
      reach_of_[copy] = static_cast<float>(reach * (i < points_ ? 1.0 + rounding : 1.0 - rounding));
    }
  }
}

/// Gives every ghost the value of its point, and the padding zeros: no weight.
void CurveSmoother::append_ghosts(AlignedVector<float>& values) const {
  resize_padded(values, extended_);
  for (std::size_t j = points_; j < extended_; ++j) { values[j] = values[j - points_]; }
  std::fill(values.begin() + static_cast<std::ptrdiff_t>(extended_), values.end(), 0.0F);
}

/// Adds what the ghosts have collected to their points.
void CurveSmoother::fold_ghosts(AlignedVector<float>& sums) const {
  for (std::size_t j = points_; j < extended_; ++j) { sums[j - points_] += sums[j]; }
}

void CurveSmoother::smooth(double t, double reach, SmoothedCurve& out) {
  out.x.resize(points_);
  out.y.resize(points_);
  if (points_ == 0) { return; }
  const double unit = t * std::sqrt(2.0 / std::numbers::log2e);  // 2^−x² in this unit is e^−x²/2t²
  const double farthest = closed_ ? std::min(reach * t, 0.5 * length_) : reach * t;
  lay_out(unit, farthest);
  const double farthest_position = std::min(farthest / unit, curve_kernels::farthest);
  split_positions(farthest_position);
  ends_.resize((points_ + curve_kernels::rows_at_once - 1) / curve_kernels::rows_at_once);
  const curve_kernels::Pairs pairs{.arc = position_.data(),
                                   .row_high = row_high_.data(),
                                   .row_low = row_low_.data(),
                                   .arc_high = position_high_.data(),
                                   .arc_low = position_low_.data(),
                                   .reach_of = reach_of_.data(),
                                   .count = points_,
                                   .extended = extended_,
                                   .reach = farthest_position * (1.0 + 2.0 * rounding),
                                   .ends = ends_.data()};
  const std::size_t size = curve_kernels::find_ends(pairs);
  if (kernel_.size() < size) { kernel_.resize(size); }
  for (AlignedVector<float>* column : {&density_, &weight_, &sum_, &sum_x_, &sum_y_}) {
    resize_padded(*column, extended_);
    std::ranges::fill(*column, 0.0F);
  }
  std::fill_n(density_.begin(), points_, 1.0F);  // k_ii
  const std::size_t row_count = (points_ / curve_kernels::padding + 1) * curve_kernels::padding;
  rows_.assign(3 * row_count, 0.0F);
  const curve_kernels::Columns rows{rows_.data(), rows_.data() + row_count, rows_.data() + 2 * row_count};
  curve_kernels::gaussian_sums(pairs, kernel_.data(), density_.data(), rows.weight);
  fold_ghosts(density_);

  curve_kernels::invert(density_.data(), points_, weight_.data());
  for (AlignedVector<float>* column : {&weight_, &x_, &y_}) { append_ghosts(*column); }
  std::copy_n(weight_.begin(), points_, sum_.begin());  // k_ii again
  const curve_kernels::Columns sums{sum_.data(), sum_x_.data(), sum_y_.data()};
  curve_kernels::weighted_sums(pairs, kernel_.data(), {weight_.data(), x_.data(), y_.data()}, sums, rows);
  for (AlignedVector<float>* column : {&sum_, &sum_x_, &sum_y_}) { fold_ghosts(*column); }
  curve_kernels::divide_columns(sums, points_);
  for (std::size_t i = 0; i < points_; ++i) {
    out.x[i] = exact_x_[i] + double{sum_x_[i]};
    out.y[i] = exact_y_[i] + double{sum_y_[i]};
  }
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
