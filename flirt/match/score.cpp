// flirt/match/score.cpp: scoring and pre-checks of hypotheses, compiled once per instruction set.
#include "flirt/match/score.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/match/score.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
#include "flirt/match/lanes-inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace flirt::HWY_NAMESPACE {
namespace {

/// The query points of one group of 16 after a motion.
struct MovedGroup {
  FloatVector x[parts];
  FloatVector y[parts];
};

HWY_INLINE MovedGroup move_group(const Motion& motion, const float* x, const float* y) {
  const Floats d;
  const auto cosine = hn::Set(d, motion.cosine);
  const auto sine = hn::Set(d, motion.sine);
  MovedGroup moved;
  for (std::size_t part = 0; part < parts; ++part) {
    const auto from_x = hn::LoadU(d, x + part * lanes);
    const auto from_y = hn::LoadU(d, y + part * lanes);
    moved.x[part] = hn::Add(hn::Sub(hn::Mul(cosine, from_x), hn::Mul(sine, from_y)), hn::Set(d, motion.x));
    moved.y[part] = hn::Add(hn::Add(hn::Mul(sine, from_x), hn::Mul(cosine, from_y)), hn::Set(d, motion.y));
  }
  return moved;
}

HWY_INLINE FloatVector squared_distance(const MovedGroup& moved, std::size_t part, FloatVector x, FloatVector y) {
  const auto dx = hn::Sub(moved.x[part], x);
  const auto dy = hn::Sub(moved.y[part], y);
  return hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
}

/// min(d², limit) for `Vectors` vectors of points. Several at once, as one alone waits for its own results.
template <std::size_t Vectors>
HWY_INLINE void truncated_distances(const float* moved_x, const float* moved_y, const KeypointColumns& reference,
                                    float limit, float* squared) {
  const Floats d;
  FloatVector point_x[Vectors];
  FloatVector point_y[Vectors];
  FloatVector smallest[Vectors];
  for (std::size_t v = 0; v < Vectors; ++v) {
    point_x[v] = hn::LoadU(d, moved_x + v * lanes);
    point_y[v] = hn::LoadU(d, moved_y + v * lanes);
    smallest[v] = hn::Set(d, limit);
  }
  for (std::size_t j = 0; j < reference.size(); ++j) {
    const auto x = hn::Set(d, reference.x[j]);
    const auto y = hn::Set(d, reference.y[j]);
    for (std::size_t v = 0; v < Vectors; ++v) {
      const auto dx = hn::Sub(point_x[v], x);
      const auto dy = hn::Sub(point_y[v], y);
      smallest[v] = hn::Min(smallest[v], hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
    }
  }
  for (std::size_t v = 0; v < Vectors; ++v) { hn::StoreU(smallest[v], d, squared + v * lanes); }
}

/// The points of all motions lie behind each other, without gaps, so that no vector is half empty.
void truncated_costs(const Motion* motions, std::size_t count, const ScoredPoints& query,
                     const KeypointColumns& reference, float limit, MovedPoints& moved, float* costs) {
  const Floats d;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t first = 0; first < query.count; first += 16) {
      const MovedGroup group = move_group(motions[i], query.x.data() + first, query.y.data() + first);
      for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t at = i * query.count + first + part * lanes;
        hn::StoreU(group.x[part], d, moved.x.data() + at);
        hn::StoreU(group.y[part], d, moved.y.data() + at);
      }
    }
  }
  constexpr std::size_t at_once = 4;
  const auto distances = [&](std::size_t first, auto vectors) HWY_ATTR {
    truncated_distances<vectors.value>(moved.x.data() + first, moved.y.data() + first, reference, limit,
                                       moved.squared.data() + first);
  };
  const std::size_t points = count * query.count;
  std::size_t first = 0;
  for (; first + (at_once - 1) * lanes < points; first += at_once * lanes) {
    distances(first, std::integral_constant<std::size_t, at_once>{});
  }
  for (; first + lanes < points; first += 2 * lanes) { distances(first, std::integral_constant<std::size_t, 2>{}); }
  if (first < points) { distances(first, std::integral_constant<std::size_t, 1>{}); }

  for (std::size_t i = 0; i < count; ++i) {
    costs[i] = 0.0F;
    for (std::size_t group = 0; group < query.count; group += 16) {
      FloatVector squared[parts];
      for (std::size_t part = 0; part < parts; ++part) {
        squared[part] = hn::Mul(hn::LoadU(d, moved.squared.data() + i * query.count + group + part * lanes),
                                hn::LoadU(d, query.weight.data() + group + part * lanes));
      }
      costs[i] += sum_of_group(squared);
    }
  }
}

/// For `Groups` groups of 16 points from `first`. Two at once, as one alone waits for its own results.
template <std::size_t Groups>
HWY_INLINE void nearest_points_of(const Motion& motion, const ScoredPoints& query, std::size_t first,
                                  const KeypointColumns& reference, std::uint32_t* nearest, float* squared) {
  const Floats d;
  const hn::RebindToUnsigned<Floats> du;
  MovedGroup moved[Groups];
  FloatVector smallest[Groups][parts];
  hn::Vec<decltype(du)> index[Groups][parts];
  for (std::size_t group = 0; group < Groups; ++group) {
    moved[group] = move_group(motion, query.x.data() + first + 16 * group, query.y.data() + first + 16 * group);
    for (std::size_t part = 0; part < parts; ++part) {
      smallest[group][part] = hn::Set(d, 3e38F);
      index[group][part] = hn::Zero(du);
    }
  }
  for (std::uint32_t j = 0; j < reference.size(); ++j) {
    const auto x = hn::Set(d, reference.x[j]);
    const auto y = hn::Set(d, reference.y[j]);
    for (std::size_t group = 0; group < Groups; ++group) {
      for (std::size_t part = 0; part < parts; ++part) {
        const auto distance = squared_distance(moved[group], part, x, y);
        const auto smaller = hn::Lt(distance, smallest[group][part]);
        smallest[group][part] = hn::Min(distance, smallest[group][part]);
        index[group][part] = hn::IfThenElse(hn::RebindMask(du, smaller), hn::Set(du, j), index[group][part]);
      }
    }
  }
  for (std::size_t group = 0; group < Groups; ++group) {
    for (std::size_t part = 0; part < parts; ++part) {
      hn::StoreU(index[group][part], du, nearest + 16 * group + part * lanes);
      hn::StoreU(smallest[group][part], d, squared + 16 * group + part * lanes);
    }
  }
}

void nearest_points(const Motion& motion, const ScoredPoints& query, const KeypointColumns& reference,
                    std::uint32_t* nearest, float* squared) {
  std::size_t first = 0;
  for (; first + 16 < query.count; first += 32) {
    nearest_points_of<2>(motion, query, first, reference, nearest + first, squared + first);
  }
  if (first < query.count) { nearest_points_of<1>(motion, query, first, reference, nearest + first, squared + first); }
}

void fill_turns(CandidateColumns& c) {
  const Floats d;
  for (std::size_t first = 0; first < c.count; first += lanes) {
    const auto turn = hn::LoadU(d, c.turn.data() + first);
    hn::StoreU(hn::Cos(d, turn), d, c.turn_cosine.data() + first);
    hn::StoreU(hn::Sin(d, turn), d, c.turn_sine.data() + first);
  }
}

/// Which of the candidates [first, first + lanes) may move together with candidate j.
HWY_INLINE hn::Mask<Floats> are_rigid(const CandidateColumns& c, std::size_t j, const PairLimits& limits,
                                      std::size_t first) {
  const Floats d;
  const auto query_x = hn::Sub(hn::LoadU(d, c.query_x.data() + first), hn::Set(d, c.query_x[j]));
  const auto query_y = hn::Sub(hn::LoadU(d, c.query_y.data() + first), hn::Set(d, c.query_y[j]));
  const auto reference_x = hn::Sub(hn::LoadU(d, c.reference_x.data() + first), hn::Set(d, c.reference_x[j]));
  const auto reference_y = hn::Sub(hn::LoadU(d, c.reference_y.data() + first), hn::Set(d, c.reference_y[j]));
  const auto query_squared = hn::Add(hn::Mul(query_x, query_x), hn::Mul(query_y, query_y));
  const auto reference_squared = hn::Add(hn::Mul(reference_x, reference_x), hn::Mul(reference_y, reference_y));

  const auto change = hn::Sub(query_squared, reference_squared);
  const auto allowed = hn::Mul(hn::Set(d, 8.0F * limits.length_change), hn::Add(query_squared, reference_squared));
  auto rigid = hn::Le(hn::Mul(change, change), allowed);
  rigid = hn::And(rigid, hn::Gt(hn::Min(query_squared, reference_squared), hn::Set(d, limits.shortest_squared)));

  // The segment's turn, as a complex number of length d1·d2, against the turns of both keypoints.
  const auto turn_x = hn::Add(hn::Mul(query_x, reference_x), hn::Mul(query_y, reference_y));
  const auto turn_y = hn::Sub(hn::Mul(query_x, reference_y), hn::Mul(query_y, reference_x));
  const auto with_i = hn::Add(hn::Mul(turn_x, hn::LoadU(d, c.turn_cosine.data() + first)),
                              hn::Mul(turn_y, hn::LoadU(d, c.turn_sine.data() + first)));
  const auto with_j =
      hn::Add(hn::Mul(turn_x, hn::Set(d, c.turn_cosine[j])), hn::Mul(turn_y, hn::Set(d, c.turn_sine[j])));
  // worse ≥ cosine · d1·d2, both sides times their own size, which is cheaper than a root.
  const auto worse = hn::Min(with_i, with_j);
  const auto least =
      hn::Mul(hn::Set(d, limits.turn_cosine * std::abs(limits.turn_cosine)), hn::Mul(query_squared, reference_squared));
  return hn::And(rigid, hn::Ge(hn::Mul(worse, hn::Abs(worse)), least));
}

/// Bit i of row j, rows of `groups` · 16 bits. No branch here depends on what is found.
void mark_rigid_pairs(const CandidateColumns& candidates, std::size_t count, const PairLimits& limits,
                      std::size_t groups, std::uint16_t* bits) {
  for (std::size_t j = 1; j < count; ++j) {
    for (std::size_t group = 0; group * 16 < j; ++group) {
      const std::uint16_t rigid = bits_of_group(
          [&](std::size_t part) HWY_ATTR { return are_rigid(candidates, j, limits, group * 16 + part * lanes); });
      const std::uint32_t before_j = j - group * 16 < 16 ? (1U << (j - group * 16)) - 1U : 0xFFFFU;
      bits[j * groups + group] = static_cast<std::uint16_t>(rigid & before_j);
    }
  }
}

}  // namespace
}  // namespace flirt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt {
namespace {

HWY_EXPORT(truncated_costs);
HWY_EXPORT(nearest_points);
HWY_EXPORT(mark_rigid_pairs);
HWY_EXPORT(fill_turns);

std::size_t padded(std::size_t count) {
  return (count + 15) / 16 * 16;
}

/// From candidate i to candidate j, in both scans.
struct Segment {
  float query_x, query_y, reference_x, reference_y;  ///< m

  /// The turn from query to reference as a complex number; its length is the product of both lengths.
  [[nodiscard]] float turn_x() const { return query_x * reference_x + query_y * reference_y; }
  [[nodiscard]] float turn_y() const { return query_x * reference_y - query_y * reference_x; }
};

Segment segment_of(const CandidateColumns& c, std::size_t i, std::size_t j) {
  return {c.query_x[j] - c.query_x[i], c.query_y[j] - c.query_y[i], c.reference_x[j] - c.reference_x[i],
          c.reference_y[j] - c.reference_y[i]};
}

}  // namespace

Motion motion_of(const RigidMotion& motion) {
  return {static_cast<float>(motion.cosine), static_cast<float>(motion.sine), static_cast<float>(motion.translation.x),
          static_cast<float>(motion.translation.y)};
}

RigidMotion rigid_motion_of(const Motion& motion) {
  const double cosine{motion.cosine};
  const double sine{motion.sine};
  const double length = std::sqrt(cosine * cosine + sine * sine);
  return {cosine / length, sine / length, {double{motion.x}, double{motion.y}}};
}

void ScoredPoints::assign(const KeypointColumns& keypoints) {
  count = keypoints.size();
  farthest = 0.0F;
  x.assign(padded(count), 0.0F);
  y.assign(padded(count), 0.0F);
  weight.assign(padded(count), 0.0F);
  for (std::size_t i = 0; i < count; ++i) {
    const bool in_sight = std::abs(keypoints.x[i]) < out_of_sight;
    x[i] = in_sight ? keypoints.x[i] : 0.1F * out_of_sight;  // elsewhere than such points of the reference
    y[i] = in_sight ? keypoints.y[i] : 0.0F;
    weight[i] = 1.0F;
    if (in_sight) { farthest = std::max(farthest, std::abs(x[i]) + std::abs(y[i])); }
  }
}

void truncated_costs(std::span<const Motion> motions, const ScoredPoints& query, const KeypointColumns& reference,
                     float limit, MovedPoints& workspace, std::span<float> costs) {
  FLIRT_ASSERT(costs.size() == motions.size());
  const std::size_t at_once = std::min<std::size_t>(64, motions.size());  // whose points stay near the processor
  for (AlignedVector<float>* column : {&workspace.x, &workspace.y, &workspace.squared}) {
    column->resize(std::max(column->size(), at_once * query.count + 64), 0.0F);
  }
  for (std::size_t first = 0; first < motions.size(); first += at_once) {
    const std::size_t count = std::min(at_once, motions.size() - first);
    HWY_DYNAMIC_DISPATCH(truncated_costs)
    (motions.data() + first, count, query, reference, limit, workspace, costs.data() + first);
  }
}

void nearest_points(const Motion& reference_from_query, const ScoredPoints& query, const KeypointColumns& reference,
                    std::span<std::uint32_t> nearest, std::span<float> squared) {
  FLIRT_ASSERT(nearest.size() >= padded(query.count) && squared.size() >= padded(query.count));
  HWY_DYNAMIC_DISPATCH(nearest_points)(reference_from_query, query, reference, nearest.data(), squared.data());
}

void CandidateColumns::resize(std::size_t candidates) {
  count = candidates;
  for (AlignedVector<float>* column :
       {&query_x, &query_y, &reference_x, &reference_y, &turn, &turn_cosine, &turn_sine}) {
    column->resize(std::max(column->size(), padded(candidates)), 0.0F);
  }
}

void fill_turns(CandidateColumns& candidates) {
  HWY_DYNAMIC_DISPATCH(fill_turns)(candidates);
}

void rigid_pairs(const CandidateColumns& candidates, std::size_t count, const PairLimits& limits, RigidPairs& pairs) {
  FLIRT_ASSERT(count <= candidates.count);
  const std::size_t groups = std::bit_ceil(padded(count) / 16);
  const std::size_t words = (count * groups + 3) / 4;
  pairs.bits.assign(4 * words, 0);
  HWY_DYNAMIC_DISPATCH(mark_rigid_pairs)(candidates, count, limits, groups, pairs.bits.data());
  pairs.pairs.clear();
  const auto row_shift = static_cast<std::size_t>(std::countr_zero(16 * groups));
  for (std::size_t word = 0; word < words; ++word) {
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < 4; ++k) { bits |= std::uint64_t{pairs.bits[4 * word + k]} << (16 * k); }
    for (; bits != 0; bits &= bits - 1) {
      const std::size_t bit = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
      const std::size_t j = bit >> row_shift;
      pairs.pairs.push_back({static_cast<std::uint32_t>(bit - (j << row_shift)), static_cast<std::uint32_t>(j)});
    }
  }
}

bool is_rigid_pair(const CandidateColumns& candidates, std::size_t i, std::size_t j, const PairLimits& limits) {
  const Segment segment = segment_of(candidates, i, j);
  const float query_squared = segment.query_x * segment.query_x + segment.query_y * segment.query_y;
  const float reference_squared = segment.reference_x * segment.reference_x + segment.reference_y * segment.reference_y;
  const float change = query_squared - reference_squared;
  const float least = limits.turn_cosine * std::abs(limits.turn_cosine) * (query_squared * reference_squared);
  const auto agrees = [&](std::size_t k) {
    const float with_k = segment.turn_x() * candidates.turn_cosine[k] + segment.turn_y() * candidates.turn_sine[k];
    return with_k * std::abs(with_k) >= least;
  };
  return change * change <= 8.0F * limits.length_change * (query_squared + reference_squared) &&
         std::min(query_squared, reference_squared) > limits.shortest_squared && agrees(i) && agrees(j);
}

float squared_distance_after(const Motion& reference_from_query, const CandidateColumns& candidates, std::size_t i) {
  const float dx = reference_from_query.cosine * candidates.query_x[i] -
                   reference_from_query.sine * candidates.query_y[i] + reference_from_query.x -
                   candidates.reference_x[i];
  const float dy = reference_from_query.sine * candidates.query_x[i] +
                   reference_from_query.cosine * candidates.query_y[i] + reference_from_query.y -
                   candidates.reference_y[i];
  return dx * dx + dy * dy;
}

Motion motion_of_segment(const CandidateColumns& c, std::size_t i, std::size_t j) {
  const Segment segment = segment_of(c, i, j);
  const float turn_x = segment.turn_x();
  const float turn_y = segment.turn_y();
  const float length = std::sqrt(turn_x * turn_x + turn_y * turn_y);
  const float cosine = turn_x / length;
  const float sine = turn_y / length;
  const float middle_x = 0.5F * (c.query_x[i] + c.query_x[j]);
  const float middle_y = 0.5F * (c.query_y[i] + c.query_y[j]);
  return {cosine, sine, 0.5F * (c.reference_x[i] + c.reference_x[j]) - (cosine * middle_x - sine * middle_y),
          0.5F * (c.reference_y[i] + c.reference_y[j]) - (sine * middle_x + cosine * middle_y)};
}

}  // namespace flirt
#endif
