// flirt/slam/constraint_match.hpp: two scans matched by their keypoints, as algorithm 1 wants it (P1 §3.2, lines 5-7).
#pragma once

#include "flirt/graph/pose_graph.hpp"
#include "flirt/match/pair_matcher.hpp"
#include "flirt/slam/flirt_params.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <cstdint>
#include <optional>

namespace flirt {

/// A motion between two robots' poses that their keypoints agree on.
struct ConstraintMatch {
  Pose2 earlier_from_robot{};
  Eigen::Matrix3d information{Eigen::Matrix3d::Identity()};  ///< as PoseEdge::information
  std::uint32_t inliers{0};
  double inlier_error{0};  ///< m², mean squared distance of the inliers
  double scan_error{0};    ///< m, median distance of each scan's points from the other's lines; the larger of the two
};

/// More inliers first, then smaller error.
[[nodiscard]] inline bool is_better(const ConstraintMatch& a, const ConstraintMatch& b) {
  return a.inliers != b.inliers ? a.inliers > b.inliers : a.inlier_error < b.inlier_error;
}

/// Matches one scan with many others; keeps its workspaces. Not shared between threads.
class ConstraintMatcher {
 public:
  explicit ConstraintMatcher(const FlirtParams& params);

  /// The scan must outlive the calls that follow.
  void set_query(const SlamScan& query);
  /// What passes the gates that keypoints alone decide: inliers, and their mean error; scan_error is not yet known.
  /// O(query · reference) and as Ransac::align.
  [[nodiscard]] std::optional<ConstraintMatch> match(const SlamScan& earlier);
  /// The motion drawn onto the lines of the earlier scan, if the parameters ask for it. O(points · steps).
  [[nodiscard]] ConstraintMatch refined(const SlamScan& earlier, const ConstraintMatch& found) const;
  /// The same motion if the full scans agree with it. O(beams · window).
  [[nodiscard]] std::optional<ConstraintMatch> verified(const SlamScan& earlier, ConstraintMatch found) const;

 private:
  FlirtParams params_;
  PairMatcher matcher_;
  const SlamScan* query_{nullptr};
};

}  // namespace flirt
