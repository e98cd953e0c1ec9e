#include "flirt/map/particles.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>

namespace flirt {
namespace {

Pose2 sampled_motion(const Pose2& before_from_after, const MotionNoise& noise, Rng& rng) {
  const double way = norm(before_from_after.translation());
  const double turn = std::abs(before_from_after.theta);
  const double translation = noise.translation * std::sqrt(way) + noise.still_translation;
  const double rotation = noise.rotation * std::sqrt(turn) + noise.heading * std::sqrt(way) + noise.still_rotation;
  // Half of the heading's error acts before the way, half after it, as if it grew along the way.
  const Pose2 half_turn{0, 0, rng.normal(0, rotation) / 2};
  const double x = rng.normal(before_from_after.x, translation);
  const double y = rng.normal(before_from_after.y, translation);
  return half_turn * Pose2{x, y, before_from_after.theta} * half_turn;
}

Pose2 sampled_rest(const MotionNoise& noise, Rng& rng) {
  const double x = rng.normal(0, noise.blind_translation);
  const double y = rng.normal(0, noise.blind_translation);
  return {x, y, wrap_angle(rng.normal(0, noise.blind_rotation))};
}

Eigen::Vector3d difference(const Pose2& pose, const Pose2& from) {
  return {pose.x - from.x, pose.y - from.y, wrap_angle(pose.theta - from.theta)};
}

bool is_within(const Pose2& pose, const Pose2& center, double reach, double turn) {
  return distance(pose, center) <= reach && heading_difference(pose, center) <= turn;
}

/// The chosen particles' mean, spread and weight; headings must lie within a half turn of `near`.
TrackCluster moments(std::span<const Particle> particles, std::span<const std::size_t> chosen, const Pose2& near) {
  TrackCluster cluster;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::size_t i : chosen) {
    sum += particles[i].weight * difference(particles[i].map_from_robot, near);
    cluster.share += particles[i].weight;
  }
  const Eigen::Vector3d mean = sum / std::max(cluster.share, 1e-300);
  cluster.map_from_robot = {near.x + mean[0], near.y + mean[1], wrap_angle(near.theta + mean[2])};
  for (const std::size_t i : chosen) {
    const Eigen::Vector3d apart = difference(particles[i].map_from_robot, cluster.map_from_robot);
    cluster.covariance += particles[i].weight / std::max(cluster.share, 1e-300) * apart * apart.transpose();
  }
  return cluster;
}

using ParticleBin = std::array<std::int64_t, 3>;

/// The bins of the heading, of about `turn`, make a whole turn: the last meets the first. They are even in number, so
/// that half a turn, where the angle jumps, is in the middle of one.
ParticleBin bin_of(const Pose2& pose, double reach, double turn) {
  const std::int64_t headings = 2 * std::max<std::int64_t>(1, std::llround(std::numbers::pi / turn));
  const std::int64_t heading = std::llround(pose.theta / (2 * std::numbers::pi) * static_cast<double>(headings));
  return {std::llround(pose.x / reach), std::llround(pose.y / reach), (heading % headings + headings) % headings};
}

/// The heaviest particle of the heaviest bin among those left.
std::size_t densest(std::span<const Particle> particles, std::span<const std::size_t> left, double reach, double turn) {
  struct Heap {
    double weight{0};
    std::size_t heaviest{0};
  };
  std::map<ParticleBin, Heap> heaps;
  for (const std::size_t i : left) {
    Heap& heap = heaps[bin_of(particles[i].map_from_robot, reach, turn)];
    if (heap.weight == 0 || particles[i].weight > particles[heap.heaviest].weight) { heap.heaviest = i; }
    heap.weight += particles[i].weight;
  }
  return std::ranges::max_element(heaps, {}, [](const auto& entry) { return entry.second.weight; })->second.heaviest;
}

}  // namespace

void move_particles(std::vector<Particle>& particles, const std::optional<Pose2>& before_from_after,
                    const MotionNoise& noise, Rng& rng) {
  for (Particle& particle : particles) {
    particle.map_from_robot =
        particle.map_from_robot *
        (before_from_after ? sampled_motion(*before_from_after, noise, rng) : sampled_rest(noise, rng));
  }
}

void weigh(std::vector<Particle>& particles, double odds) {
  if (particles.empty()) { return; }
  const double best = std::ranges::max(particles, {}, &Particle::score).score;
  double sum = 0;
  for (Particle& particle : particles) {
    particle.weight *= std::exp(odds * (particle.score - best));
    sum += particle.weight;
  }
  for (Particle& particle : particles) {
    particle.weight = sum > 0 ? particle.weight / sum : 1.0 / static_cast<double>(particles.size());
  }
}

double effective_count(std::span<const Particle> particles) {
  double squares = 0;
  for (const Particle& particle : particles) { squares += particle.weight * particle.weight; }
  return squares > 0 ? 1 / squares : 0.0;
}

std::size_t kld_count(std::span<const Particle> particles, double reach, double turn, double error, double quantile) {
  std::set<ParticleBin> bins;
  for (const Particle& particle : particles) { bins.insert(bin_of(particle.map_from_robot, reach, turn)); }
  if (bins.size() < 2) { return bins.size(); }
  const auto free = static_cast<double>(bins.size() - 1);
  const double part = 2 / (9 * free);
  return static_cast<std::size_t>(free / (2 * error) * std::pow(1 - part + std::sqrt(part) * quantile, 3)) + 1;
}

std::vector<Particle> resampled(std::span<const Particle> particles, std::size_t count, Rng& rng) {
  std::vector<Particle> drawn;
  if (particles.empty()) { return drawn; }
  drawn.reserve(count);
  const double step = 1.0 / static_cast<double>(count);
  const double start = rng.uniform() * step;
  std::size_t i = 0;
  double passed = particles[0].weight;
  for (std::size_t k = 0; k < count; ++k) {
    const double target = start + static_cast<double>(k) * step;
    while (passed < target && i + 1 < particles.size()) { passed += particles[++i].weight; }
    drawn.push_back({.map_from_robot = particles[i].map_from_robot, .weight = step, .score = particles[i].score});
  }
  return drawn;
}

std::vector<Particle> drawn_from(std::span<const PoseHypothesis> hypotheses, const Pose2& robot_from_sensor,
                                 std::size_t count, double floor_distance, double floor_heading, Rng& rng) {
  std::vector<Particle> centers;
  centers.reserve(hypotheses.size());
  std::vector<Eigen::Matrix3d> roots;
  const Eigen::Vector3d floor{floor_distance * floor_distance, floor_distance * floor_distance,
                              floor_heading * floor_heading};
  for (const PoseHypothesis& hypothesis : hypotheses) {
    // The score carries the hypothesis' number through the drawing.
    centers.push_back({.map_from_robot = hypothesis.map_from_sensor,
                       .weight = hypothesis.weight,
                       .score = static_cast<double>(roots.size())});
    const Eigen::Matrix3d spread = hypothesis.covariance + Eigen::Matrix3d(floor.asDiagonal());
    roots.emplace_back(spread.llt().matrixL());
  }
  std::vector<Particle> drawn = resampled(centers, count, rng);
  for (Particle& particle : drawn) {
    const double x = rng.normal();
    const double y = rng.normal();
    const Eigen::Vector3d offset =
        roots[static_cast<std::size_t>(particle.score)] * Eigen::Vector3d(x, y, rng.normal());
    const Pose2& center = particle.map_from_robot;
    const Pose2 map_from_sensor{center.x + offset[0], center.y + offset[1], wrap_angle(center.theta + offset[2])};
    particle = {.map_from_robot = map_from_sensor * inverse(robot_from_sensor), .weight = particle.weight};
  }
  return drawn;
}

std::vector<Particle> spread_out(const MapFields& fields, const Pose2& robot_from_sensor, std::size_t count, Rng& rng) {
  std::vector<CellIndex> cells;
  for (const auto& field : fields.coarse) {
    for (std::int32_t y = 0; y < field->height; ++y) {
      for (std::int32_t x = 0; x < field->width; ++x) {
        if (field->standable.at(x, y) != 0) { cells.push_back({field->first.x + x, field->first.y + y}); }
      }
    }
  }
  std::vector<Particle> drawn;
  if (cells.empty()) { return drawn; }
  drawn.reserve(count);
  const double size = fields.coarse.front()->cell_size;
  for (std::size_t k = 0; k < count; ++k) {
    const CellIndex cell = cells[rng.below(static_cast<std::uint32_t>(cells.size()))];
    const double x = fields.origin.x + (cell.x + rng.uniform()) * size;
    const double y = fields.origin.y + (cell.y + rng.uniform()) * size;
    const Pose2 map_from_sensor{x, y, rng.uniform(-std::numbers::pi, std::numbers::pi)};
    drawn.push_back(
        {.map_from_robot = map_from_sensor * inverse(robot_from_sensor), .weight = 1.0 / static_cast<double>(count)});
  }
  return drawn;
}

std::vector<TrackCluster> clusters_of(std::span<const Particle> particles, double reach, double turn,
                                      std::size_t most) {
  std::vector<std::size_t> left(particles.size());
  for (std::size_t i = 0; i < left.size(); ++i) { left[i] = i; }
  std::vector<TrackCluster> clusters;
  while (!left.empty() && clusters.size() < most) {
    Pose2 center = particles[densest(particles, left, reach, turn)].map_from_robot;
    std::vector<std::size_t> inside;
    for (int round = 0; round < 2; ++round) {  // the second time around the mean of the first
      inside.clear();
      for (const std::size_t i : left) {
        if (is_within(particles[i].map_from_robot, center, reach, turn)) { inside.push_back(i); }
      }
      if (inside.empty()) { break; }
      if (round == 0) { center = moments(particles, inside, center).map_from_robot; }
    }
    if (inside.empty()) { break; }
    clusters.push_back(moments(particles, inside, center));
    std::erase_if(left, [&](std::size_t i) { return is_within(particles[i].map_from_robot, center, reach, turn); });
  }
  std::ranges::stable_sort(clusters, std::ranges::greater{}, &TrackCluster::share);
  return clusters;
}

}  // namespace flirt
