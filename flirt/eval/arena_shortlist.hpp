// flirt/eval/arena_shortlist.hpp: which scans GLAROT ranks first.
#pragma once

#include "flirt/eval/arena.hpp"
#include "flirt/eval/arena_features.hpp"

#include <span>
#include <string>
#include <vector>

namespace flirt {

/// Signatures of all scans, and where the first one near each query ranks. `keypoints` has a list per scan. A query
/// with too few keypoints is a miss. O(queries · scans).
[[nodiscard]] ShortlistResult bench_shortlist(const std::string& detector, const ScanLog& log,
                                              std::span<const std::vector<Keypoint>> keypoints,
                                              const ArenaQueries& queries, const ArenaParams& params,
                                              std::size_t threads);

}  // namespace flirt
