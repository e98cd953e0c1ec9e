// apps/flirt/latency.hpp: the times of single scans in three numbers.
#pragma once

#include <algorithm>
#include <vector>

namespace flirt::app {

/// Median, 99 % and worst, ms of wall clock; zeros for none.
struct Latency {
  double median{0};
  double p99{0};
  double worst{0};
};

inline Latency latency_of(std::vector<double> ms) {
  if (ms.empty()) { return {}; }
  std::ranges::sort(ms);
  return {ms[ms.size() / 2], ms[std::min(ms.size() - 1, ms.size() * 99 / 100)], ms.back()};
}

}  // namespace flirt::app
