// flirt/features/peaks.hpp: extrema of a sampled signal.
#pragma once

#include "flirt/core/fields.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {

enum class PeakRule {
  neighbours,  ///< a maximum exceeds both neighbours by more than the difference, equal samples counting as one: the
               ///< rule of the authors' own program
  prominence,  ///< to both sides the signal falls by more than the difference, in any number of samples, before it
               ///< rises above the maximum: does not depend on how densely the signal is sampled
};
constexpr auto enum_names(PeakRule /*tag*/) {
  return std::to_array<std::pair<PeakRule, std::string_view>>(
      {{PeakRule::neighbours, "neighbours"}, {PeakRule::prominence, "prominence"}});
}

struct PeakParams {
  double threshold{0.34};               ///< of the response (m or rad for the signal detectors); maxima lie above
  double difference{0.001};             ///< by which a maximum must stand out, in the unit of the response
  PeakRule rule{PeakRule::prominence};  ///< among which samples it must stand out
};

enum class Extrema {
  maxima,
  both,  ///< maxima, and minima by the same rules on the negated signal
};

/// A stretch of samples to search.
struct PeakSearch {
  Extrema extrema{Extrema::maxima};
  std::size_t margin{0};  ///< samples at either end of an open signal besides the outermost one that are not searched
  bool closed{false};     ///< circular: the last sample is followed by the first
};

/// Indices of the extrema in increasing order. On a plateau (samples within 1e-9 of each other) the middle one, the
/// earlier of two. O(n).
void find_peaks(std::span<const double> signal, const PeakParams& params, const PeakSearch& search,
                std::vector<std::uint32_t>& peaks);

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, PeakParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.threshold, Field{"peak_threshold", "1, m or rad", "smallest response of a peak", 0.0, 1e6});
  visit(params.difference, Field{"peak_difference", "1, m or rad", "by which a peak must stand out", 0.0, 1e6});
  visit(params.rule, Field{"peak_rule", "", "among which samples a peak must stand out"});
}

}  // namespace flirt
