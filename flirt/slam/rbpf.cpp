#include "flirt/slam/rbpf.hpp"

#include "flirt/core/parallel.hpp"
#include "flirt/slam/rbpf_resampling.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

namespace flirt {

/// A scan's end points in the robot's frame.
struct Rbpf::Points {
  Point2 sensor{};
  std::vector<Point2> ends{};      ///< all, for the maps
  std::vector<Point2> compared{};  ///< thinned to even spacing, for matching

  Points(const Scan& scan, const RbpfParams& params) : sensor(scan.robot_from_sensor.translation()) {
    for (const BeamPoint& hit : hit_points(scan)) {
      if (norm(hit.point) > params.range_max) { continue; }
      ends.push_back(scan.robot_from_sensor * hit.point);
      if (compared.empty() || norm(ends.back() - compared.back()) >= params.point_spacing) {
        compared.push_back(ends.back());
      }
    }
    const std::size_t most = params.most_points;
    if (compared.size() <= most) { return; }
    for (std::size_t i = 0; i < most; ++i) { compared[i] = compared[i * compared.size() / most]; }
    compared.resize(most);
  }
};

Rbpf::Rbpf(const RbpfParams& params, std::uint64_t seed, std::size_t threads)
    : params_(params), seed_(seed), threads_(threads), rng_(seed) {}

void Rbpf::add(const Scan& scan) {
  const bool has_odometry =
      params_.odometry == OdometryUse::use && scan.odom_from_robot && is_finite(*scan.odom_from_robot);
  const std::optional<Pose2> odometry = has_odometry ? scan.odom_from_robot : std::nullopt;
  std::optional<Pose2> motion;
  if (odometry && updated_odometry_) { motion = inverse(*updated_odometry_) * *odometry; }
  ++summary_.scans;
  const bool stood =
      motion && norm(motion->translation()) < params_.update_travel && std::abs(motion->theta) < params_.update_turn;
  if (!particles_.empty() && stood) {
    placed_.push_back({summary_.updates - 1, *motion});
    return;
  }
  const Points points(scan, params_);
  if (particles_.empty()) {
    begin(points);
  } else {
    update(points, motion);
  }
  updated_odometry_ = odometry;
  placed_.push_back({summary_.updates, {}});
  ++summary_.updates;
}

void Rbpf::begin(const Points& points) {
  const Pose2 start{params_.start_x, params_.start_y, wrap_angle(params_.start_theta)};
  Particle first{.map = RbpfMap(params_.cell_size), .map_from_robot = start};
  first.map.add(points.sensor, points.ends, start);
  nodes_.push_back({0, start});
  particles_.assign(params_.particles, first);
}

/// Draws the particle's next pose and puts the scan into its map.
void Rbpf::move(Particle& particle, std::size_t index, const Points& points, const std::optional<Pose2>& motion) const {
  Rng rng(seed_, summary_.updates * params_.particles + index);
  const MotionBelief belief = motion ? belief_from_odometry(particle.map_from_robot, *motion, params_)
                                     : belief_from_last_motion(particle.map_from_robot, particle.last_motion, params_);
  const Proposal next = propose(particle.map, points.compared, belief, params_, rng);
  particle.last_motion = inverse(particle.map_from_robot) * next.map_from_robot;
  particle.map_from_robot = next.map_from_robot;
  particle.log_weight += params_.weight_smoothing * next.log_weight;
  particle.log_history += params_.weight_smoothing * next.log_weight;
  particle.matched = next.matched;
}

void Rbpf::update(const Points& points, const std::optional<Pose2>& motion) {
  parallel_for(particles_.size(), threads_,
               [&](std::size_t i, std::size_t /*thread*/) { move(particles_[i], i, points, motion); });
  for (Particle& particle : particles_) {
    nodes_.push_back({particle.node, particle.map_from_robot});
    particle.node = static_cast<std::uint32_t>(nodes_.size() - 1);
  }
  summary_.unmatched += particles_[best()].matched ? 0 : 1;
  resample_if_needed();
  parallel_for(particles_.size(), threads_, [&](std::size_t i, std::size_t /*thread*/) {
    particles_[i].map.add(points.sensor, points.ends, particles_[i].map_from_robot);
  });
}

/// Only when the weights have become uneven: each resampling may lose the right particle (section V).
void Rbpf::resample_if_needed() {
  std::vector<double> log_weights;
  log_weights.reserve(particles_.size());
  for (const Particle& particle : particles_) { log_weights.push_back(particle.log_weight); }
  const std::vector<double> weights = normalized_weights(log_weights);
  const double n = static_cast<double>(particles_.size());
  if (effective_particles(weights) >= params_.resample_share * n) { return; }
  std::vector<Particle> drawn;
  drawn.reserve(particles_.size());
  for (const std::size_t parent : low_variance_draw(weights, rng_.uniform())) { drawn.push_back(particles_[parent]); }
  for (Particle& particle : drawn) { particle.log_weight = 0; }
  particles_ = std::move(drawn);
  ++summary_.resamplings;
}

std::size_t Rbpf::best() const {
  const auto found = std::ranges::max_element(particles_, {}, &Particle::log_history);
  return static_cast<std::size_t>(found - particles_.begin());
}

std::vector<Pose2> Rbpf::trajectory() const {
  std::vector<Pose2> poses;
  if (particles_.empty()) { return poses; }
  std::vector<Pose2> updated(summary_.updates);
  std::uint32_t node = particles_[best()].node;
  for (std::size_t i = updated.size(); i-- > 0; node = nodes_[node].before) {
    updated[i] = nodes_[node].map_from_robot;
  }
  poses.reserve(placed_.size());
  for (const Placed& placed : placed_) { poses.push_back(updated[placed.update] * placed.updated_from_robot); }
  return poses;
}

RbpfSummary Rbpf::summary() const {
  RbpfSummary summary = summary_;
  std::unordered_set<const RbpfMap::Tile*> tiles;
  for (const Particle& particle : particles_) {
    for (const RbpfMap::Tile* tile : particle.map.tiles()) { tiles.insert(tile); }
  }
  summary.map_bytes = tiles.size() * sizeof(RbpfMap::Tile);
  return summary;
}

}  // namespace flirt
