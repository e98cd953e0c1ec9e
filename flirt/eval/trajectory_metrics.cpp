#include "flirt/eval/trajectory_metrics.hpp"

#include "flirt/core/rng.hpp"
#include "flirt/eval/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace flirt {
namespace {

/// Poses by their stamp, for look-ups of the nearest.
class StampIndex {
 public:
  explicit StampIndex(std::span<const StampedPose> poses) : poses_(poses), by_stamp_(poses.size()) {
    std::iota(by_stamp_.begin(), by_stamp_.end(), std::size_t{0});
    std::sort(by_stamp_.begin(), by_stamp_.end(), [&](std::size_t a, std::size_t b) {
      return poses[a].stamp != poses[b].stamp ? poses[a].stamp < poses[b].stamp : a < b;
    });
  }
  /// Number `k`, from 0, of the poses with the stamp of pose i, in order of the trajectory.
  [[nodiscard]] std::optional<std::size_t> of_equals(std::size_t i, std::size_t k) const {
    const auto first = at_or_after(poses_[i].stamp);
    if (k >= static_cast<std::size_t>(by_stamp_.end() - first)) { return std::nullopt; }
    const std::size_t found = *(first + static_cast<std::ptrdiff_t>(k));
    return poses_[found].stamp == poses_[i].stamp ? std::optional(found) : std::nullopt;
  }
  /// Index of the nearest pose within `tolerance`, of equals the first in order of the trajectory.
  [[nodiscard]] std::optional<std::size_t> nearest(double stamp, double tolerance) const {
    std::optional<std::size_t> best;
    const auto offer = [&](std::size_t i) {
      const double gap = std::abs(poses_[i].stamp - stamp);
      if (gap <= tolerance && (!best || gap < std::abs(poses_[*best].stamp - stamp))) { best = i; }
    };
    const auto after = at_or_after(stamp);
    if (after != by_stamp_.begin()) { offer(*at_or_after(poses_[*(after - 1)].stamp)); }
    if (after != by_stamp_.end()) { offer(*after); }
    return best;
  }

 private:
  [[nodiscard]] std::vector<std::size_t>::const_iterator at_or_after(double stamp) const {
    return std::lower_bound(by_stamp_.begin(), by_stamp_.end(), stamp,
                            [&](std::size_t i, double value) { return poses_[i].stamp < value; });
  }
  std::span<const StampedPose> poses_;
  std::vector<std::size_t> by_stamp_;
};

/// Poses of a trajectory, each given away once.
class Partners {
 public:
  explicit Partners(std::span<const StampedPose> poses) : poses_(poses), index_(poses), given_(poses.size(), 0) {}

  /// The nearest within `tolerance`; where stamps repeat, the next in order.
  std::optional<Pose2> take(double stamp, double tolerance) {
    const std::optional<std::size_t> first = index_.nearest(stamp, tolerance);
    if (!first) { return std::nullopt; }
    const std::optional<std::size_t> partner = index_.of_equals(*first, given_[*first]);
    if (!partner) { return std::nullopt; }
    ++given_[*first];
    return poses_[*partner].map_from_robot;
  }

 private:
  std::span<const StampedPose> poses_;
  StampIndex index_;
  std::vector<std::size_t> given_;  ///< by the first of the poses with a stamp: how many of them
};

/// Translations and turns that become a TrajectoryError.
struct Errors {
  std::vector<double> translation{};
  std::vector<double> degrees{};

  void add(double meters, double radians) {
    translation.push_back(meters);
    degrees.push_back(degrees_from_radians(std::abs(wrap_angle(radians))));
  }
  void add(const Pose2& error) { add(norm(error.translation()), error.theta); }
  [[nodiscard]] TrajectoryError summary() const { return {summarize_errors(translation), summarize_errors(degrees)}; }
};

/// Length of the estimate's way up to each pose.
std::vector<double> way_of(std::span<const PosePair> pairs) {
  std::vector<double> way(pairs.size(), 0.0);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    way[i] = way[i - 1] + distance(pairs[i].estimate, pairs[i - 1].estimate);
  }
  return way;
}

/// The pose after i whose way is nearest to `target`, of equals the first.
std::size_t nearest_after(const std::vector<double>& way, std::size_t i, double target) {
  const auto first = way.begin() + static_cast<std::ptrdiff_t>(i + 1);
  auto found = std::lower_bound(first, way.end(), target);
  const bool is_before_nearer = found != first && (found == way.end() || target - *(found - 1) <= *found - target);
  if (is_before_nearer) { found = std::lower_bound(first, way.end(), *(found - 1)); }
  return static_cast<std::size_t>(found - way.begin());
}

}  // namespace

PairedTrajectory pairs_by_stamp(std::span<const StampedPose> estimate, std::span<const StampedPose> truth,
                                double tolerance) {
  Partners partners(truth);
  PairedTrajectory paired;
  for (const auto& [stamp, pose] : estimate) {
    if (const std::optional<Pose2> partner = partners.take(stamp, tolerance)) {
      paired.pairs.push_back({stamp, pose, *partner});
    } else {
      ++paired.skipped;
    }
  }
  return paired;
}

std::vector<std::optional<Pose2>> poses_of_scans(const ScanLog& log, std::span<const StampedPose> trajectory,
                                                 double tolerance) {
  Partners partners(trajectory);
  std::vector<std::optional<Pose2>> poses;
  poses.reserve(log.scans.size());
  for (const Scan& scan : log.scans) { poses.push_back(partners.take(scan.stamp, tolerance)); }
  return poses;
}

Pose2 align_trajectories(std::span<const PosePair> pairs) {
  if (pairs.empty()) { return {}; }
  Point2 estimate_mean;
  Point2 truth_mean;
  const double share = 1.0 / static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    estimate_mean = estimate_mean + share * pair.estimate.translation();
    truth_mean = truth_mean + share * pair.truth.translation();
  }
  double dots = 0;
  double crosses = 0;
  double spread = 0;  // m², on both sides
  for (const PosePair& pair : pairs) {
    const Point2 estimate = pair.estimate.translation() - estimate_mean;
    const Point2 truth = pair.truth.translation() - truth_mean;
    dots += dot(estimate, truth);
    crosses += cross(estimate, truth);
    spread += norm(estimate) * norm(truth);
  }
  const bool has_rotation = std::hypot(dots, crosses) > 1e-12 * spread;
  const double theta =
      has_rotation ? std::atan2(crosses, dots) : wrap_angle(pairs.front().truth.theta - pairs.front().estimate.theta);
  const Point2 rotated_mean = Pose2{0, 0, theta} * estimate_mean;
  return {truth_mean.x - rotated_mean.x, truth_mean.y - rotated_mean.y, theta};
}

ErrorSummary summarize_errors(std::span<const double> errors) {
  ErrorSummary summary{.count = errors.size()};
  if (errors.empty()) { return summary; }
  const auto n = static_cast<double>(errors.size());
  double squares = 0;
  for (const double error : errors) {
    summary.mean += error / n;
    squares += error * error;
    summary.max = std::max(summary.max, error);
  }
  summary.rmse = std::sqrt(squares / n);
  double spread = 0;
  for (const double error : errors) { spread += (error - summary.mean) * (error - summary.mean); }
  if (errors.size() > 1) { summary.deviation = std::sqrt(spread / (n - 1)); }
  summary.median = quantile(std::vector(errors.begin(), errors.end()), 0.5);
  return summary;
}

TrajectoryError absolute_error(std::span<const PosePair> pairs) {
  const Pose2 truth_from_estimate = align_trajectories(pairs);
  Errors errors;
  for (const PosePair& pair : pairs) { errors.add(inverse(pair.truth) * (truth_from_estimate * pair.estimate)); }
  return errors.summary();
}

TrajectoryError relative_error(std::span<const PosePair> pairs, double path) {
  constexpr double tolerance = 0.1;  // of the path, as evo has it by default
  const std::vector<double> way = way_of(pairs);
  Errors errors;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i) {
    const std::size_t j = nearest_after(way, i, way[i] + path);
    if (std::abs(way[j] - way[i] - path) > tolerance * path) { continue; }
    const Pose2 true_motion = inverse(pairs[i].truth) * pairs[j].truth;
    const Pose2 estimated_motion = inverse(pairs[i].estimate) * pairs[j].estimate;
    errors.add(inverse(true_motion) * estimated_motion);
  }
  return errors.summary();
}

RelationsError relations_error(std::span<const StampedPose> estimate, std::span<const Relation> relations,
                               double tolerance) {
  const StampIndex index(estimate);
  RelationsError result;
  Errors difference;
  Errors motion;
  for (const Relation& relation : relations) {
    const auto first = index.nearest(relation.first_stamp, tolerance);
    const auto second = index.nearest(relation.second_stamp, tolerance);
    if (!first || !second) {
      ++result.skipped;
      continue;
    }
    const Pose2 found = inverse(estimate[*first].map_from_robot) * estimate[*second].map_from_robot;
    const Pose2& expected = relation.first_from_second;
    difference.add(norm(found.translation() - expected.translation()), found.theta - expected.theta);
    motion.add(found * inverse(expected));
  }
  result.difference = difference.summary();
  result.motion = motion.summary();
  return result;
}

std::vector<Relation> derive_relations(std::span<const StampedPose> truth, std::uint64_t seed, double reach) {
  std::vector<Relation> relations;
  const auto relate = [&](const StampedPose& first, const StampedPose& second) {
    relations.push_back({first.stamp, second.stamp, inverse(first.map_from_robot) * second.map_from_robot});
  };
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) { relate(truth[i], truth[i + 1]); }
  const std::size_t consecutive = relations.size();
  Rng rng(seed);
  const auto n = static_cast<std::uint32_t>(truth.size());
  for (std::size_t draws = 0; relations.size() < 2 * consecutive && draws < 1000 * consecutive; ++draws) {
    const StampedPose& first = truth[rng.below(n)];
    const StampedPose& second = truth[rng.below(n)];
    if (&first == &second || distance(first.map_from_robot, second.map_from_robot) > reach) { continue; }
    relate(first, second);
  }
  return relations;
}

}  // namespace flirt
