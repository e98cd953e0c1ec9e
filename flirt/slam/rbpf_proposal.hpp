// flirt/slam/rbpf_proposal.hpp: where a particle goes next: a Gaussian around the pose that explains the scan best
// (Grisetti, Stachniss and Burgard, IEEE T-RO 2007, section IV and algorithm 1).
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/core/rng.hpp"
#include "flirt/slam/rbpf_map.hpp"
#include "flirt/slam/rbpf_params.hpp"

#include <cstdint>
#include <span>

namespace flirt {

/// What is known of a motion before the scan is looked at: a distribution around a pose, in its frame.
struct MotionBelief {
  Pose2 map_from_robot{};
  double way_deviation{0.1};   ///< m, along and across
  double turn_deviation{0.1};  ///< rad
};

/// Odometry's motion from where the particle was, with the deviations that the motion asks for.
[[nodiscard]] MotionBelief belief_from_odometry(const Pose2& map_from_robot, const Pose2& motion,
                                                const RbpfParams& params);
/// Without odometry: the motion before, once more.
[[nodiscard]] MotionBelief belief_from_last_motion(const Pose2& map_from_robot, const Pose2& motion,
                                                   const RbpfParams& params);

/// log p(pose | motion) without its constant: Student's t with 3 degrees of freedom, since wheels slip.
[[nodiscard]] double log_motion(const MotionBelief& belief, const Pose2& map_from_robot);

/// How a scan agrees with a map: log p(scan | map, pose), by the distances of its end points from occupied cells.
struct ScanAgreement {
  double log_likelihood{0};
  double near{0};  ///< share of the points with something occupied near them
};
/// O(points).
[[nodiscard]] ScanAgreement agreement(const RbpfMap& map, std::span<const Point2> points_in_robot,
                                      const Pose2& map_from_robot, const RbpfParams& params);

/// The pose at the top of likelihood times motion that steps to six sides lead to from `start`, each halved when none
/// leads up.
[[nodiscard]] Pose2 climb(const RbpfMap& map, std::span<const Point2> points_in_robot, const Pose2& start,
                          const MotionBelief& belief, const RbpfParams& params);

/// A pose drawn for a particle, and by what its weight grows.
struct Proposal {
  Pose2 map_from_robot{};
  double log_weight{0};
  bool matched{true};  ///< else drawn from the motion alone
};
/// Equations 14 to 19 of the paper. O(points · (climb + samples)).
[[nodiscard]] Proposal propose(const RbpfMap& map, std::span<const Point2> points_in_robot, const MotionBelief& belief,
                               const RbpfParams& params, Rng& rng);

}  // namespace flirt
