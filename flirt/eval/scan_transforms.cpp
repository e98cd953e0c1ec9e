#include "flirt/eval/scan_transforms.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/rng.hpp"

#include <limits>
#include <utility>

namespace flirt {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

double between(double range, double next, double share, const Beams& beams) {
  const Reading reading = classify(range, beams);
  if (reading != classify(next, beams)) { return nothing; }
  return reading == Reading::hit ? range + share * (next - range) : range;
}

}  // namespace

Scan with_radial_noise(Scan scan, double sigma, std::uint64_t seed, std::uint64_t stream) {
  Rng rng(seed, stream);
  for (double& range : scan.ranges) {
    if (classify(range, scan.beams) != Reading::hit) { continue; }
    const double noisy = range + rng.normal(0.0, sigma);
    range = noisy > 0 ? noisy : nothing;
  }
  return scan;
}

Scan subsampled(const Scan& scan, std::uint32_t factor) {
  FLIRT_ASSERT(factor >= 1);
  Scan result = scan;
  result.ranges.clear();
  for (std::size_t i = 0; i < scan.ranges.size(); i += factor) { result.ranges.push_back(scan.ranges[i]); }
  result.beams.angle_step *= factor;
  return result;
}

Scan oversampled(const Scan& scan, std::uint32_t factor) {
  FLIRT_ASSERT(factor >= 1);
  Scan result = scan;
  result.ranges.clear();
  const std::size_t n = scan.ranges.size();
  const bool closed = is_full_turn(scan);
  for (std::size_t i = 0; i < n; ++i) {
    result.ranges.push_back(scan.ranges[i]);
    if (i + 1 == n && !closed) { break; }
    for (std::uint32_t k = 1; k < factor; ++k) {
      const double share = static_cast<double>(k) / factor;
      result.ranges.push_back(between(scan.ranges[i], scan.ranges[(i + 1) % n], share, scan.beams));
    }
  }
  result.beams.angle_step /= factor;
  return result;
}

}  // namespace flirt
