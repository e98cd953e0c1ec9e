#include "flirt/map/tracker.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/parallel.hpp"
#include "flirt/map/seen_motion.hpp"
#include "flirt/registration/join_scans.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace flirt {
namespace {

constexpr std::size_t most_clusters = 10;
/// Every k-th point, at most `most`.
ScanPoints thinned(const ScanPoints& points, std::size_t most) {
  if (points.size() <= most) { return points; }
  const std::size_t stride = (points.size() + most - 1) / most;
  ScanPoints kept;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    kept.x.push_back(points.x[i]);
    kept.y.push_back(points.y[i]);
    kept.range.push_back(points.range[i]);
  }
  return kept;
}

/// The robot's motion between the last two scans, where both know.
std::optional<Pose2> last_motion(std::span<const Scan> scans) {
  if (scans.size() < 2) { return std::nullopt; }
  const std::optional<Pose2>& before = scans[scans.size() - 2].odom_from_robot;
  const std::optional<Pose2>& after = scans.back().odom_from_robot;
  if (!before || !after) { return std::nullopt; }
  return inverse(*before) * *after;
}

}  // namespace

Tracker::Tracker(const PlaceMap& map, const TrackerParams& params, std::size_t threads)
    : params_(params), threads_(threads), localizer_(map, params.localize), rng_(params.seed), belief_(params.belief) {
  FLIRT_ASSERT(params.localize.method != LocalizeMethod::papers);
}

void Tracker::remember(const Scan& scan) {
  last_scans_.push_back(scan);
  // The last two at least: their odometry is the motion.
  if (last_scans_.size() > std::max<std::size_t>(2, params_.join_scans)) { last_scans_.erase(last_scans_.begin()); }
}

/// Without odometry the robot is taken to have moved, from each place that is followed, to where its scan fits best
/// near it. A quarter of the particles only spread, for where that is wrong; so do those at no place, and of `uniform`
/// all.
void Tracker::move(const std::optional<Pose2>& motion, const MapFields& fields, const ScanPoints& points,
                   const Pose2& robot_from_sensor) {
  constexpr std::size_t most_followed = 3;
  constexpr std::size_t spread_every = 4;
  if (motion || params_.initialisation == TrackInitialisation::uniform || points.size() == 0) {
    return move_particles(particles_, motion, params_.motion, rng_);
  }
  const MotionReach reach{3 * params_.motion.blind_translation, 3 * params_.motion.blind_rotation};
  std::vector<Particle> moved;
  std::vector<Particle> left = std::move(particles_);
  for (const TrackCluster& place :
       clusters_of(left, params_.cluster_distance, params_.cluster_heading, most_followed)) {
    const auto seen =
        seen_motion(fields, points, place.map_from_robot, robot_from_sensor, reach, params_.localize.search);
    if (!seen) { continue; }
    std::vector<Particle> followed;
    std::vector<Particle> others;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const Pose2& pose = left[i].map_from_robot;
      const bool here = distance(pose, place.map_from_robot) <= params_.cluster_distance &&
                        heading_difference(pose, place.map_from_robot) <= params_.cluster_heading;
      (here && i % spread_every != 0 ? followed : others).push_back(left[i]);
    }
    move_particles(followed, seen, params_.motion, rng_);
    moved.insert(moved.end(), followed.begin(), followed.end());
    left = std::move(others);
  }
  move_particles(left, std::nullopt, params_.motion, rng_);
  particles_ = std::move(left);
  particles_.insert(particles_.end(), moved.begin(), moved.end());
}

bool Tracker::search_due() const {
  return params_.initialisation == TrackInitialisation::hypotheses &&
         (particles_.empty() || verdict_ != Verdict::unique || since_search_ >= params_.check_every);
}

void Tracker::draw(const LocalizationResult& found, const Pose2& robot_from_sensor) {
  const std::size_t count = params_.particles;
  const auto drawn =
      particles_.empty() ? count : static_cast<std::size_t>(params_.inject_share * static_cast<double>(count));
  std::vector<Particle> set = resampled(particles_, count - drawn, rng_);
  const std::vector<Particle> fresh =
      drawn_from(found.hypotheses, robot_from_sensor, drawn, params_.floor_distance, params_.floor_heading, rng_);
  set.insert(set.end(), fresh.begin(), fresh.end());
  for (Particle& particle : set) { particle.weight = 1.0 / static_cast<double>(set.size()); }
  particles_ = std::move(set);
}

/// Both sides refined and scored by the same points: particles lie beside the best pose, hypotheses on it.
bool Tracker::is_better(const LocalizationResult& found, const ScanPoints& joined, const MapFields& fields,
                        const Pose2& robot_from_sensor) const {
  std::vector<Pose2> tracked;
  for (const TrackCluster& cluster : clusters_of(particles_, params_.cluster_distance, params_.cluster_heading, 3)) {
    tracked.push_back(cluster.map_from_robot * robot_from_sensor);
  }
  const std::vector<ScoredPose> refined = judge(fields, joined, tracked, params_.localize.search);
  return std::ranges::all_of(refined, [&](const ScoredPose& pose) {
    return found.best()->score > pose.score.preference + params_.inject_margin;
  });
}

void Tracker::search(const Scan& scan, ScanInterval excluded, TrackStep& step) {
  const std::span<const Scan> all = last_scans_;
  const ScanPoints joined =
      join_scans(all.last(std::min<std::size_t>(all.size(), params_.join_scans)), params_.localize.search.points);
  const LocalizationResult found = localizer_.localize_points(scan, joined, excluded);
  since_search_ = 0;
  step.searched = true;
  step.search_confidence = found.confidence;
  if (found.best() == nullptr || !is_better(found, joined, localizer_.fields(excluded), scan.robot_from_sensor)) {
    return;
  }
  draw(found, scan.robot_from_sensor);
  belief_.start(found.confidence);
  step.injected = true;
}

void Tracker::score_particles(const MapFields& fields, const ScanPoints& points, const Pose2& robot_from_sensor) {
  EvidenceScoreParams params = params_.localize.search.score;
  if (params_.initialisation == TrackInitialisation::uniform) { params.sigma = params_.uniform.sigma; }
  const EvidenceScorer scorer(fields, params);
  parallel_for(
      particles_.size(), threads_,
      [&](std::size_t i, std::size_t /*thread*/) {
        particles_[i].score = scorer.score(points, particles_[i].map_from_robot * robot_from_sensor).total;
      },
      {}, 64);
}

void Tracker::weigh_particles(const ScanPoints& points) {
  if (points.size() == 0) { return; }
  if (params_.initialisation == TrackInitialisation::hypotheses) { return weigh(particles_, params_.score_odds); }
  const UniformParams& uniform = params_.uniform;
  double likelihood = 0;
  for (const Particle& particle : particles_) {
    likelihood += particle.weight * std::exp(uniform.score_odds * particle.score);
  }
  if (slow_likelihood_ == 0) { slow_likelihood_ = fast_likelihood_ = likelihood; }
  slow_likelihood_ += uniform.slow * (likelihood - slow_likelihood_);
  fast_likelihood_ += uniform.fast * (likelihood - fast_likelihood_);
  weigh(particles_, uniform.score_odds);
}

void Tracker::locate(const EvidenceScorer& scorer, const ScanPoints& points, const Pose2& robot_from_sensor,
                     TrackStep& step) const {
  step.clusters = clusters_of(particles_, params_.cluster_distance, params_.cluster_heading, most_clusters);
  step.points = static_cast<std::uint32_t>(points.size());
  if (step.clusters.empty()) { return; }
  const TrackCluster& best = step.clusters.front();
  step.map_from_robot = best.map_from_robot;
  step.covariance = best.covariance;
  step.share = best.share;
  if (points.size() != 0) { step.evidence = scorer.score(points, best.map_from_robot * robot_from_sensor); }
}

/// Particles drawn by weight where few of them count; those of `uniform` as many as KLD sampling asks for, some of them
/// anywhere when scans fit worse than they did (augmented Monte Carlo localization).
void Tracker::draw_anew(const MapFields& fields, const Pose2& robot_from_sensor, double effective) {
  const auto count = static_cast<double>(particles_.size());
  if (effective >= params_.resample_below * count) { return; }
  if (params_.initialisation == TrackInitialisation::hypotheses) {
    particles_ = resampled(particles_, particles_.size(), rng_);
    return;
  }
  const UniformParams& uniform = params_.uniform;
  const double anywhere = uniform.fast > 0 ? std::max(0.0, 1 - fast_likelihood_ / slow_likelihood_) : 0.0;
  std::vector<Particle> drawn = resampled(particles_, particles_.size(), rng_);
  const std::size_t needed =
      kld_count(drawn, params_.cluster_distance, params_.cluster_heading, uniform.kld_error, uniform.kld_quantile);
  const std::size_t kept =
      std::clamp<std::size_t>(needed, std::min(uniform.least_particles, uniform.particles), uniform.particles);
  const auto fresh = static_cast<std::size_t>(anywhere * static_cast<double>(uniform.particles));
  particles_ = resampled(drawn, kept, rng_);
  const std::vector<Particle> spread = spread_out(fields, robot_from_sensor, fresh, rng_);
  particles_.insert(particles_.end(), spread.begin(), spread.end());
  for (Particle& particle : particles_) { particle.weight = 1 / static_cast<double>(particles_.size()); }
}

Verdict track_verdict(const TrackStep& step, const TrackerParams& params) {
  if (step.clusters.empty() || step.belief < params.lost_below) { return Verdict::lost; }
  return step.confidence >= params.min_confidence ? Verdict::unique : Verdict::ambiguous;
}

Reason track_reason(const TrackStep& step, const TrackerParams& params) {
  switch (step.verdict) {
    case Verdict::unique:
      return Reason::clear_winner;
    case Verdict::ambiguous:
      return step.share < params.min_confidence ? Reason::second_place_too_close : Reason::little_evidence;
    case Verdict::lost:
      break;
  }
  return step.points < params.localize.verdict.min_points ? Reason::few_points : why_not(step.evidence);
}

TrackStep Tracker::add(const Scan& scan, ScanInterval excluded) {
  TrackStep step;
  remember(scan);
  const std::optional<Pose2> motion = last_motion(last_scans_);
  ++since_search_;
  if (localizer_.fields(excluded).empty()) {
    step.reason = Reason::empty_map;
    return step;
  }
  const MapFields& fields = localizer_.fields(excluded);
  const EvidenceScorer scorer(fields, params_.localize.search.score);
  const ScanPoints points = scan_points(scan, params_.localize.search.points);
  const ScanPoints few = thinned(points, params_.particle_points);
  move(motion, fields, points, scan.robot_from_sensor);
  if (particles_.empty() && params_.initialisation == TrackInitialisation::uniform) {
    particles_ = spread_out(fields, scan.robot_from_sensor, params_.uniform.particles, rng_);
    belief_.start(0.5);
  }
  score_particles(fields, few, scan.robot_from_sensor);
  weigh_particles(few);
  locate(scorer, points, scan.robot_from_sensor, step);
  if (!step.clusters.empty()) {
    // Without odometry the filter's own motion must do.
    const Pose2 seen_motion = last_pose_ ? inverse(*last_pose_) * step.map_from_robot : Pose2{};
    belief_.look(step.evidence, points.size(), motion.value_or(seen_motion));
  }
  if (search_due()) { search(scan, excluded, step); }
  if (step.injected) {  // not weighed again: the hypotheses' weights know this scan
    score_particles(fields, few, scan.robot_from_sensor);
    locate(scorer, points, scan.robot_from_sensor, step);
  }
  if (!step.clusters.empty()) { last_pose_ = step.map_from_robot; }
  step.belief = belief_.probability();
  step.confidence = step.belief * step.share;
  step.verdict = track_verdict(step, params_);
  step.reason = track_reason(step, params_);
  verdict_ = step.verdict;
  step.effective = effective_count(particles_);
  draw_anew(fields, scan.robot_from_sensor, step.effective);
  return step;
}

}  // namespace flirt
