// flirt/eval/trajectory_metrics.hpp: how far an estimated trajectory is from the truth. Translations in m, rotations in
// rad unless the name says degrees.
//
//   const std::vector<PosePair> pairs = pairs_by_stamp(estimate, truth).pairs;
//   const TrajectoryError ate = absolute_error(pairs);                  // evo_ape -a
//   const TrajectoryError rpe = relative_error(pairs, 1.0);             // evo_rpe --delta 1 --delta_unit m --all_pairs
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/core/stamped_pose.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace flirt {

/// The same moment in both trajectories.
struct PosePair {
  double stamp{0};  ///< s, of the estimate
  Pose2 estimate{};
  Pose2 truth{};
};

struct PairedTrajectory {
  std::vector<PosePair> pairs{};  ///< in order of the estimate
  std::size_t skipped{0};         ///< poses of the estimate without a partner
};
/// Pairs each pose of the estimate with the pose of the truth whose stamp is nearest and within `tolerance` s. A true
/// pose has one partner at most; where stamps repeat, poses pair in their order. O((n + m) log m) for distinct stamps.
[[nodiscard]] PairedTrajectory pairs_by_stamp(std::span<const StampedPose> estimate, std::span<const StampedPose> truth,
                                              double tolerance = 0.0005);

/// The trajectory's pose of each scan of a log, paired by stamps as above; nothing where it has none.
[[nodiscard]] std::vector<std::optional<Pose2>> poses_of_scans(const ScanLog& log,
                                                               std::span<const StampedPose> trajectory,
                                                               double tolerance = 0.0005);

/// truth_from_estimate of least Σ |truth − truth_from_estimate · estimate|² over positions (Umeyama 1991 without
/// scale). When all positions of a side coincide no rotation is better than another: then the one that matches the
/// first headings. Identity for no pairs.
[[nodiscard]] Pose2 align_trajectories(std::span<const PosePair> pairs);

struct ErrorSummary {
  std::size_t count{0};
  double rmse{0};
  double mean{0};
  double deviation{0};  ///< sample standard deviation (n − 1); 0 for fewer than two
  double median{0};
  double max{0};
};
[[nodiscard]] ErrorSummary summarize_errors(std::span<const double> errors);

struct TrajectoryError {
  ErrorSummary translation{};       ///< m
  ErrorSummary rotation_degrees{};  ///< absolute heading errors
};

/// Absolute trajectory error after align_trajectories.
[[nodiscard]] TrajectoryError absolute_error(std::span<const PosePair> pairs);

/// Relative pose error: for each pose i the later pose j that is nearest to `path` m further on the estimate's way, if
/// that is within a tenth of `path`; error = inverse(truth's motion i to j) * estimate's motion, not divided by `path`.
[[nodiscard]] TrajectoryError relative_error(std::span<const PosePair> pairs, double path = 1.0);

/// What a relation says: the second pose as seen from the first (Kümmerle et al. 2009).
struct Relation {
  double first_stamp{0};   ///< s
  double second_stamp{0};  ///< s
  Pose2 first_from_second{};
};

/// Two readings of the error between the relative pose that was found and the one expected; the turn is the same.
struct RelationsError {
  std::size_t skipped{0};        ///< relations of which a stamp has no pose
  TrajectoryError difference{};  ///< found − expected, component by component
  TrajectoryError motion{};      ///< found * inverse(expected): a wrong turn also counts by its lever arm
};
/// Poses at the relations' stamps: the nearest of the trajectory within `tolerance` s. O((n + relations) log n).
[[nodiscard]] RelationsError relations_error(std::span<const StampedPose> estimate, std::span<const Relation> relations,
                                             double tolerance = 0.0005);

/// *Derived* relations, where there are no official ones: all consecutive poses of the truth, and as many random pairs
/// of poses within `reach` m. Equal seeds give equal relations.
[[nodiscard]] std::vector<Relation> derive_relations(std::span<const StampedPose> truth, std::uint64_t seed,
                                                     double reach = 10.0);

}  // namespace flirt
