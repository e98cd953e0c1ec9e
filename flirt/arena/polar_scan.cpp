#include "flirt/arena/polar_scan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace flirt {
namespace {

/// The element `offset` further on, or nothing beyond the ends of an open scan.
std::optional<std::uint32_t> element_at(const PolarScan& scan, std::size_t i, std::ptrdiff_t offset) {
  const auto n = static_cast<std::ptrdiff_t>(scan.size());
  std::ptrdiff_t j = static_cast<std::ptrdiff_t>(i) + offset;
  if (scan.is_closed) { j = ((j % n) + n) % n; }
  if (j < 0 || j >= n) { return std::nullopt; }
  return static_cast<std::uint32_t>(j);
}

/// Beams from one to the other, the shorter way round.
std::size_t beams_between(const PolarScan& scan, std::size_t i, std::size_t j) {
  const std::size_t apart = i < j ? j - i : i - j;
  return scan.is_closed ? std::min(apart, scan.size() - apart) : apart;
}

/// Beams on one side, no more than there are.
std::size_t limited(const PolarScan& scan, double beams) {
  return static_cast<std::size_t>(std::min(beams, static_cast<double>(scan.size())));
}

std::size_t suppression_window(const PolarScan& scan, std::size_t i, double radius) {
  return limited(scan, std::floor(std::asin(std::min(0.8, radius / scan.ranges[i])) / scan.step));
}

bool is_maximum(const PolarScan& scan, std::span<const double> scores, std::size_t i, double radius) {
  const auto window = static_cast<std::ptrdiff_t>(suppression_window(scan, i, radius));
  for (std::ptrdiff_t offset = -window; offset <= window; ++offset) {
    const std::optional<std::uint32_t> j = element_at(scan, i, offset);
    if (j && scores[*j] > scores[i]) { return false; }
  }
  return true;
}

/// Of maxima with equal scores at consecutive beams the middle one, of an even number the lower of the two.
std::vector<std::uint32_t> middles_of_runs(const PolarScan& scan, std::span<const double> scores,
                                           const std::vector<char>& maximum) {
  const auto continues = [&](std::size_t i, std::ptrdiff_t offset) {
    const std::optional<std::uint32_t> j = element_at(scan, i, offset);
    return j && maximum[*j] != 0 && scores[*j] == scores[i];
  };
  std::vector<std::uint32_t> middles;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (maximum[i] == 0 || continues(i, -1)) { continue; }
    std::ptrdiff_t length = 1;
    while (continues(i, length)) { ++length; }
    middles.push_back(*element_at(scan, i, (length - 1) / 2));
  }
  std::sort(middles.begin(), middles.end());
  return middles;
}

}  // namespace

PolarScan polar_scan(const Scan& scan, const ReturnLimits& limits) {
  PolarScan polar{.step = std::abs(scan.beams.angle_step), .is_closed = is_full_turn(scan)};
  const std::size_t n = scan.ranges.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t beam = scan.beams.angle_step < 0 ? n - 1 - i : i;
    const double range = scan.ranges[beam];
    const bool counts = classify(range, scan.beams) == Reading::hit && range > limits.range_min &&
                        range <= limits.range_max && polar.step > 0;
    const double angle = scan.beams.angle(beam);
    polar.ranges.push_back(counts ? range : 0);
    polar.points.push_back(counts ? Point2{range * std::cos(angle), range * std::sin(angle)} : Point2{});
    polar.beams.push_back(static_cast<std::uint32_t>(beam));
  }
  return polar;
}

double reach_at(double range, const ReachParams& params) {
  const double reach = params.reach * std::exp(params.reach_growth * range);
  return reach < range ? reach : 0.8 * range;
}

Neighbours neighbours_of(const PolarScan& scan, std::size_t i, double radius, Boundary boundary) {
  const double range = scan.ranges[i];
  // Beyond the tangents to the circle of this radius no beam can end in it.
  const std::size_t window =
      radius < range ? limited(scan, std::ceil(std::asin(radius / range) / scan.step)) : scan.size();
  const std::size_t left_window = scan.is_closed ? std::min(window, (scan.size() - 1) / 2) : window;
  const std::size_t right_window = scan.is_closed ? std::min(window, scan.size() / 2) : window;

  Neighbours found;
  const auto add = [&](std::ptrdiff_t offset, std::vector<std::uint32_t>& side) {
    const std::optional<std::uint32_t> j = element_at(scan, i, offset);
    if (!j || !scan.has_return(*j)) { return; }
    const double apart = norm(scan.points[*j] - scan.points[i]);
    if (boundary == Boundary::included ? apart <= radius : apart < radius) { side.push_back(*j); }
  };
  for (auto offset = -static_cast<std::ptrdiff_t>(left_window); offset < 0; ++offset) { add(offset, found.left); }
  for (std::ptrdiff_t offset = 1; offset <= static_cast<std::ptrdiff_t>(right_window); ++offset) {
    add(offset, found.right);
  }
  return found;
}

std::vector<std::uint32_t> local_maxima(const PolarScan& scan, std::span<const double> scores, double radius) {
  std::vector<char> maximum(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    maximum[i] = scores[i] > 0 && is_maximum(scan, scores, i, radius) ? 1 : 0;
  }
  std::vector<std::uint32_t> kept;
  for (const std::uint32_t i : middles_of_runs(scan, scores, maximum)) {
    const std::size_t window = suppression_window(scan, i, radius);
    const bool dominated = std::any_of(kept.begin(), kept.end(), [&](std::uint32_t other) {
      return beams_between(scan, i, other) <= window && scores[other] >= scores[i];
    });
    if (!dominated) { kept.push_back(i); }
  }
  return kept;
}

}  // namespace flirt
