#include "flirt/slam/rbpf_proposal.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace flirt {
namespace {

/// log p(scan | map, pose) + log p(pose | motion).
double log_posterior(const RbpfMap& map, std::span<const Point2> points, const MotionBelief& belief, const Pose2& pose,
                     const RbpfParams& params) {
  return agreement(map, points, pose, params).log_likelihood + log_motion(belief, pose);
}

/// A pose of the samples with its log posterior.
struct Sample {
  Eigen::Vector3d off{Eigen::Vector3d::Zero()};  ///< from the best pose, in its frame: m, m, rad
  double log_value{0};
};

std::vector<Sample> draw_samples(const RbpfMap& map, std::span<const Point2> points, const MotionBelief& belief,
                                 const Pose2& best, const RbpfParams& params, Rng& rng) {
  std::vector<Sample> samples(params.samples);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > 0) {
      samples[i].off = {rng.uniform(-1, 1) * params.sample_translation, rng.uniform(-1, 1) * params.sample_translation,
                        rng.uniform(-1, 1) * params.sample_rotation};
    }
    const Pose2 pose = best * Pose2{samples[i].off.x(), samples[i].off.y(), samples[i].off.z()};
    samples[i].log_value = log_posterior(map, points, belief, pose, params);
  }
  return samples;
}

/// The Gaussian of the samples (equations 16 to 18) and the log of their mean value (19).
struct Fitted {
  Eigen::Vector3d mean{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};
  double log_mean_value{0};
};

Fitted fit_gaussian(std::span<const Sample> samples) {
  const double top = std::ranges::max(samples, {}, &Sample::log_value).log_value;
  Fitted fitted;
  double sum = 0;
  for (const Sample& sample : samples) {
    const double value = std::exp(sample.log_value - top);
    sum += value;
    fitted.mean += value * sample.off;
  }
  fitted.mean /= sum;
  for (const Sample& sample : samples) {
    const Eigen::Vector3d off = sample.off - fitted.mean;
    fitted.covariance += std::exp(sample.log_value - top) / sum * off * off.transpose();
  }
  fitted.log_mean_value = top + std::log(sum / static_cast<double>(samples.size()));
  return fitted;
}

Eigen::Vector3d draw(const Fitted& fitted, Rng& rng) {
  // Keeps the root defined when one sample holds all the weight.
  const Eigen::Matrix3d least = Eigen::Vector3d(1e-8, 1e-8, 1e-9).asDiagonal();
  const Eigen::LLT<Eigen::Matrix3d> root(fitted.covariance + least);
  const double x = rng.normal();
  const double y = rng.normal();
  const double theta = rng.normal();
  return fitted.mean + root.matrixL() * Eigen::Vector3d(x, y, theta);
}

Pose2 draw(const MotionBelief& belief, Rng& rng) {
  const double x = belief.way_deviation * rng.normal();
  const double y = belief.way_deviation * rng.normal();
  return belief.map_from_robot * Pose2{x, y, belief.turn_deviation * rng.normal()};
}

}  // namespace

MotionBelief belief_from_odometry(const Pose2& map_from_robot, const Pose2& motion, const RbpfParams& params) {
  const double way = norm(motion.translation());
  const double turn = std::abs(motion.theta);
  return {map_from_robot * motion, std::hypot(params.way_per_way * way, params.way_per_turn * turn, params.way_floor),
          std::hypot(params.turn_per_turn * turn, params.turn_per_way * way, params.turn_floor)};
}

MotionBelief belief_from_last_motion(const Pose2& map_from_robot, const Pose2& motion, const RbpfParams& params) {
  return {map_from_robot * motion, params.blind_way, params.blind_turn};
}

double log_motion(const MotionBelief& belief, const Pose2& map_from_robot) {
  constexpr double freedom = 3;
  const double way = distance(belief.map_from_robot, map_from_robot) / belief.way_deviation;
  const double turn = wrap_angle(map_from_robot.theta - belief.map_from_robot.theta) / belief.turn_deviation;
  return -0.5 * (freedom + 3) * std::log1p((way * way + turn * turn) / freedom);
}

ScanAgreement agreement(const RbpfMap& map, std::span<const Point2> points_in_robot, const Pose2& map_from_robot,
                        const RbpfParams& params) {
  if (points_in_robot.empty()) { return {}; }
  const double free_miss = params.free_miss * params.free_miss;
  const double unknown_miss = params.unknown_miss * params.unknown_miss;
  const double c = std::cos(map_from_robot.theta);
  const double s = std::sin(map_from_robot.theta);
  double squares = 0;
  std::size_t near = 0;
  for (const Point2 p : points_in_robot) {
    const double squared =
        map.squared_distance({map_from_robot.x + c * p.x - s * p.y, map_from_robot.y + s * p.x + c * p.y});
    near += squared >= 0 ? 1 : 0;
    squares += squared >= 0                       ? std::min(squared, unknown_miss)
               : squared == RbpfMap::nothing_near ? free_miss
                                                  : unknown_miss;
  }
  const auto n = static_cast<double>(points_in_robot.size());
  const double worth = std::min(n, params.points_worth);
  return {-worth * squares / n / (2 * params.sigma * params.sigma), static_cast<double>(near) / n};
}

Pose2 climb(const RbpfMap& map, std::span<const Point2> points_in_robot, const Pose2& start, const MotionBelief& belief,
            const RbpfParams& params) {
  Pose2 best = start;
  double value = log_posterior(map, points_in_robot, belief, best, params);
  // Where little is known of the motion the first steps are as wide as that.
  double way = std::max(params.step_translation, 0.5 * belief.way_deviation);
  double turn = std::max(params.step_rotation, 0.5 * belief.turn_deviation);
  while (way > params.step_translation * std::exp2(-static_cast<double>(params.step_halvings))) {
    const Pose2 from = best;
    const std::array<Pose2, 6> steps{
        {{way, 0, 0}, {-way, 0, 0}, {0, way, 0}, {0, -way, 0}, {0, 0, turn}, {0, 0, -turn}}};
    for (const Pose2& step : steps) {
      const Pose2 pose = from * step;
      const double there = log_posterior(map, points_in_robot, belief, pose, params);
      if (there <= value) { continue; }
      value = there;
      best = pose;
    }
    if (best == from) {
      way *= 0.5;
      turn *= 0.5;
    }
  }
  return best;
}

namespace {

/// The climb's end; where that explains little of the scan, the best of climbs from poses drawn from the motion, each
/// particle's own: what all of them missed from one start, some find from theirs.
Pose2 best_pose(const RbpfMap& map, std::span<const Point2> points, const MotionBelief& belief,
                const RbpfParams& params, Rng& rng) {
  constexpr double widened = 2;  // odometry that misled the first climb is worse than its deviations say
  Pose2 best = climb(map, points, belief.map_from_robot, belief, params);
  if (agreement(map, points, best, params).near >= params.doubt_share) { return best; }
  const MotionBelief wide{belief.map_from_robot, widened * belief.way_deviation, widened * belief.turn_deviation};
  double value = log_posterior(map, points, belief, best, params);
  for (std::uint32_t i = 0; i < params.doubt_starts; ++i) {
    const Pose2 pose = climb(map, points, draw(wide, rng), belief, params);
    const double there = log_posterior(map, points, belief, pose, params);
    if (there <= value) { continue; }
    value = there;
    best = pose;
  }
  return best;
}

}  // namespace

Proposal propose(const RbpfMap& map, std::span<const Point2> points_in_robot, const MotionBelief& belief,
                 const RbpfParams& params, Rng& rng) {
  const Pose2 best = best_pose(map, points_in_robot, belief, params, rng);
  const ScanAgreement found = agreement(map, points_in_robot, best, params);
  if (points_in_robot.empty() || found.near < params.lost_share) {
    const Pose2 pose = draw(belief, rng);
    return {pose, agreement(map, points_in_robot, pose, params).log_likelihood, false};
  }
  const std::vector<Sample> samples = draw_samples(map, points_in_robot, belief, best, params, rng);
  const Fitted fitted = fit_gaussian(samples);
  const Eigen::Vector3d off = draw(fitted, rng);
  return {best * Pose2{off.x(), off.y(), off.z()}, fitted.log_mean_value, true};
}

}  // namespace flirt
