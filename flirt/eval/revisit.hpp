// flirt/eval/revisit.hpp: which queries a map without the query's own neighbourhood can answer at all.
#pragma once

#include "flirt/core/parallel.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/core/scan_interval.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace flirt {

struct RevisitParams {
  double travel{10.0};      ///< m of path on both sides of the query that leave the map
  double reach{15.0};       ///< m, map scans farther away are not asked for their overlap
  double overlap{0.5};      ///< share of the query's points that a map scan must see, too
  double tolerance{0.1};    ///< m, between two points that count as the same
  double returns{0.5};      ///< share of the query's beams that must have a return
  double return_min{0.05};  ///< m, shorter hits (Reading::hit) are no returns
  double return_max{50.0};  ///< m, longer hits are no returns
};

/// Path length from the first scan to each, over the sensor's positions, m.
[[nodiscard]] std::vector<double> path_lengths(const ScanLog& log);

/// For each scan the scans within params.travel of path on both sides, itself included: what leaves the map for it.
[[nodiscard]] std::vector<ScanInterval> travel_neighbours(const ScanLog& log, double travel);

/// Share of the query's points that have a point of the reference within the tolerance, at the given poses. Points are
/// in their sensors' frames. O(query + reference).
[[nodiscard]] double overlap(std::span<const Point2> query, const Pose2& map_from_query,
                             std::span<const Point2> reference, const Pose2& map_from_reference, double tolerance);

/// For each of `queries` (indices of scans) whether some remaining scan overlaps it enough and enough beams return.
/// `log` needs poses. Parallel.
[[nodiscard]] std::vector<bool> answerable(const ScanLog& log, std::span<const std::size_t> queries,
                                           const RevisitParams& params, std::size_t threads,
                                           const Progress& progress = {});

}  // namespace flirt
