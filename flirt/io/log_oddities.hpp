// flirt/io/log_oddities.hpp: what a log does not say of its ranges, and what is odd about its stamps. Internal to
// flirt/io.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/io/log.hpp"

#include <optional>
#include <vector>

namespace flirt {

/// Sets the longest range of all scans: to the option, if there is one; else what they declare (0: nothing), else
/// 50 m, but not above the value at which readings pile up. O(readings), O(readings · log) when there is such a value.
[[nodiscard]] RangeMaxSource settle_range_max(std::optional<double> option, std::vector<Scan>& scans);

/// Fills the parts of the report that tell whether stamps repeat or run backwards.
void describe_stamps(const std::vector<Scan>& scans, LogReport& report);

}  // namespace flirt
