#include "flirt/features/peaks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace flirt {
namespace {

/// Samples closer than this are equal: rounding differs when the same scan is seen from another heading.
constexpr double plateau_tolerance{1e-9};

/// An open signal as it is.
struct PlainSamples {
  const double* signal;

  [[nodiscard]] double operator[](std::size_t i) const { return signal[i]; }
};

/// The signal, or its negative, with indices that may go around a closed signal once more.
struct Samples {
  std::span<const double> signal;
  double sign;

  [[nodiscard]] double operator[](std::size_t i) const {
    return sign * signal[i < signal.size() ? i : i - signal.size()];
  }
};

struct Collector {
  const PeakSearch& search;
  std::size_t n;
  std::vector<std::uint32_t>& peaks;

  /// The plateau first..last is a peak.
  void add(std::size_t first, std::size_t last) const {
    const std::size_t middle = (first + last) / 2 % n;
    const bool inside = middle > search.margin && middle + search.margin + 1 < n;
    if (search.closed || inside) { peaks.push_back(static_cast<std::uint32_t>(middle)); }
  }
};

/// A sample from which a closed signal can be unrolled without cutting a peak: its lowest.
std::size_t lowest(const Samples& samples, std::size_t n) {
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < n; ++i) {
    if (samples[i] < samples[lowest]) { lowest = i; }
  }
  return lowest;
}

/// Samples begin .. end − 1, of which the outermost are never peaks.
struct Stretch {
  std::size_t begin;
  std::size_t end;
};

template <class Signal>
void peaks_over_neighbours(const Signal& samples, Stretch stretch, const PeakParams& params, const Collector& out) {
  for (std::size_t first = stretch.begin + 1; first + 1 < stretch.end;) {
    const double value = samples[first];
    if (!(value > params.threshold && value - samples[first - 1] > params.difference)) {
      ++first;
      continue;
    }
    std::size_t last = first;
    while (last + 1 < stretch.end && std::abs(samples[last + 1] - samples[last]) <= plateau_tolerance) { ++last; }
    if (last + 1 < stretch.end && samples[last] - samples[last + 1] > params.difference) { out.add(first, last); }
    first = last + 1;
  }
}

/// The prominent peaks within samples begin .. end − 1, the first of which is no peak.
template <class Signal>
void prominent_peaks_within(const Signal& samples, Stretch stretch, const PeakParams& params, const Collector& out) {
  double low = samples[stretch.begin];  // since the last peak
  bool rising = false;                  // more than the difference above `low`: looking for the top
  double top = 0.0;
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t i = stretch.begin + 1; i < stretch.end; ++i) {
    const double value = samples[i];
    if (!rising) {
      low = std::min(low, value);
      rising = value - low > params.difference;
      if (!rising) { continue; }
      top = value;
      first = last = i;
    } else if (value > top + plateau_tolerance) {
      top = value;
      first = last = i;
    } else if (value >= top - plateau_tolerance) {
      last = i;
    } else if (top - value > params.difference) {
      if (top > params.threshold) { out.add(first, last); }
      rising = false;
      low = value;
    }
  }
}

template <class Signal>
void prominent_peaks(const Signal& samples, Stretch stretch, const PeakParams& params, const Collector& out) {
  // A peak above the threshold ends, on both sides, with samples below this: only look between such.
  const double floor = params.threshold - params.difference;
  for (std::size_t i = stretch.begin; i + 1 < stretch.end;) {
    if (!(samples[i + 1] > floor)) {
      ++i;
      continue;
    }
    std::size_t end = i + 2;
    while (end < stretch.end && samples[end] > floor) { ++end; }
    prominent_peaks_within(samples, {i, std::min(end + 1, stretch.end)}, params, out);
    i = end;
  }
}

template <class Signal>
void peaks_of(const Signal& samples, Stretch stretch, const PeakParams& params, const Collector& out) {
  params.rule == PeakRule::neighbours ? peaks_over_neighbours(samples, stretch, params, out)
                                      : prominent_peaks(samples, stretch, params, out);
}

}  // namespace

void find_peaks(std::span<const double> signal, const PeakParams& params, const PeakSearch& search,
                std::vector<std::uint32_t>& peaks) {
  peaks.clear();
  const std::size_t n = signal.size();
  if (n < 3) { return; }
  const Collector collector{search, n, peaks};
  if (search.extrema == Extrema::maxima && !search.closed) {
    peaks_of(PlainSamples{signal.data()}, {0, n}, params, collector);  // already in order
    return;
  }
  for (const double sign : {1.0, -1.0}) {
    if (sign < 0.0 && search.extrema == Extrema::maxima) { break; }
    const Samples samples{signal, sign};
    const std::size_t begin = search.closed ? lowest(samples, n) : 0;
    peaks_of(samples, {begin, search.closed ? begin + n + 1 : n}, params, collector);
  }
  std::ranges::sort(peaks);
}

}  // namespace flirt
