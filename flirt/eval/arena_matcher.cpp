#include "flirt/eval/arena_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flirt {
namespace {

/// What RANSAC would have said of this motion.
PairAlignment judged(const Pose2& reference_from_query, const ArenaScan& query, const ArenaScan& reference,
                     double inlier_distance) {
  constexpr double chi_square_95_of_2 = 5.99;
  const double limit = chi_square_95_of_2 * inlier_distance * inlier_distance;
  const double c = std::cos(reference_from_query.theta);
  const double s = std::sin(reference_from_query.theta);
  PairAlignment alignment{.reference_from_query = reference_from_query};
  double sum = 0;
  for (const Point2 point : query.points) {
    const Point2 moved{reference_from_query.x + c * point.x - s * point.y,
                       reference_from_query.y + s * point.x + c * point.y};
    double nearest = limit;
    for (const Point2 other : reference.points) { nearest = std::min(nearest, squared_norm(other - moved)); }
    alignment.inliers += nearest < limit ? 1 : 0;
    sum += nearest;
  }
  alignment.residual = sum / static_cast<double>(query.points.size());
  return alignment;
}

}  // namespace

ArenaScan arena_scan(Features features) {
  ArenaScan scan{.features = std::move(features)};
  scan.table = table_of(scan.features.keypoints);
  for (const Keypoint& keypoint : scan.features.keypoints) {
    scan.points.push_back(keypoint.sensor_from_keypoint.translation());
  }
  return scan;
}

void ContenderMatcher::set_query(const ArenaScan& query) {
  query_ = &query;
  if (matcher_ == ArenaMatcher::ransac) {
    pairs_.set_query(query.columns());
  } else if (source_ == CandidateSource::descriptors) {
    rows_.set_query(rows_of(query.features.descriptors));
  }
}

std::vector<IndexPair> ContenderMatcher::candidates(const ArenaScan& reference) {
  if (source_ == CandidateSource::all_pairs) { return all_pairs({query_->points, reference.points}); }
  std::vector<IndexPair> pairs;
  for (const Match& match : rows_.candidates(rows_of(reference.features.descriptors))) {
    pairs.push_back({match.query, match.reference});
  }
  return pairs;
}

std::optional<PairAlignment> ContenderMatcher::align(const ArenaScan& reference) {
  if (matcher_ == ArenaMatcher::ransac) { return pairs_.align(reference.columns()); }
  const PointSets points{query_->points, reference.points};
  const std::vector<IndexPair> pairs = candidates(reference);
  const std::optional<PointAlignment> found = matcher_ == ArenaMatcher::clique
                                                  ? align_by_clique(points, pairs, params_.clique)
                                                  : align_by_votes(points, pairs, params_.hough);
  if (!found) { return std::nullopt; }
  const PairAlignment alignment =
      judged(found->reference_from_query, *query_, reference, params_.ransac.inlier_distance);
  return alignment.inliers < params_.ransac.min_inliers ? std::nullopt : std::optional(alignment);
}

}  // namespace flirt
