// flirt/map/track_belief.hpp: whether a drive's scans agree with the place at which a robot is followed, added up over
// the scans: a test of sustained agreement, not of one score.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/registration/evidence_score.hpp"

#include <concepts>
#include <cstddef>
#include <type_traits>

namespace flirt {

/// A hidden Markov model of two states: "the robot is at the place that is followed" and "it is not" (it is elsewhere,
/// or in a building that the map does not show). A look is a scan scored at the place that was followed before the scan
/// was seen. Its log likelihood ratio is offset + strength·s + unknown·u + through·t, with s = score · √(points / 80)
/// and u, t the score's terms of those names. Fitted by maximum likelihood on 877 right and 1454 wrong looks of the
/// logs aces and fr101 and a simulated building; but `unknown` is that of VerdictParams, as these looks hardly tell it.
struct BeliefParams {
  double offset{-5.5};         ///< log odds a look
  double strength{0.57};       ///< log odds per unit of score · √(points / 80)
  double unknown{-4.0};        ///< log odds per share of end points in unseen space
  double through{-4.9};        ///< log odds per share of beams through something solid
  double largest_look{3.0};    ///< log odds that one look adds or takes, at most
  double new_way{0.7};         ///< m driven, or
  double new_turn{0.7};        ///< rad turned, after which a look is independent of the last one; less counts in part
  double leave{0.01};          ///< probability, a look, that the robot is carried away or leaves the map
  double arrive{0.005};        ///< probability, a look, that the robot comes (back) to where particles are
  double largest_start{0.85};  ///< probability that a search alone can give: most that no second look has confirmed
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, BeliefParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.offset, Field{"look_offset", "", "log odds of a look, less what follows", -100, 100});
  visit(params.strength, Field{"look_strength", "", "log odds of a look per unit of score and evidence", 0, 100});
  visit(params.unknown, Field{"look_unknown", "", "log odds of a look per share of end points unseen", -100, 0});
  visit(params.through, Field{"look_through", "", "log odds of a look per share of beams through solid", -100, 0});
  visit(params.largest_look, Field{"largest_look", "", "log odds that one look adds or takes, at most", 0, 100});
  visit(params.new_way, Field{"new_way", "m", "driven, after which a look is a new one", 0.001, 100});
  visit(params.new_turn, Field{"new_turn", "rad", "turned, after which a look is a new one", 0.001, 7});
  visit(params.leave, Field{"leave", "1", "probability that a place stops being right, a look", 0, 0.5});
  visit(params.arrive, Field{"arrive", "1", "probability that a place becomes right, a look", 0, 0.5});
  visit(params.largest_start, Field{"largest_start", "1", "probability that a search alone can give", 0.001, 0.999});
}

/// Probability that the place that is followed is right; 0 before any was found.
class TrackBelief {
 public:
  explicit TrackBelief(const BeliefParams& params = {}) : params_(params) {}

  /// A place was found with this probability, by a scan that can't vouch for it a second time.
  void start(double confidence);
  /// The robot moved, and was seen again at the place that was followed. A scan without points says nothing.
  void look(const EvidenceScore& score, std::size_t points, const Pose2& before_from_after);

  [[nodiscard]] double probability() const { return probability_; }

 private:
  BeliefParams params_;
  double probability_{0};
};

/// The log likelihood ratio of one independent look, within ± largest_look.
[[nodiscard]] double log_odds_of_look(const EvidenceScore& score, std::size_t points, const BeliefParams& params = {});

}  // namespace flirt
