// bench/micro/scans.hpp: the scans that the micro benchmarks run over.
#pragma once

#include "flirt/core/scan.hpp"

#include <vector>

namespace flirt::bench {

/// Where scans come from.
enum class Source {
  simulated_180,  ///< a fixed office, half a turn of 180 beams
  simulated_360,  ///< the same with 360 beams
  fr079,          ///< the real log; empty where it is absent
};

/// 64 scans spread evenly over the log, read or made once.
[[nodiscard]] const std::vector<Scan>& scans_of(Source source);

}  // namespace flirt::bench
