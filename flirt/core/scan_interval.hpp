// flirt/core/scan_interval.hpp: consecutive scans of a log or a map.
#pragma once

#include <cstddef>

namespace flirt {

/// Scans [begin, end) of a log or a map; empty by default.
struct ScanInterval {
  std::size_t begin{0};
  std::size_t end{0};

  [[nodiscard]] bool contains(std::size_t scan) const { return scan >= begin && scan < end; }
  friend bool operator==(const ScanInterval&, const ScanInterval&) = default;
};

}  // namespace flirt
