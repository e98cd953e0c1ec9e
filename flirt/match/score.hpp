// flirt/match/score.hpp: the three inner loops of the search for a rigid motion, vectorised.
#pragma once

#include "flirt/core/aligned_vector.hpp"
#include "flirt/match/columns.hpp"
#include "flirt/match/rigid.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// A rigid motion in single precision with its rotation ready for use: reference_from_query.
struct Motion {
  float cosine{1};
  float sine{0};
  float x{0};  ///< m
  float y{0};  ///< m
};
[[nodiscard]] Motion motion_of(const RigidMotion& motion);
/// In double precision, of which the rotation is one.
[[nodiscard]] RigidMotion rigid_motion_of(const Motion& motion);

/// Query keypoints padded to groups of 16; padding has weight 0.
struct ScoredPoints {
  AlignedVector<float> x;       ///< m, query frame
  AlignedVector<float> y;       ///< m, query frame
  AlignedVector<float> weight;  ///< 1 for a point
  std::size_t count{0};
  float farthest{0};  ///< m, no point in sight is farther from the sensor

  void assign(const KeypointColumns& keypoints);
};

/// Query points after several motions.
struct MovedPoints {
  AlignedVector<float> x, y;     ///< m, reference frame
  AlignedVector<float> squared;  ///< m², to the nearest reference point, or the limit
};

/// For each motion Σ over query points of min(d², limit), d the distance to the nearest reference point after the
/// motion, m². O(motions · query · reference).
void truncated_costs(std::span<const Motion> motions, const ScoredPoints& query, const KeypointColumns& reference,
                     float limit, MovedPoints& workspace, std::span<float> costs);

/// For each query point the nearest reference point after the motion, of equal ones the first, and its squared
/// distance, m²; both have room for the padded count.
void nearest_points(const Motion& reference_from_query, const ScoredPoints& query, const KeypointColumns& reference,
                    std::span<std::uint32_t> nearest, std::span<float> squared);

/// Candidate correspondences as columns, padded to groups of 16: both points and the turn of the keypoint's direction.
struct CandidateColumns {
  AlignedVector<float> query_x, query_y;          ///< m, query frame
  AlignedVector<float> reference_x, reference_y;  ///< m, reference frame
  AlignedVector<float> turn;  ///< rad, of the keypoint's direction from query to reference, in (−2π, 2π)
  AlignedVector<float> turn_cosine, turn_sine;  ///< see fill_turns
  std::size_t count{0};

  void resize(std::size_t candidates);
};

/// Sets turn_cosine and turn_sine from turn.
void fill_turns(CandidateColumns& candidates);

/// When two candidates may be two points of one rigid body.
struct PairLimits {
  float length_change{0};     ///< m², bound on (d1² − d2²)² / (8 (d1² + d2²)), d the segment in query and reference
  float shortest_squared{0};  ///< m², segments must be longer than that in both scans
  float turn_cosine{-2};      ///< cosine of the largest angle between the segment's turn and a keypoint's; −2: any
};

/// Two candidates, i < j.
struct CandidatePair {
  std::uint32_t i{0};
  std::uint32_t j{0};

  friend bool operator==(const CandidatePair&, const CandidatePair&) = default;
};

/// Pairs that may move together.
struct RigidPairs {
  std::vector<CandidatePair> pairs;
  std::vector<std::uint16_t> bits;  ///< workspace
};

/// The pairs among the first `count` candidates that may move together, by j, then by i. O(count²).
void rigid_pairs(const CandidateColumns& candidates, std::size_t count, const PairLimits& limits, RigidPairs& pairs);

/// The same test for one pair, i ≠ j.
[[nodiscard]] bool is_rigid_pair(const CandidateColumns& candidates, std::size_t i, std::size_t j,
                                 const PairLimits& limits);

/// Between the two keypoints of candidate i after the motion, m².
[[nodiscard]] float squared_distance_after(const Motion& reference_from_query, const CandidateColumns& candidates,
                                           std::size_t i);

/// The motion that maps the middle and the direction of segment (i, j): least squares over two pairs.
[[nodiscard]] Motion motion_of_segment(const CandidateColumns& candidates, std::size_t i, std::size_t j);

}  // namespace flirt
