#include "flirt/arena/point_histograms.hpp"

#include "flirt/arena/sectors.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flirt {
namespace {

/// The returns around a keypoint of this scan; none when its own beam has no return that counts.
class SurroundingsOf {
 public:
  explicit SurroundingsOf(const Scan& scan, const ReturnLimits& limits)
      : polar_(polar_scan(scan, limits)), element_of_beam_(polar_.size()) {
    for (std::uint32_t i = 0; i < polar_.size(); ++i) { element_of_beam_[polar_.beams[i]] = i; }
  }

  [[nodiscard]] Surroundings operator()(const Keypoint& keypoint, double fixed_radius) const {
    Surroundings around{.radius = fixed_radius > 0 ? fixed_radius : double{keypoint.support_radius},
                        .direction = keypoint.sensor_from_keypoint.theta};
    if (keypoint.beam >= polar_.size() || !std::isfinite(around.direction)) { return around; }
    const std::uint32_t i = element_of_beam_[keypoint.beam];
    if (!polar_.has_return(i)) { return around; }
    const auto& [left, right] = neighbours_of(polar_, i, around.radius);
    for (const std::uint32_t j : left) { around.offsets.push_back(polar_.points[j] - polar_.points[i]); }
    for (const std::uint32_t j : right) { around.offsets.push_back(polar_.points[j] - polar_.points[i]); }
    return around;
  }

 private:
  PolarScan polar_;
  std::vector<std::uint32_t> element_of_beam_;
};

Descriptors empty_rows(std::size_t count, std::uint32_t dimension) {
  Descriptors rows;
  rows.dimension = dimension;
  rows.stride = (dimension + 15) / 16 * 16;
  rows.rows.resize(count * rows.stride);
  rows.roots.resize(count * rows.stride);
  return rows;
}

void set(Descriptors& rows, std::size_t i, std::size_t k, double value) {
  rows.rows[i * rows.stride + k] = static_cast<float>(value);
  rows.roots[i * rows.stride + k] = static_cast<float>(std::sqrt(value));
}

}  // namespace

std::vector<char> bsc_bits(const Surroundings& around, const BscParams& params) {
  std::vector<char> bits(std::size_t{params.rings} * params.sectors);
  for (const Point2 offset : around.offsets) {
    const double away = norm(offset);
    if (!(away > 0) || away > around.radius) { continue; }
    const auto ring = std::min(params.rings - 1, static_cast<std::uint32_t>(away * params.rings / around.radius));
    bits[ring * params.sectors + sector_of(direction_of(offset) - around.direction, params.sectors)] = 1;
  }
  return bits;
}

std::uint32_t bsc_distance(std::span<const char> a, std::span<const char> b, std::uint32_t sectors,
                           std::uint32_t max_shift) {
  const auto differing = [&](std::uint32_t shift) {
    std::uint32_t count = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      const std::size_t ring = k / sectors;
      count += a[k] != b[ring * sectors + (k % sectors + shift) % sectors] ? 1 : 0;
    }
    return count;
  };
  std::uint32_t least = differing(0);
  for (std::uint32_t shift = 1; shift <= std::min(max_shift, sectors - 1); ++shift) {
    least = std::min({least, differing(shift), differing(sectors - shift)});
  }
  return least;
}

std::vector<double> cgh_bins(const Surroundings& around, const CghParams& params) {
  const std::uint32_t n = params.sectors;
  std::vector<double> bins(n);
  for (const Point2 offset : around.offsets) {
    const double away = norm(offset);
    if (!(away > 0) || away > around.radius) { continue; }
    const std::uint32_t sector = sector_of(direction_of(offset) - around.direction, n);
    bins[sector] += 5;
    bins[(sector + 1) % n] += 1;
    bins[(sector + n - 1) % n] += 1;
  }
  const double sum = std::accumulate(bins.begin(), bins.end(), 0.0);
  for (double& bin : bins) { bin = sum > 0 ? bin / sum : 0; }
  return bins;
}

double cgh_distance(std::span<const double> a, std::span<const double> b) {
  const auto is_empty = [](std::span<const double> bins) {
    return std::ranges::all_of(bins, [](double x) { return x == 0; });
  };
  if (is_empty(a) || is_empty(b)) { return 1; }
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k] + b[k] > 0) { sum += (a[k] - b[k]) * (a[k] - b[k]) / (a[k] + b[k]); }
  }
  return sum / 2;
}

Descriptors describe_bsc(const Scan& scan, std::span<const Keypoint> keypoints, const BscParams& params) {
  const std::uint32_t bits = params.rings * params.sectors;
  const SurroundingsOf around(scan, params.limits);
  Descriptors rows = empty_rows(keypoints.size(), bits);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const std::vector<char> own = bsc_bits(around(keypoints[i], params.radius), params);
    for (std::size_t k = 0; k < bits; ++k) { set(rows, i, k, own[k] != 0 ? 2.0 / bits : 0.0); }
  }
  return rows;
}

Descriptors describe_cgh(const Scan& scan, std::span<const Keypoint> keypoints, const CghParams& params) {
  const SurroundingsOf around(scan, params.limits);
  Descriptors rows = empty_rows(keypoints.size(), params.sectors + 1);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const std::vector<double> own = cgh_bins(around(keypoints[i], params.radius), params);
    double left = 1;
    for (std::size_t k = 0; k < own.size(); ++k) {
      set(rows, i, k, own[k]);
      left -= own[k];
    }
    if (left > 0.5) { set(rows, i, params.sectors, 1); }
  }
  return rows;
}

}  // namespace flirt
