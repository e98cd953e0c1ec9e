// flirt/arena/point_matches.hpp: what the rival matchers are given and what they yield.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/match/ransac.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace flirt {

/// Keypoint positions of two scans, m, each in its sensor frame.
struct PointSets {
  std::span<const Point2> query;
  std::span<const Point2> reference;
};

/// Every query point with every reference point, in order: for matchers that look at no descriptor.
[[nodiscard]] std::vector<IndexPair> all_pairs(const PointSets& points);

/// A motion and the pairs that it was fitted to, one to one, in order of the query.
struct PointAlignment {
  Pose2 reference_from_query{};
  std::vector<IndexPair> pairs{};
  bool is_proven{true};  ///< no larger set of pairs exists; false: the search was cut short

  friend bool operator==(const PointAlignment&, const PointAlignment&) = default;
};

/// fit_rigid of these pairs.
[[nodiscard]] std::optional<Pose2> fit_pairs(const PointSets& points, std::span<const IndexPair> pairs);

/// Distance of a pair's points after the motion, m.
[[nodiscard]] double residual_of(const PointSets& points, const IndexPair& pair, const Pose2& reference_from_query);

}  // namespace flirt
