// flirt/map/particles.hpp: weighted samples of a robot's pose, and the steps of a particle filter over them.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/core/rng.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/registration/map_fields.hpp"

#include <Eigen/Core>

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace flirt {

struct Particle {
  Pose2 map_from_robot{};
  double weight{0};  ///< all of a set sum to 1
  double score{0};   ///< of the last scan at this pose (EvidenceScore::total)
};

/// What the filter holds of odometry. Deviations are some times those of a fair robot (sim/odometry.hpp), so that slips
/// and floors other than the expected do not lose it.
struct MotionNoise {
  double translation{0.05};        ///< m per √m driven
  double rotation{0.05};           ///< rad per √rad turned
  double heading{0.03};            ///< rad per √m driven
  double still_translation{0.01};  ///< m a step, also when standing
  double still_rotation{0.005};    ///< rad a step, also when standing
  double blind_translation{0.25};  ///< m a step without odometry
  double blind_rotation{0.2};      ///< rad a step without odometry
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, MotionNoise>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.translation, Field{"translation_noise", "m/sqrt(m)", "of the way driven", 0, 10});
  visit(params.rotation, Field{"rotation_noise", "rad/sqrt(rad)", "of turns", 0, 10});
  visit(params.heading, Field{"heading_noise", "rad/sqrt(m)", "of the heading per way driven", 0, 10});
  visit(params.still_translation, Field{"still_translation", "m", "noise a step, also when standing", 0, 10});
  visit(params.still_rotation, Field{"still_rotation", "rad", "noise a step, also when standing", 0, 3});
  visit(params.blind_translation, Field{"blind_translation", "m", "noise a step without odometry", 0, 100});
  visit(params.blind_rotation, Field{"blind_rotation", "rad", "noise a step without odometry", 0, 3});
}

/// Particles that lie together, and their share of the weight.
struct TrackCluster {
  Pose2 map_from_robot{};                               ///< weighted mean
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};  ///< of (x, y, theta), map frame: m², m·rad, rad²
  double share{0};                                      ///< of all weight, 0..1
};

/// Moves each particle by the odometry's motion, or by nothing when there is none, with noise drawn for each.
void move_particles(std::vector<Particle>& particles, const std::optional<Pose2>& before_from_after,
                    const MotionNoise& noise, Rng& rng);

/// weight ∝ weight · exp(odds · score), summing to 1; no particle may be -inf.
void weigh(std::vector<Particle>& particles, double odds);

/// 1 / Σ weight²; 0 without particles.
[[nodiscard]] double effective_count(std::span<const Particle> particles);

/// Particles that keep the error of their distribution over the bins they fill below `error`, with the probability
/// whose normal quantile is `quantile` (KLD sampling: Thrun et al. 2005, table 8.4), from bins of `reach` (m) and
/// `turn` (rad). O(particles · log bins).
[[nodiscard]] std::size_t kld_count(std::span<const Particle> particles, double reach, double turn, double error,
                                    double quantile);

/// `count` particles of equal weight, drawn by weight with one random number (low variance: Thrun et al. 2005,
/// table 4.4). O(particles + count).
[[nodiscard]] std::vector<Particle> resampled(std::span<const Particle> particles, std::size_t count, Rng& rng);

/// `count` particles of equal weight around the hypotheses, as many around each as its weight asks for, by its
/// covariance and no closer than the floor.
[[nodiscard]] std::vector<Particle> drawn_from(std::span<const PoseHypothesis> hypotheses,
                                               const Pose2& robot_from_sensor, std::size_t count, double floor_distance,
                                               double floor_heading, Rng& rng);

/// `count` particles of equal weight anywhere that a sensor can have been.
[[nodiscard]] std::vector<Particle> spread_out(const MapFields& fields, const Pose2& robot_from_sensor,
                                               std::size_t count, Rng& rng);

/// The heaviest clusters, at most `most`, heaviest first: all within `reach` (m) and `turn` (rad) of the mean of the
/// heaviest heap that is left. O(most · particles).
[[nodiscard]] std::vector<TrackCluster> clusters_of(std::span<const Particle> particles, double reach, double turn,
                                                    std::size_t most);

}  // namespace flirt
