// flirt/match/ransac.hpp: the rigid motion between two scans that most of their keypoints agree on.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/features/features.hpp"
#include "flirt/match/alignment.hpp"
#include "flirt/match/columns.hpp"
#include "flirt/match/rigid.hpp"
#include "flirt/match/score.hpp"

#include <array>
#include <concepts>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {

/// How pairs of candidates are chosen as hypotheses. Either way a pair must keep its length, and the turn of its
/// segment must agree with the turns of its keypoints. On scans of aces and fr101 without their neighbours in time,
/// `exhaustive` with max_turn_difference 0.8 aligned half as many pairs again correctly as the papers' `random` (2.3 %
/// of all pairs to 1.6 %, 10.5 % to 5.0 %), in less time than `random` needs for the same.
enum class Sampling : std::uint8_t {
  random,      ///< at random, as many as the papers' inlier probability asks for
  exhaustive,  ///< every pair in order of descriptor distance, up to max_samples: needs no luck and no seed
};
constexpr auto enum_names(Sampling /*tag*/) {
  using enum Sampling;
  return std::array<std::pair<Sampling, std::string_view>, 2>{{{random, "random"}, {exhaustive, "exhaustive"}}};
}

/// What supports a hypothesis.
enum class InlierRule : std::uint8_t {
  nearest_point,  ///< each query keypoint that comes to lie near any reference keypoint (gives the papers' tables)
  one_to_one,     ///< candidates whose keypoints come to lie near each other, no keypoint used twice
};
constexpr auto enum_names(InlierRule /*tag*/) {
  using enum InlierRule;
  return std::array<std::pair<InlierRule, std::string_view>, 2>{
      {{nearest_point, "nearest-point"}, {one_to_one, "one-to-one"}}};
}

struct RansacParams {
  double inlier_distance{0.1};  ///< m, σ of a keypoint's position; inliers are within √5.99 σ (95 % of a normal error)
  double inlier_probability{0.3};    ///< share of candidates that are right (P1: 0.3, P2: 0.5); random sampling only
  double success_probability{0.95};  ///< chance of drawing one pair of right candidates; random sampling only
  Sampling sampling{Sampling::exhaustive};  ///< how pairs of candidates are chosen as hypotheses
  std::uint32_t max_samples{5000};          ///< pairs looked at, at most; exhaustive sampling only
  double max_turn_difference{0.8};          ///< rad, between the turn of a sample and that of its keypoints; π: any
  InlierRule inlier_rule{InlierRule::nearest_point};  ///< what supports a hypothesis
  std::uint32_t min_inliers{3};                       ///< fewer are no alignment (P1: 3 for places, 6 for SLAM)
  double keypoint_deviation{0.05};  ///< m, per coordinate, for the covariance; 0: from the inliers' residuals
  std::uint64_t seed{0};            ///< random sampling only; equal seeds give equal results
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, RansacParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.inlier_distance, Field{"inlier_distance", "m", "sigma of a keypoint's position", 1e-6, 1e3});
  visit(params.inlier_probability, Field{"inlier_probability", "1", "random: share of right candidates", 1e-3, 1.0});
  visit(params.success_probability,
        Field{"success_probability", "1", "random: chance of drawing one right pair", 0.0, 0.999999});
  visit(params.sampling, Field{"sampling", "", "how pairs of candidates are chosen as hypotheses"});
  visit(params.max_samples, Field{"max_samples", "", "exhaustive: pairs looked at, at most", 1.0, 1e9});
  visit(params.max_turn_difference, Field{"max_turn_difference", "rad",
                                          "between the turn of a sample and of its keypoints", 0.0, std::numbers::pi});
  visit(params.inlier_rule, Field{"inlier_rule", "", "what supports a hypothesis"});
  visit(params.min_inliers, Field{"min_inliers", "", "fewer are no alignment", 2.0, 1e6});
  visit(params.keypoint_deviation,
        Field{"keypoint_deviation", "m", "per coordinate, for the covariance; 0: from the residuals", 0.0, 1e3});
  visit(params.seed, Field{"seed", "", "random: equal seeds give equal results"});
}

/// ceil(log(1 − success) / log(1 − inlier²)), at least 1: draws of two candidates until both are right.
[[nodiscard]] std::uint32_t iterations_needed(double inlier_probability, double success_probability);

/// An alignment without its lists, for all-against-all work.
struct PairAlignment {
  Pose2 reference_from_query{};  ///< maps query sensor coordinates into the reference sensor's
  double residual{0};            ///< m², mean over all query keypoints of min(d², 5.99 σ²)
  std::uint32_t inliers{0};

  friend bool operator==(const PairAlignment&, const PairAlignment&) = default;
};

/// A keypoint of the query and one of the reference.
struct IndexPair {
  std::uint32_t query{0};
  std::uint32_t reference{0};

  friend bool operator==(const IndexPair&, const IndexPair&) = default;
};

/// The search for one query among many references; its workspaces stay allocated from one reference to the next.
class Ransac {
 public:
  explicit Ransac(const RansacParams& params = {});

  void set_query(const KeypointColumns& query);

  /// The motion of smallest residual, refined by least squares over its inliers as long as that lowers the residual.
  /// Independent of the order of `candidates`; a candidate listed twice counts once. Nothing when fewer than two
  /// candidates could move together or fewer than min_inliers agree.
  [[nodiscard]] std::optional<PairAlignment> align(const KeypointColumns& reference, std::span<const Match> candidates);

  /// Of the last call of align, in order of the query.
  [[nodiscard]] std::span<const IndexPair> inliers() const { return best_.inliers; }
  /// Covariance of (x, y, theta) of the last alignment found; see rigid_covariance.
  [[nodiscard]] Eigen::Matrix3d covariance() const;

 private:
  struct Support {
    RigidMotion reference_from_query{};
    double residual{0};
    std::vector<IndexPair> inliers{};
    std::vector<PointPair> points{};  ///< of the inliers
  };

  void choose(const KeypointColumns& reference, std::span<const Match> candidates);
  void prepare(const KeypointColumns& reference, std::span<const Match> candidates);
  void try_random(const KeypointColumns& reference);
  void try_all(const KeypointColumns& reference);
  [[nodiscard]] bool comes_first(const CandidatePair& a, const CandidatePair& b) const;
  void find_costs(const KeypointColumns& reference);
  [[nodiscard]] float one_to_one_cost(const Motion& reference_from_query, std::size_t references);
  void pair_one_to_one(const Motion& reference_from_query, std::size_t references);
  [[nodiscard]] float farthest_inlier(const Motion& reference_from_query) const;
  void evaluate(const RigidMotion& reference_from_query, const KeypointColumns& reference, Support& support);
  void refine(const KeypointColumns& reference);

  RansacParams params_;
  PairLimits pair_limits_;
  float limit_;  ///< m², squared distance of an inlier
  std::uint32_t iterations_;

  KeypointColumns query_{};
  ScoredPoints scored_query_{};
  std::vector<Match> usable_{};  ///< candidates whose keypoints are in sight
  CandidateColumns candidates_{};
  RigidPairs pairs_{};
  std::vector<Motion> motions_{};  ///< of the pairs
  std::vector<float> costs_{};     ///< m², of the motions
  MovedPoints moved_points_{};
  std::vector<std::uint32_t> nearest_{};                            ///< reference keypoint of each query keypoint
  std::vector<float> squared_{};                                    ///< m², distance to it
  std::vector<std::pair<float, std::uint32_t>> near_candidates_{};  ///< one-to-one: squared distance and candidate
  std::vector<bool> query_taken_{};
  std::vector<bool> reference_taken_{};
  Motion best_motion_{};
  float best_cost_{0};
  Support best_{};
  Support refined_{};
};

/// Best rigid motion of the query's keypoints onto the reference's, or nothing when there is none: fewer than two
/// matches, points that coincide, no two matches that could move together, fewer than min_inliers that agree. Keypoints
/// that are not finite support nothing. Inliers carry the distance of their match, or the symmetric χ² of their
/// descriptors where they were none. O(hypotheses · query · reference).
[[nodiscard]] std::optional<Alignment> align(const Features& query, const Features& reference,
                                             std::span<const Match> matches, const RansacParams& params = {});

/// Distances for the inliers of an alignment: that of the match if the pair was one, else `distance` of the
/// descriptors. O(inliers · matches).
[[nodiscard]] std::vector<Match> with_distances(std::span<const IndexPair> inliers, std::span<const Match> matches,
                                                Distance distance, const DescriptorRows& query,
                                                const DescriptorRows& reference);

}  // namespace flirt
