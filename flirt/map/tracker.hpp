// flirt/map/tracker.hpp: where a robot is while it drives: localize()'s weighted hypotheses carried along by odometry.
//
//   Tracker tracker(map);
//   for (const Scan& scan : log.scans) {
//     const TrackStep step = tracker.add(scan);
//     if (step.verdict == Verdict::unique) { drive_from(step.map_from_robot); }
//   }
//
// A particle filter (Thrun, Burgard, Fox 2005, ch. 8). The papers' solution set is a sample of p(x | z, m) and so can
// start it (P1 §4.1); Monte Carlo localization as usually started, with particles all over the map, is there to
// compare.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/rng.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/core/scan_interval.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/particles.hpp"

#include <Eigen/Core>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {

/// Where particles come from.
enum class TrackInitialisation : std::uint8_t {
  hypotheses,  ///< localize(): at the start, and when it finds a place that explains the scans clearly better
  uniform,     ///< everywhere, once, at the start: plain Monte Carlo localization
};
constexpr auto enum_names(TrackInitialisation /*tag*/) {
  return std::array{std::pair{TrackInitialisation::hypotheses, std::string_view("hypotheses")},
                    std::pair{TrackInitialisation::uniform, std::string_view("uniform")}};
}

struct TrackerParams {
  TrackInitialisation initialisation{TrackInitialisation::hypotheses};
  std::uint32_t particles{400};            ///< from hypotheses
  std::uint32_t uniform_particles{20000};  ///< with `uniform`, from start to end
  std::uint32_t particle_points{60};       ///< end points of a scan that particles are weighted by, evenly picked
  double score_odds{0.4};                  ///< log odds of two poses per unit of score between them, from one scan
  double uniform_odds{0.2};                ///< the same with `uniform`: sparse particles need a smoother likelihood
  double resample_below{0.5};              ///< share of effective particles below which they are drawn anew
  std::uint32_t join_scans{4};             ///< scans, with this one, that are searched for together
  std::uint32_t check_every{8};            ///< scans between searches while the robot is tracked
  double inject_margin{2};       ///< score by which a place found must explain the scans better to be taken in
  double inject_share{0.5};      ///< of the particles, drawn from hypotheses then
  double floor_distance{0.05};   ///< m, deviation added to a hypothesis' covariance
  double floor_heading{0.03};    ///< rad
  double cluster_distance{0.5};  ///< m, particles this near to a cluster's mean and
  double cluster_heading{radians_from_degrees(10)};  ///< rad, turned less than this are one place
  double unique_share{0.9};                          ///< weight of the best place that makes it the only one
  double min_score{2};            ///< mean score of the particles, of the last few scans; less is lost
  std::uint32_t settle_scans{3};  ///< scans after particles were drawn before an answer is unique
  std::uint64_t seed{0};          ///< equal seeds give equal answers on any number of threads
  MotionNoise motion{};
  LocalizeParams localize{};  ///< any method but `papers`
};

/// The fields of `localize` are visited on their own.
template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, TrackerParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.initialisation, Field{"initialisation", "", "where particles come from"});
  visit(params.particles, Field{"particles", "", "drawn from hypotheses", 1, 1e6});
  visit(params.uniform_particles, Field{"uniform_particles", "", "spread out with uniform", 1, 1e7});
  visit(params.particle_points, Field{"particle_points", "", "end points that weight a particle", 1, 1e5});
  visit(params.score_odds, Field{"score_odds", "", "log odds of poses per unit of score", 0, 100});
  visit(params.uniform_odds, Field{"uniform_odds", "", "log odds of poses per unit of score, with uniform", 0, 100});
  visit(params.resample_below, Field{"resample_below", "1", "share of effective particles to draw anew below", 0, 1});
  visit(params.join_scans, Field{"join_scans", "", "scans that are searched for together", 1, 1000});
  visit(params.check_every, Field{"check_every", "", "scans between searches while tracked", 1, 1e6});
  visit(params.inject_margin, Field{"inject_margin", "", "score by which a new place must be better", 0, 100});
  visit(params.inject_share, Field{"inject_share", "1", "of the particles, given to new places", 0, 1});
  visit(params.floor_distance, Field{"floor_distance", "m", "deviation added to a hypothesis", 0, 10});
  visit(params.floor_heading, Field{"floor_heading", "rad", "deviation added to a hypothesis", 0, 3});
  visit(params.cluster_distance, Field{"cluster_distance", "m", "particles nearer are one place", 0.01, 100});
  visit(params.cluster_heading, Field{"cluster_heading", "rad", "particles turned less are one place", 0.01, 3.2});
  visit(params.unique_share, Field{"unique_share", "1", "weight of the best place that makes it unique", 0, 1});
  visit(params.min_score, Field{"min_score", "", "mean score of the particles that is lost below", -100, 100});
  visit(params.settle_scans, Field{"settle_scans", "", "scans before an answer is unique", 0, 1000});
  visit_fields(params.motion, visit);
}

/// The answer after a scan.
struct TrackStep {
  Verdict verdict{Verdict::lost};
  Pose2 map_from_robot{};                               ///< mean of the best cluster; without any, says nothing
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};  ///< of (x, y, theta), map frame: m², m·rad, rad²
  double share{0};                                      ///< of the weight, within the best cluster
  double score{0};                                      ///< mean over the particles and the last few scans
  double effective{0};                                  ///< particles, before they were drawn anew
  std::vector<TrackCluster> clusters{};                 ///< heaviest first, at most ten
  bool searched{false};                                 ///< localize() was asked
  bool injected{false};                                 ///< particles were drawn from its hypotheses
};

/// Follows one robot in one map.
class Tracker {
 public:
  /// `threads` share the particles; 0 for one per processor. Answers do not depend on them.
  explicit Tracker(const PlaceMap& map, const TrackerParams& params = {}, std::size_t threads = 1);

  /// The next scan of the drive, in order. Without odometry in this or the last scan the robot is taken to have stood,
  /// within `blind_translation` and `blind_rotation`. Map scans in `excluded` do not take part.
  /// O(particles · particle_points), and a localize() where one is needed.
  TrackStep add(const Scan& scan, ScanInterval excluded = {});

  [[nodiscard]] const std::vector<Particle>& particles() const { return particles_; }

 private:
  void remember(const Scan& scan);
  [[nodiscard]] bool search_due() const;
  [[nodiscard]] bool inject(const Scan& scan, ScanInterval excluded);
  void draw(const LocalizationResult& found, const Pose2& robot_from_sensor);
  void score_particles(const MapFields& fields, const ScanPoints& points, const Pose2& robot_from_sensor);
  void judge_particles(TrackStep& step) const;

  TrackerParams params_;
  std::size_t threads_;
  Localizer localizer_;
  Rng rng_;
  std::vector<Scan> last_scans_{};  ///< oldest first, at most join_scans
  std::vector<Particle> particles_{};
  double score_{0};                 ///< mean over the particles, smoothed over scans
  std::uint32_t since_search_{0};   ///< scans
  std::uint32_t since_drawn_{0};    ///< scans
  Verdict verdict_{Verdict::lost};  ///< of the last step
};

}  // namespace flirt
