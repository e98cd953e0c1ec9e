#include "flirt/slam/constraint_match.hpp"

#include "flirt/match/verify.hpp"
#include "flirt/registration/surface_alignment.hpp"

#include <algorithm>

namespace flirt {
namespace {

RansacParams ransac_params(const FlirtParams& params) {
  RansacParams ransac = params.ransac;
  ransac.min_inliers = params.min_inliers + 1;
  return ransac;
}

double mean_squared_distance(std::span<const IndexPair> inliers, const KeypointColumns& query,
                             const KeypointColumns& reference, const Pose2& reference_from_query) {
  double sum = 0;
  for (const IndexPair& pair : inliers) {
    const Point2 at = reference_from_query * Point2{query.x[pair.query], query.y[pair.query]};
    sum += squared_norm(at - Point2{reference.x[pair.reference], reference.y[pair.reference]});
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, inliers.size()));
}

/// Median distance of the query's points from the lines of the reference, m; the largest distance compared when more of
/// them lie where the reference saw free space. Nothing when a smaller share than `min_comparable` can be compared.
std::optional<double> reprojection_error(const Verification& verified, double min_comparable) {
  const double compared = verified.line_points + verified.free_points;
  if (verified.line_points == 0 || compared < min_comparable * verified.query_points) { return std::nullopt; }
  return verified.free_points > verified.line_points ? VerifyParams{}.line_distance : verified.median_line_residual;
}

}  // namespace

ConstraintMatcher::ConstraintMatcher(const FlirtParams& params)
    : params_(params), matcher_(MatchParams{}, ransac_params(params)) {}

void ConstraintMatcher::set_query(const SlamScan& query) {
  query_ = &query;
  matcher_.set_query(query.columns());
}

std::optional<ConstraintMatch> ConstraintMatcher::match(const SlamScan& earlier) {
  const FeatureColumns reference = earlier.columns();
  const FeatureColumns query = query_->columns();
  if (reference.keypoints.size() <= params_.min_inliers || query.keypoints.size() <= params_.min_inliers) {
    return std::nullopt;
  }
  const std::optional<PairAlignment> found = matcher_.align(reference);
  if (!found || found->inliers <= params_.min_inliers) { return std::nullopt; }
  const double error =
      mean_squared_distance(matcher_.inliers(), query.keypoints, reference.keypoints, found->reference_from_query);
  if (error >= params_.max_inlier_error) { return std::nullopt; }
  const Pose2& robot_from_sensor = query_->scan.robot_from_sensor;
  return ConstraintMatch{earlier.scan.robot_from_sensor * found->reference_from_query * inverse(robot_from_sensor),
                         robot_information(matcher_.covariance(), found->reference_from_query, robot_from_sensor),
                         found->inliers, error};
}

ConstraintMatch ConstraintMatcher::refined(const SlamScan& earlier, const ConstraintMatch& found) const {
  constexpr double range_sigma = 0.03;  // m
  if (params_.refinement == FlirtRefinement::off) { return found; }
  const AlignedPose aligned = align_to_scan(earlier.points, query_->points, found.earlier_from_robot,
                                            {found.earlier_from_robot, Eigen::Vector3d(2, 2, 2).asDiagonal()});
  ConstraintMatch drawn = found;
  drawn.earlier_from_robot = aligned.map_from_robot;
  drawn.information = edge_information(aligned.terms.information, range_sigma, Eigen::Matrix3d::Identity());
  return drawn;
}

std::optional<ConstraintMatch> ConstraintMatcher::verified(const SlamScan& earlier, ConstraintMatch found) const {
  const Pose2 reference_from_query =
      inverse(earlier.scan.robot_from_sensor) * found.earlier_from_robot * query_->scan.robot_from_sensor;
  const auto error = [&](const Scan& query, const Scan& reference, const Pose2& motion) {
    return reprojection_error(verify(query, reference, motion), params_.min_comparable);
  };
  const auto there = error(query_->scan, earlier.scan, reference_from_query);
  const auto back = error(earlier.scan, query_->scan, inverse(reference_from_query));
  if (!there || !back) { return std::nullopt; }
  found.scan_error = std::max(*there, *back);
  if (found.scan_error >= params_.max_scan_error) { return std::nullopt; }
  return found;
}

}  // namespace flirt
