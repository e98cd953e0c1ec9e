// flirt/match/ransac.cpp: hypotheses from pairs of candidates, scored by all keypoints, refined by least squares.
#include "flirt/match/ransac.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/rng.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace flirt {
namespace {

constexpr double chi_square_95_of_1 = 3.84;  ///< 95 % quantile, one degree of freedom: a length
constexpr double chi_square_95_of_2 = 5.99;  ///< 95 % quantile, two degrees of freedom: a position
constexpr double shortest_segment = 1e-3;    ///< m; two keypoints closer than this have no direction
constexpr int most_refinements = 10;

PairLimits limits_of(const RansacParams& params) {
  const bool any_turn = params.max_turn_difference >= std::numbers::pi;
  return {static_cast<float>(chi_square_95_of_1 * params.inlier_distance * params.inlier_distance),
          static_cast<float>(shortest_segment * shortest_segment),
          any_turn ? -2.0F : static_cast<float>(std::cos(params.max_turn_difference))};
}

/// Closest descriptors first; ties by index, so that the order of the input does not matter.
bool is_better(const Match& a, const Match& b) {
  return std::tie(a.distance, a.query, a.reference) < std::tie(b.distance, b.query, b.reference);
}
/// By query, then by reference.
std::uint64_t place_of(const Match& match) {
  return std::uint64_t{match.query} << 32U | match.reference;
}
bool is_same_pair(const Match& a, const Match& b) {
  return a.query == b.query && a.reference == b.reference;
}

bool is_in_sight(const KeypointColumns& keypoints, std::uint32_t i) {
  FLIRT_ASSERT(i < keypoints.size());
  return std::abs(keypoints.x[i]) < out_of_sight;
}

Point2 point(const KeypointColumns& keypoints, std::uint32_t i) {
  return {double{keypoints.x[i]}, double{keypoints.y[i]}};
}

}  // namespace

std::uint32_t iterations_needed(double inlier_probability, double success_probability) {
  const double both_right = inlier_probability * inlier_probability;
  if (both_right >= 1.0) { return 1; }
  const double needed = std::ceil(std::log(1.0 - success_probability) / std::log(1.0 - both_right));
  return static_cast<std::uint32_t>(std::clamp(needed, 1.0, 1e9));
}

Ransac::Ransac(const RansacParams& params)
    : params_(params),
      pair_limits_(limits_of(params)),
      limit_(static_cast<float>(chi_square_95_of_2 * params.inlier_distance * params.inlier_distance)),
      iterations_(iterations_needed(params.inlier_probability, params.success_probability)) {}

void Ransac::set_query(const KeypointColumns& query) {
  query_ = query;
  scored_query_.assign(query);
  nearest_.resize(scored_query_.x.size());
  squared_.resize(scored_query_.x.size());
}

std::optional<PairAlignment> Ransac::align(const KeypointColumns& reference, std::span<const Match> candidates) {
  best_.inliers.clear();
  best_.points.clear();
  prepare(reference, candidates);
  if (usable_.size() < 2) { return std::nullopt; }

  const float cost_of_nothing = limit_ * static_cast<float>(query_.size());
  best_cost_ = cost_of_nothing;
  params_.sampling == Sampling::random ? try_random(reference) : try_all(reference);
  if (!(best_cost_ < cost_of_nothing)) { return std::nullopt; }

  evaluate(rigid_motion_of(best_motion_), reference, best_);
  refine(reference);
  if (best_.inliers.size() < std::max<std::size_t>(2, params_.min_inliers)) { return std::nullopt; }
  return PairAlignment{best_.reference_from_query.pose(), best_.residual,
                       static_cast<std::uint32_t>(best_.inliers.size())};
}

Eigen::Matrix3d Ransac::covariance() const {
  const double deviation = params_.keypoint_deviation > 0.0
                               ? params_.keypoint_deviation
                               : deviation_from_residuals(best_.points, best_.reference_from_query.pose());
  return rigid_covariance(best_.points, deviation);
}

/// The candidates whose keypoints are in sight into usable_, each once; by descriptor distance, unless all their pairs
/// will be tried, where the order only decides between equally good ones (see try_all).
void Ransac::choose(const KeypointColumns& reference, std::span<const Match> candidates) {
  usable_.resize(candidates.size());
  std::size_t count = 0;
  bool in_order = true;  // of query, then of reference, each pair once: as a matcher returns them
  for (const Match& match : candidates) {
    const bool usable = is_in_sight(query_, match.query) && is_in_sight(reference, match.reference);
    if (!usable || std::isnan(match.distance)) { continue; }
    in_order = in_order && (count == 0 || place_of(usable_[count - 1]) < place_of(match));
    usable_[count++] = match;
  }
  usable_.resize(count);
  const bool all_pairs = params_.sampling == Sampling::exhaustive && params_.inlier_rule == InlierRule::nearest_point &&
                         usable_.size() * usable_.size() / 2 <= params_.max_samples;
  if (in_order && all_pairs) { return; }
  std::ranges::sort(usable_, is_better);
  usable_.erase(std::ranges::unique(usable_, is_same_pair).begin(), usable_.end());
}

void Ransac::prepare(const KeypointColumns& reference, std::span<const Match> candidates) {
  choose(reference, candidates);
  candidates_.resize(usable_.size());
  for (std::size_t i = 0; i < usable_.size(); ++i) {
    const Match& match = usable_[i];
    candidates_.query_x[i] = query_.x[match.query];
    candidates_.query_y[i] = query_.y[match.query];
    candidates_.reference_x[i] = reference.x[match.reference];
    candidates_.reference_y[i] = reference.y[match.reference];
    candidates_.turn[i] = reference.theta[match.reference] - query_.theta[match.query];
  }
  if (pair_limits_.turn_cosine >= -1.0F) { fill_turns(candidates_); }
}

/// Pairs of candidates drawn at random; a pair that no rigid motion explains counts as a draw, as in the papers' count.
void Ransac::try_random(const KeypointColumns& reference) {
  Rng rng(params_.seed);
  const auto count = static_cast<std::uint32_t>(usable_.size());
  pairs_.pairs.clear();
  for (std::uint32_t iteration = 0; iteration < iterations_; ++iteration) {
    const std::uint32_t i = rng.below(count);
    const std::uint32_t other = rng.below(count - 1);
    const std::uint32_t j = other < i ? other : other + 1;
    if (is_rigid_pair(candidates_, i, j, pair_limits_)) { pairs_.pairs.push_back({i, j}); }
  }
  find_costs(reference);
  for (std::size_t k = 0; k < motions_.size(); ++k) {
    if (costs_[k] < best_cost_) {
      best_cost_ = costs_[k];
      best_motion_ = motions_[k];
    }
  }
}

/// All pairs by the worse of their two descriptor distances; of equally good ones the first in that order.
void Ransac::try_all(const KeypointColumns& reference) {
  std::size_t count = 1;
  std::size_t samples = 0;
  while (count < usable_.size() && samples < params_.max_samples) { samples += count++; }
  rigid_pairs(candidates_, count, pair_limits_, pairs_);
  find_costs(reference);
  CandidatePair best{};
  for (std::size_t k = 0; k < motions_.size(); ++k) {
    const CandidatePair& pair = pairs_.pairs[k];
    if (costs_[k] < best_cost_ || (costs_[k] == best_cost_ && comes_first(pair, best))) {
      best = pair;
      best_cost_ = costs_[k];
      best_motion_ = motions_[k];
    }
  }
}

/// The motions of all pairs and their costs: m², truncated squared distances summed over all query keypoints.
void Ransac::find_costs(const KeypointColumns& reference) {
  motions_.resize(pairs_.pairs.size());
  costs_.resize(pairs_.pairs.size());
  for (std::size_t k = 0; k < motions_.size(); ++k) {
    motions_[k] = motion_of_segment(candidates_, pairs_.pairs[k].i, pairs_.pairs[k].j);
  }
  if (params_.inlier_rule == InlierRule::nearest_point) {
    truncated_costs(motions_, scored_query_, reference, limit_, moved_points_, costs_);
  } else {
    for (std::size_t k = 0; k < motions_.size(); ++k) { costs_[k] = one_to_one_cost(motions_[k], reference.size()); }
  }
}

bool Ransac::comes_first(const CandidatePair& a, const CandidatePair& b) const {
  const auto worse_and_better = [&](const CandidatePair& pair) {
    const Match& i = usable_[pair.i];
    const Match& j = usable_[pair.j];
    return is_better(i, j) ? std::pair(j, i) : std::pair(i, j);
  };
  const auto [worse_a, better_a] = worse_and_better(a);
  const auto [worse_b, better_b] = worse_and_better(b);
  return is_better(worse_a, worse_b) || (!is_better(worse_b, worse_a) && is_better(better_a, better_b));
}

float Ransac::one_to_one_cost(const Motion& reference_from_query, std::size_t references) {
  pair_one_to_one(reference_from_query, references);
  float cost = limit_ * static_cast<float>(query_.size());
  for (const auto& [squared, candidate] : near_candidates_) { cost -= limit_ - squared; }
  return cost;
}

/// Leaves in near_candidates_ the candidates within the limit, nearest first, no keypoint used twice.
void Ransac::pair_one_to_one(const Motion& reference_from_query, std::size_t references) {
  near_candidates_.clear();
  for (std::uint32_t i = 0; i < usable_.size(); ++i) {
    const float squared = squared_distance_after(reference_from_query, candidates_, i);
    if (squared < limit_) { near_candidates_.emplace_back(squared, i); }
  }
  std::ranges::sort(near_candidates_);
  query_taken_.assign(query_.size(), false);
  reference_taken_.assign(references, false);
  std::erase_if(near_candidates_, [&](const auto& near_candidate) {
    const Match& match = usable_[near_candidate.second];
    if (query_taken_[match.query] || reference_taken_[match.reference]) { return true; }
    query_taken_[match.query] = true;
    reference_taken_[match.reference] = true;
    return false;
  });
}

/// m², a squared distance of float precision that no inlier's exceeds. Rounding moves a coordinate of the moved point
/// by less than 6e-7 of the lengths that go into it.
float Ransac::farthest_inlier(const Motion& reference_from_query) const {
  const float lengths = scored_query_.farthest + std::abs(reference_from_query.x) + std::abs(reference_from_query.y);
  const float distance = std::sqrt(limit_) + 2e-6F * (1.0F + lengths);
  return distance * distance;
}

/// The inliers of a motion, and its residual in double precision.
void Ransac::evaluate(const RigidMotion& reference_from_query, const KeypointColumns& reference, Support& support) {
  const Motion motion = motion_of(reference_from_query);
  support.reference_from_query = reference_from_query;
  support.inliers.clear();
  if (params_.inlier_rule == InlierRule::nearest_point) {
    nearest_points(motion, scored_query_, reference, nearest_, squared_);
    const float farthest = farthest_inlier(motion);
    support.inliers.resize(query_.size());
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < query_.size(); ++i) {  // which are near can't be foreseen: no branch
      support.inliers[count] = {i, nearest_[i]};
      count += squared_[i] < farthest ? 1 : 0;
    }
    support.inliers.resize(count);
  } else {
    pair_one_to_one(motion, reference.size());
    for (const auto& [squared, candidate] : near_candidates_) {
      support.inliers.push_back({usable_[candidate].query, usable_[candidate].reference});
    }
    std::ranges::sort(support.inliers, {}, &IndexPair::query);
  }

  const double limit{limit_};
  double gain = 0.0;
  std::size_t count = 0;
  support.points.resize(support.inliers.size());
  for (const IndexPair pair : support.inliers) {
    const PointPair points{point(query_, pair.query), point(reference, pair.reference)};
    const double squared = squared_norm(points.reference - reference_from_query * points.query);
    if (!(squared < limit)) { continue; }
    gain += limit - squared;
    support.inliers[count] = pair;
    support.points[count++] = points;
  }
  support.inliers.resize(count);
  support.points.resize(count);
  support.residual = limit - gain / static_cast<double>(query_.size());
}

/// Least squares over the inliers, and again over the inliers of that, while the residual falls.
void Ransac::refine(const KeypointColumns& reference) {
  for (int i = 0; i < most_refinements; ++i) {
    const std::optional<RigidMotion> reference_from_query = fit_rigid(best_.points);
    if (!reference_from_query) { return; }
    evaluate(*reference_from_query, reference, refined_);
    if (!(refined_.residual < best_.residual)) { return; }
    std::swap(best_, refined_);
    if (best_.inliers == refined_.inliers) { return; }  // whose fit this is: the next one would be the same
  }
}

std::vector<Match> with_distances(std::span<const IndexPair> inliers, std::span<const Match> matches, Distance distance,
                                  const DescriptorRows& query, const DescriptorRows& reference) {
  std::vector<Match> result;
  result.reserve(inliers.size());
  for (const IndexPair& pair : inliers) {
    const auto same = std::ranges::find_if(
        matches, [&](const Match& match) { return match.query == pair.query && match.reference == pair.reference; });
    const float known = same != matches.end()
                            ? same->distance
                            : descriptor_distance(distance, query, pair.query, reference, pair.reference);
    result.push_back({pair.query, pair.reference, known});
  }
  return result;
}

std::optional<Alignment> align(const Features& query, const Features& reference, std::span<const Match> matches,
                               const RansacParams& params) {
  const KeypointTable query_table = table_of(query.keypoints);
  const KeypointTable reference_table = table_of(reference.keypoints);
  Ransac ransac(params);
  ransac.set_query(query_table.columns());
  const std::optional<PairAlignment> found = ransac.align(reference_table.columns(), matches);
  if (!found) { return std::nullopt; }
  return Alignment{found->reference_from_query, ransac.covariance(),
                   with_distances(ransac.inliers(), matches, Distance::chi_square, rows_of(query.descriptors),
                                  rows_of(reference.descriptors)),
                   found->residual};
}

}  // namespace flirt
