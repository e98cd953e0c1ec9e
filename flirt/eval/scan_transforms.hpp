// flirt/eval/scan_transforms.hpp: what the papers do to a scan to see whether its features survive (P2 §IV-A).
#pragma once

#include "flirt/core/scan.hpp"

#include <cstdint>

namespace flirt {

/// Adds normal noise of standard deviation `sigma` (m) to every hit, along its beam. A range that would fall to 0 or
/// below loses its beam (NaN), one beyond range_max becomes a no-return, as a scanner would do it. Equal (seed, stream)
/// give equal noise. O(beams).
[[nodiscard]] Scan with_radial_noise(Scan scan, double sigma, std::uint64_t seed, std::uint64_t stream = 0);

/// Keeps every `factor`-th reading, beginning with the first (factor ≥ 1): as a scanner with fewer beams. O(beams).
[[nodiscard]] Scan subsampled(const Scan& scan, std::uint32_t factor);

/// Inserts factor − 1 readings between neighbouring beams, by linear interpolation in polar coordinates: across a jump
/// of the range that makes points in mid-air, which is part of the test. Between two beams of which one has no hit the
/// new readings say what both say, or nothing (NaN). The last and the first beam of a full turn are neighbours.
/// O(beams · factor).
[[nodiscard]] Scan oversampled(const Scan& scan, std::uint32_t factor);

}  // namespace flirt
