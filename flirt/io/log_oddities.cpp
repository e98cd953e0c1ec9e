#include "flirt/io/log_oddities.hpp"

#include "flirt/io/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <numbers>
#include <utility>

namespace flirt {
namespace {

constexpr double assumed_range_max = 50.0;  // m
constexpr std::size_t most_complaints = 5;  // that are kept

/// All hits, longest first.
std::vector<double> sorted_hits(const std::vector<Scan>& scans) {
  std::vector<double> hits;
  for (const Scan& scan : scans) {
    std::copy_if(scan.ranges.begin(), scan.ranges.end(), std::back_inserter(hits),
                 [&](double range) { return classify(range, scan.beams) == Reading::hit; });
  }
  std::sort(hits.begin(), hits.end(), std::greater<>());
  return hits;
}

/// The value that stands for "no return" below the declared longest range, or nothing.
std::optional<double> piled_up_maximum(const std::vector<Scan>& scans) {
  double longest = 0;
  std::size_t pile = 0;
  std::size_t readings = 0;
  for (const Scan& scan : scans) {
    readings += scan.ranges.size();
    for (const double range : scan.ranges) {
      if (range < longest || classify(range, scan.beams) != Reading::hit) { continue; }
      pile = range > longest ? 1 : pile + 1;
      longest = range;
    }
  }
  if (pile < 10 || 1000 * pile < readings) { return std::nullopt; }  // nearly all logs end here
  const std::vector<double> hits = sorted_hits(scans);
  std::size_t values = 0;
  for (std::size_t i = pile; i < hits.size() && values < 100; ++values) {
    const auto end = std::find_if(hits.begin() + static_cast<std::ptrdiff_t>(i), hits.end(),
                                  [&](double range) { return range != hits[i]; });
    const auto next = static_cast<std::size_t>(end - hits.begin());
    if (10 * (next - i) > pile) { return std::nullopt; }
    i = next;
  }
  return values >= 20 ? std::optional(longest) : std::nullopt;  // fewer: an artificial scene rather than a log
}

}  // namespace

RangeMaxSource settle_range_max(std::optional<double> option, std::vector<Scan>& scans) {
  if (option) {
    for (Scan& scan : scans) { scan.beams.range_max = *option; }
    return RangeMaxSource::option;
  }
  RangeMaxSource source = RangeMaxSource::declared;
  for (Scan& scan : scans) {
    if (scan.beams.range_max > 0) { continue; }
    scan.beams.range_max = assumed_range_max;
    source = RangeMaxSource::assumed;
  }
  if (const auto no_return = piled_up_maximum(scans)) {
    for (Scan& scan : scans) { scan.beams.range_max = std::min(scan.beams.range_max, *no_return); }
    source = RangeMaxSource::detected;
  }
  return source;
}

std::string wrong_angles(const Beams& beams, std::size_t n) {
  constexpr double turn = 2.0 * std::numbers::pi;
  const double step = std::abs(beams.angle_step);
  const bool is_within_turn = step * static_cast<double>(n) <= turn + 1.5 * step;  // false for what is no number
  const bool has_step = n < 2 || step != 0.0;
  if (std::abs(beams.angle_min) <= 2.0 * turn && std::isfinite(step) && is_within_turn && has_step) { return {}; }
  return "expected angles within one turn, found " + std::to_string(n) + " beams in steps of " +
         number_text(beams.angle_step) + " rad from " + number_text(beams.angle_min);
}

Result<void> reject(LogReport& report, const ReadOptions& options, std::string complaint) {
  if (options.broken_lines == BrokenLines::strict) { return fail(std::move(complaint)); }
  ++report.broken_lines;
  if (report.broken_messages.size() < most_complaints) { report.broken_messages.push_back(std::move(complaint)); }
  return {};
}

void describe_stamps(const std::vector<Scan>& scans, LogReport& report) {
  report.stamps_constant = scans.size() > 1;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    if (scans[i].stamp < scans[i - 1].stamp) { ++report.stamps_backwards; }
    if (scans[i].stamp != scans[i - 1].stamp) { report.stamps_constant = false; }
  }
}

}  // namespace flirt
