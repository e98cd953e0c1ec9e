// flirt/io/log_oddities.hpp: what a log does not say of its ranges, what is odd about its stamps, and what of it is
// broken. Internal to flirt/io.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/io/log.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace flirt {

/// Sets the longest range of all scans: to the option, if there is one; else what they declare (0: nothing), else
/// 50 m, but not above the value at which readings pile up. O(readings), O(readings · log) when there is such a value.
[[nodiscard]] RangeMaxSource settle_range_max(std::optional<double> option, std::vector<Scan>& scans);

/// The complaint about beams that do not lie within one turn (which may end on its first beam again), whose angles are
/// not finite or all the same; empty when there is none.
[[nodiscard]] std::string wrong_angles(const Beams& beams, std::size_t n);

/// Counts a line or message that cannot be read, of the first few with the complaint, or gives the error when that is
/// not allowed.
[[nodiscard]] Result<void> reject(LogReport& report, const ReadOptions& options, std::string complaint);

/// Fills the parts of the report that tell whether stamps repeat or run backwards.
void describe_stamps(const std::vector<Scan>& scans, LogReport& report);

}  // namespace flirt
