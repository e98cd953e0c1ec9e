#include "flirt/map/tracker.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/parallel.hpp"
#include "flirt/registration/join_scans.hpp"

#include <algorithm>
#include <optional>
#include <span>

namespace flirt {
namespace {

constexpr std::size_t most_clusters = 10;
constexpr double newest_share = 0.4;  // of the newest scan in the smoothed score

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
    : params_(params), threads_(threads), localizer_(map, params.localize), rng_(params.seed) {
  FLIRT_ASSERT(params.localize.method != LocalizeMethod::papers);
}

void Tracker::remember(const Scan& scan) {
  last_scans_.push_back(scan);
  // The last two at least: their odometry is the motion.
  if (last_scans_.size() > std::max<std::size_t>(2, params_.join_scans)) { last_scans_.erase(last_scans_.begin()); }
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
  since_drawn_ = found.verdict == Verdict::unique ? params_.settle_scans : 0;
}

bool Tracker::inject(const Scan& scan, ScanInterval excluded) {
  const std::span<const Scan> all = last_scans_;
  const ScanPoints joined =
      join_scans(all.last(std::min<std::size_t>(all.size(), params_.join_scans)), params_.localize.search.points);
  const LocalizationResult found = localizer_.localize_points(scan, joined, excluded);
  if (found.best() == nullptr) { return false; }
  if (!particles_.empty()) {
    // Both sides refined and scored by the same points: particles lie beside the best pose, hypotheses on it.
    std::vector<Pose2> tracked;
    for (const TrackCluster& cluster : clusters_of(particles_, params_.cluster_distance, params_.cluster_heading, 3)) {
      tracked.push_back(cluster.map_from_robot * scan.robot_from_sensor);
    }
    const std::vector<ScoredPose> refined =
        judge(localizer_.fields(excluded), joined, tracked, params_.localize.search);
    const bool better = std::ranges::all_of(refined, [&](const ScoredPose& pose) {
      return found.best()->score > pose.score.total + params_.inject_margin;
    });
    if (!better) { return false; }
  }
  draw(found, scan.robot_from_sensor);
  return true;
}

void Tracker::score_particles(const MapFields& fields, const ScanPoints& points, const Pose2& robot_from_sensor) {
  const EvidenceScorer scorer(fields, params_.localize.search.score);
  parallel_for(
      particles_.size(), threads_,
      [&](std::size_t i, std::size_t /*thread*/) {
        particles_[i].score = scorer.score(points, particles_[i].map_from_robot * robot_from_sensor).total;
      },
      {}, 64);
}

void Tracker::judge_particles(TrackStep& step) const {
  step.clusters = clusters_of(particles_, params_.cluster_distance, params_.cluster_heading, most_clusters);
  step.score = score_;
  if (step.clusters.empty()) { return; }
  const TrackCluster& best = step.clusters.front();
  step.map_from_robot = best.map_from_robot;
  step.covariance = best.covariance;
  step.share = best.share;
  const bool settled = since_drawn_ >= params_.settle_scans;
  if (score_ < params_.min_score) {
    step.verdict = Verdict::lost;
  } else {
    step.verdict = settled && best.share >= params_.unique_share ? Verdict::unique : Verdict::ambiguous;
  }
}

TrackStep Tracker::add(const Scan& scan, ScanInterval excluded) {
  TrackStep step;
  remember(scan);
  move_particles(particles_, last_motion(last_scans_), params_.motion, rng_);
  ++since_search_;
  ++since_drawn_;
  if (localizer_.fields(excluded).empty()) { return step; }
  const ScanPoints points = thinned(scan_points(scan, params_.localize.search.points), params_.particle_points);
  if (particles_.empty() && params_.initialisation == TrackInitialisation::uniform) {
    particles_ = spread_out(localizer_.fields(excluded), scan.robot_from_sensor, params_.uniform_particles, rng_);
    since_drawn_ = 0;
  }
  const auto score = [&] { score_particles(localizer_.fields(excluded), points, scan.robot_from_sensor); };
  score();
  const bool is_uniform = params_.initialisation == TrackInitialisation::uniform;
  if (points.size() != 0) { weigh(particles_, is_uniform ? params_.uniform_odds : params_.score_odds); }
  if (search_due()) {
    step.searched = true;
    since_search_ = 0;
    step.injected = inject(scan, excluded);
    if (step.injected) { score(); }  // not weighed again: the hypotheses' weights know this scan
  }
  double mean = 0;
  for (const Particle& particle : particles_) { mean += particle.weight * particle.score; }
  score_ = step.injected ? mean : score_ + newest_share * (mean - score_);
  judge_particles(step);
  verdict_ = step.verdict;
  step.effective = effective_count(particles_);
  const auto count = static_cast<double>(particles_.size());
  if (step.effective < params_.resample_below * count) { particles_ = resampled(particles_, particles_.size(), rng_); }
  return step;
}

}  // namespace flirt
