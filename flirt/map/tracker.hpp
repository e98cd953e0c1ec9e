// flirt/map/tracker.hpp: where a robot is while it drives: localize()'s weighted hypotheses carried along by odometry.
//
//   Tracker tracker(map);
//   for (const Scan& scan : log.scans) {
//     const TrackStep step = tracker.add(scan);
//     if (step.verdict == Verdict::unique) { drive_from(step.map_from_robot); }
//   }
//
// A particle filter (Thrun, Burgard, Fox 2005, ch. 8). As the papers' solution set is (P1 §4.1), localize()'s
// hypotheses are a weighted sample of p(x | z, m), and start it; Monte Carlo localization as usually started, with
// particles all over the map, is there to compare.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/rng.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/core/scan_interval.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/particles.hpp"
#include "flirt/map/track_belief.hpp"

#include <Eigen/Core>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {

/// Where particles come from.
enum class TrackInitialisation : std::uint8_t {
  hypotheses,  ///< localize(): at the start, and when it finds a place that explains the scans clearly better
  uniform,     ///< everywhere, at the start and when scans fit worse than before: plain Monte Carlo localization
};
constexpr auto enum_names(TrackInitialisation /*tag*/) {
  return std::array{std::pair{TrackInitialisation::hypotheses, std::string_view("hypotheses")},
                    std::pair{TrackInitialisation::uniform, std::string_view("uniform")}};
}

/// Plain Monte Carlo localization, as it usually is: for comparison.
struct UniformParams {
  std::uint32_t particles{20000};  ///< at the start, and at most
  std::uint32_t least_particles{500};
  double score_odds{0.4};     ///< log odds of two poses per unit of score
  double sigma{0.25};         ///< m, width of the likelihood of an end point: sparse particles need a smooth one
  double kld_error{0.05};     ///< of the distribution over bins, which sets the number (Thrun et al., table 8.4)
  double kld_quantile{2.33};  ///< standard normal quantile of the probability to keep that error: .99
  double slow{0.001};         ///< rates of the averages of the likelihood whose ratio says how many particles to
  double fast{0.1};           ///< spread out anew (Thrun et al., table 8.3); 0: none
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, UniformParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.particles, Field{"particles", "", "spread out at the start, and at most", 1, 1e7});
  visit(params.least_particles, Field{"least_particles", "", "at least", 1, 1e7});
  visit(params.score_odds, Field{"score_odds", "", "log odds of poses per unit of score", 0, 100});
  visit(params.sigma, Field{"sigma", "m", "width of the likelihood of an end point's distance", 0.01, 1.0});
  visit(params.kld_error, Field{"kld_error", "", "of the distribution over bins", 0.001, 1});
  visit(params.kld_quantile, Field{"kld_quantile", "", "normal quantile of the probability to keep it", 0, 10});
  visit(params.slow, Field{"slow", "", "rate of the slow average of the likelihood", 0, 1});
  visit(params.fast, Field{"fast", "", "rate of the fast average of the likelihood; 0: no recovery", 0, 1});
}

struct TrackerParams {
  TrackInitialisation initialisation{TrackInitialisation::hypotheses};
  std::uint32_t particles{400};       ///< from hypotheses
  std::uint32_t particle_points{60};  ///< end points of a scan that particles are weighted by, evenly picked
  double score_odds{0.4};             ///< log odds of two poses per unit of score between them, from one scan
  double resample_below{0.5};         ///< share of effective particles below which they are drawn anew
  std::uint32_t join_scans{4};        ///< scans, with this one, that are searched for together
  std::uint32_t check_every{8};       ///< scans between searches while the robot is tracked
  double inject_margin{2};            ///< score by which a place found must explain the scans better to be taken in
  double inject_share{0.5};           ///< of the particles, drawn from hypotheses then
  double floor_distance{0.05};        ///< m, deviation added to a hypothesis' covariance
  double floor_heading{0.03};         ///< rad
  double cluster_distance{0.5};       ///< m, particles this near to a cluster's mean and
  double cluster_heading{radians_from_degrees(10)};  ///< rad, turned less than this are one place
  double min_confidence{0.9};                        ///< less is not unique
  double lost_below{0.3};  ///< probability that the robot is where any particle is; less is lost
  std::uint64_t seed{0};   ///< equal seeds give equal answers on any number of threads
  MotionNoise motion{};
  BeliefParams belief{};
  UniformParams uniform{};
  LocalizeParams localize{};  ///< any method but `papers`
};

/// The fields of `localize` and `uniform` are visited on their own.
template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, TrackerParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.initialisation, Field{"initialisation", "", "where particles come from"});
  visit(params.particles, Field{"particles", "", "drawn from hypotheses", 1, 1e6});
  visit(params.particle_points, Field{"particle_points", "", "end points that weight a particle", 1, 1e5});
  visit(params.score_odds, Field{"score_odds", "", "log odds of poses per unit of score", 0, 100});
  visit(params.resample_below, Field{"resample_below", "1", "share of effective particles to draw anew below", 0, 1});
  visit(params.join_scans, Field{"join_scans", "", "scans that are searched for together", 1, 1000});
  visit(params.check_every, Field{"check_every", "", "scans between searches while tracked", 1, 1e6});
  visit(params.inject_margin, Field{"inject_margin", "", "score by which a new place must be better", 0, 100});
  visit(params.inject_share, Field{"inject_share", "1", "of the particles, given to new places", 0, 1});
  visit(params.floor_distance, Field{"floor_distance", "m", "deviation added to a hypothesis", 0, 10});
  visit(params.floor_heading, Field{"floor_heading", "rad", "deviation added to a hypothesis", 0, 3});
  visit(params.cluster_distance, Field{"cluster_distance", "m", "particles nearer are one place", 0.01, 100});
  visit(params.cluster_heading, Field{"cluster_heading", "rad", "particles turned less are one place", 0.01, 3.2});
  visit(params.min_confidence, Field{"min_confidence", "1", "less confidence is not unique", 0, 1});
  visit(params.lost_below, Field{"lost_below", "1", "probability to be where particles are; less is lost", 0, 1});
  visit_fields(params.motion, visit);
  visit_fields(params.belief, visit);
}

/// The answer after a scan.
struct TrackStep {
  Verdict verdict{Verdict::lost};
  Reason reason{Reason::few_points};
  double confidence{0};                                 ///< probability that the pose is right: share · belief
  Pose2 map_from_robot{};                               ///< mean of the best cluster; without any, says nothing
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};  ///< of (x, y, theta), map frame: m², m·rad, rad²
  double share{0};                                      ///< of the weight, within the best cluster
  double belief{0};                                     ///< probability that the particles hold the robot's place
  EvidenceScore evidence{};                             ///< of the whole scan at the pose
  std::uint32_t points{0};                              ///< end points of the scan
  double effective{0};                                  ///< particles, before they were drawn anew
  std::vector<TrackCluster> clusters{};                 ///< heaviest first, at most ten
  double search_confidence{0};                          ///< of localize(); 0 when it was not asked
  bool searched{false};                                 ///< localize() was asked
  bool injected{false};                                 ///< particles were drawn from its hypotheses
};

/// Follows one robot in one map.
class Tracker {
 public:
  /// `threads` share the particles; 0 for one per processor. Answers do not depend on them.
  explicit Tracker(const PlaceMap& map, const TrackerParams& params = {}, std::size_t threads = 1);

  /// The next scan of the drive, in order. Without odometry in this or the last scan the robot is taken to have moved
  /// to where the scan fits best near the places that are followed, within three times `blind_translation` and
  /// `blind_rotation`. Map scans in `excluded` do not take part.
  /// O(particles · particle_points), and a localize() where one is needed.
  TrackStep add(const Scan& scan, ScanInterval excluded = {});

  /// Makes the evidence without the scans in `excluded` ready, which otherwise the next `add` does: to time it alone.
  void prepare(ScanInterval excluded) { (void)localizer_.fields(excluded); }

  [[nodiscard]] const std::vector<Particle>& particles() const { return particles_; }

 private:
  void remember(const Scan& scan);
  void move(const std::optional<Pose2>& motion, const MapFields& fields, const ScanPoints& points,
            const Pose2& robot_from_sensor);
  [[nodiscard]] bool search_due() const;
  [[nodiscard]] bool is_better(const LocalizationResult& found, const ScanPoints& joined, const MapFields& fields,
                               const Pose2& robot_from_sensor) const;
  void search(const Scan& scan, ScanInterval excluded, TrackStep& step);
  void draw(const LocalizationResult& found, const Pose2& robot_from_sensor);
  void score_particles(const MapFields& fields, const ScanPoints& points, const Pose2& robot_from_sensor);
  void weigh_particles(const ScanPoints& points);
  void locate(const EvidenceScorer& scorer, const ScanPoints& points, const Pose2& robot_from_sensor,
              TrackStep& step) const;
  void draw_anew(const MapFields& fields, const Pose2& robot_from_sensor, double effective);

  TrackerParams params_;
  std::size_t threads_;
  Localizer localizer_;
  Rng rng_;
  TrackBelief belief_;
  std::vector<Scan> last_scans_{};  ///< oldest first, at most join_scans
  std::vector<Particle> particles_{};
  double slow_likelihood_{0};  ///< average over scans, of `uniform` alone, as the next
  double fast_likelihood_{0};
  std::optional<Pose2> last_pose_{};  ///< map_from_robot of the last step's best place
  std::uint32_t since_search_{0};     ///< scans
  Verdict verdict_{Verdict::lost};    ///< of the last step
};

/// The verdict on a step's share and belief, and why.
[[nodiscard]] Verdict track_verdict(const TrackStep& step, const TrackerParams& params);
[[nodiscard]] Reason track_reason(const TrackStep& step, const TrackerParams& params);

}  // namespace flirt
