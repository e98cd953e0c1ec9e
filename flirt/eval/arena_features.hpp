// flirt/eval/arena_features.hpp: the features of a whole log by one contender, with what they cost and how stable they
// are from one scan to the next.
#pragma once

#include "flirt/eval/arena.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace flirt {

/// What is asked, the same for every contender.
struct ArenaQueries {
  std::vector<std::size_t> scans{};     ///< of the log
  std::vector<ScanInterval> removed{};  ///< per scan of the log, under `revisit`
  std::vector<bool> answerable{};       ///< per query, under `revisit`

  /// What is not in the map when the k-th query is asked.
  [[nodiscard]] ScanInterval excluded(std::size_t k, ArenaProtocol protocol) const {
    return protocol == ArenaProtocol::paper ? ScanInterval{scans[k], scans[k] + 1} : removed[scans[k]];
  }
  [[nodiscard]] bool counts(std::size_t k, ArenaProtocol protocol) const {
    return protocol == ArenaProtocol::paper || answerable[k];
  }
};

/// 0 for none.
[[nodiscard]] double mean_us(std::span<const double> times);

/// What one detector finds in all scans of the log.
struct DetectedLog {
  std::vector<std::vector<Keypoint>> keypoints{};
  double detect_us{0};   ///< a scan, CPU
  double per_scan{0};    ///< keypoints
  Rate repeatability{};  ///< of the next scan in the log
};

[[nodiscard]] DetectedLog detect_all(const ScanLog& log, const NamedDetector& named, const ArenaQueries& queries,
                                     const ArenaParams& params, std::size_t threads);

/// All scans with one kind of features.
struct DescribedLog {
  std::vector<ArenaScan> scans{};
  double describe_us{0};        ///< a scan, CPU
  double average_precision{0};  ///< of nearest descriptors in the next scan of the log; 0 without descriptors
};

[[nodiscard]] DescribedLog describe_all(const ScanLog& log, const DetectedLog& detected,
                                        const std::optional<NamedDescriptor>& named, const ArenaQueries& queries,
                                        const ArenaParams& params, std::size_t threads);

}  // namespace flirt
