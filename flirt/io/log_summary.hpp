// flirt/io/log_summary.hpp: a log of scans in a few numbers.
#pragma once

#include "flirt/core/scan.hpp"

#include <cstddef>
#include <vector>

namespace flirt {

/// Lengths of valid readings, m; all 0 when there are none.
struct RangeSummary {
  std::size_t hits{0};
  std::size_t no_returns{0};
  std::size_t invalid{0};
  double shortest{0};
  double median{0};
  double percentile_95{0};
  double longest{0};
};

/// s; all 0 for fewer than two scans, `first` and `last` in the order of the log.
struct StampSummary {
  double first{0};
  double last{0};
  double duration{0};         ///< from the smallest to the largest stamp
  double median_interval{0};  ///< between scans that follow each other
};

/// Of a list of poses, m.
struct PathSummary {
  std::size_t poses{0};
  double length{0};
  Point2 low{};   ///< smallest x and y
  Point2 high{};  ///< largest x and y
};

struct LogSummary {
  std::size_t scans{0};
  std::size_t fewest_beams{0};
  std::size_t most_beams{0};
  RangeSummary ranges{};
  StampSummary stamps{};
  PathSummary map{};       ///< of the poses that the log states
  PathSummary odometry{};  ///< of scans that have it
};

/// O(readings), with a copy of all valid readings.
[[nodiscard]] LogSummary summarize(const ScanLog& log);

}  // namespace flirt
