#include "flirt/features/normal.hpp"

#include "flirt/core/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace flirt {
namespace {

/// Normal of the total least squares line through the points first, first + 1, …, first + count − 1 (modulo n).
double window_normal(std::span<const double> x, std::span<const double> y, std::size_t first, std::size_t count) {
  const auto index = [&](std::size_t k) { return first + k < x.size() ? first + k : first + k - x.size(); };
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    mean_x += x[index(k)];
    mean_y += y[index(k)];
  }
  mean_x /= static_cast<double>(count);
  mean_y /= static_cast<double>(count);
  double sxx = 0.0;
  double syy = 0.0;
  double sxy = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double dx = x[index(k)] - mean_x;
    const double dy = y[index(k)] - mean_y;
    sxx += dx * dx;
    syy += dy * dy;
    sxy += dx * dy;
  }
  const double alpha = 0.5 * std::atan2(-2.0 * sxy, syy - sxx);
  const double rho = mean_x * std::cos(alpha) + mean_y * std::sin(alpha);
  return rho < 0.0 ? wrap_angle(alpha + std::numbers::pi) : alpha;
}

}  // namespace

void estimate_normals(std::span<const double> x, std::span<const double> y, int window, bool closed,
                      std::vector<double>& normals) {
  const std::size_t n = x.size();
  normals.resize(n);
  if (n == 0) { return; }
  const std::size_t half = std::min(static_cast<std::size_t>(std::max(window - 1, 0)) / 2, (n - 1) / 2);
  const std::size_t count = 2 * half + 1;
  for (std::size_t i = 0; i < n; ++i) {
    const bool inside = i >= half && i + half < n;
    if (closed || inside) { normals[i] = window_normal(x, y, (i + n - half) % n, count); }
  }
  if (closed) { return; }
  for (std::size_t i = 0; i < half; ++i) {
    normals[i] = normals[half];
    normals[n - 1 - i] = normals[n - 1 - half];
  }
}

double unwrap(std::span<double> angles) {
  constexpr double turn = 2.0 * std::numbers::pi;
  if (angles.empty()) { return 0.0; }
  for (std::size_t i = 1; i < angles.size(); ++i) {
    angles[i] -= turn * std::round((angles[i] - angles[i - 1]) / turn);
  }
  return turn * std::round((angles.back() - angles.front()) / turn);
}

}  // namespace flirt
