#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flirt/features/beta_grid_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for every target.
#include "flirt/features/beta_grid_kernel.hpp"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flirt::beta_grid_kernel::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, lanes>;
using Vector = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

/// A course in every lane.
struct Broadcast {
  Vector direction_x, direction_y, side, distance, across_squared, from, to;
};

/// Where a course crosses some sides.
struct Crossings {
  Mask exist;
  Vector along;  ///< m, where they exist
};

/// The course meets the half line along v at across · (u · v) / (u × v), if v points to the course's side of the
/// keypoint. Products and sums are rounded one by one, so that every vector width gives the same bits.
HWY_INLINE Crossings crossings(const Broadcast& course, const double* x, const double* y) {
  const Tag d;
  const Vector edge_x = hn::LoadU(d, x);
  const Vector edge_y = hn::LoadU(d, y);
  const Vector cosine = hn::Add(hn::Mul(course.direction_x, edge_x), hn::Mul(course.direction_y, edge_y));
  const Vector sine = hn::Sub(hn::Mul(course.direction_x, edge_y), hn::Mul(course.direction_y, edge_x));
  const Vector towards = hn::Mul(course.side, sine);
  return {hn::Gt(towards, hn::Zero(d)), hn::Div(hn::Mul(course.distance, cosine), towards)};
}

/// The parts of a course in some wedges, of positive length only where `within`.
struct Parts {
  Mask within;
  Vector from;
  Vector to;
};

/// The position angle of a point on the course turns by half a circle, from where it comes to where it goes: a wedge
/// that has neither side in between lies behind the keypoint; one that has only its exit there is where the course
/// comes from, one that has only its entry where it goes.
HWY_INLINE Parts parts(const Broadcast& course, const Crossings& entry, const Crossings& exit) {
  const Tag d;
  const Vector from = hn::IfThenElse(entry.exist, hn::Max(entry.along, course.from), course.from);
  const Vector last = hn::IfThenElse(entry.exist, course.to, course.from);
  const Vector to = hn::IfThenElse(exit.exist, hn::Min(exit.along, course.to), last);
  return {hn::Gt(hn::Sub(to, from), hn::Set(d, least_length)), from, to};
}

/// Along such a part the distance to the keypoint takes every value between its least and its greatest: the rings met
/// are those between the two. The bin in which the course ends, at `end_squared` (m²; negative: it does not), gets the
/// hit only.
HWY_INLINE void count_rings(const Broadcast& course, const Parts& part, double end_squared, const Rings& rings,
                            std::size_t stride, const Counts& counts) {
  const Tag d;
  const Vector from_squared = hn::Mul(part.from, part.from);
  const Vector to_squared = hn::Mul(part.to, part.to);
  const Mask turns = hn::And(hn::Lt(part.from, hn::Zero(d)), hn::Gt(part.to, hn::Zero(d)));
  const Vector nearest = hn::Add(course.across_squared, hn::IfThenZeroElse(turns, hn::Min(from_squared, to_squared)));
  const Vector farthest =
      hn::IfThenElseZero(part.within, hn::Add(course.across_squared, hn::Max(from_squared, to_squared)));
  const Vector one = hn::Set(d, 1.0);
  for (std::size_t j = 0; j < rings.low_squared.size(); ++j) {
    const double low = rings.low_squared[j];
    const double high = rings.high_squared[j];
    Mask is_met = hn::And(hn::Gt(farthest, hn::Set(d, low)), hn::Lt(nearest, hn::Set(d, high)));
    if (end_squared >= low && end_squared < high) {
      const Mask is_hit = hn::And(part.within, hn::Eq(part.to, course.to));
      double* const hits = counts.hits + j * stride;
      hn::StoreU(hn::Add(hn::LoadU(d, hits), hn::IfThenElseZero(is_hit, one)), d, hits);
      is_met = hn::AndNot(is_hit, is_met);
    }
    double* const misses = counts.misses + j * stride;
    hn::StoreU(hn::Add(hn::LoadU(d, misses), hn::IfThenElseZero(is_met, one)), d, misses);
  }
}

void count_all(std::span<const Course> courses, const Wedges& wedges, const Rings& rings, const Counts& counts) {
  const Tag d;
  for (const Course& one : courses) {
    const bool clockwise = one.across > 0;
    const double across_squared = one.across * one.across;
    const Broadcast course{hn::Set(d, one.direction_x),
                           hn::Set(d, one.direction_y),
                           hn::Set(d, clockwise ? 1.0 : -1.0),
                           hn::Set(d, clockwise ? one.across : -one.across),
                           hn::Set(d, across_squared),
                           hn::Set(d, one.from),
                           hn::Set(d, one.to)};
    const double end_squared = one.ends_on_something ? across_squared + one.to * one.to : -1.0;
    for (std::size_t k = 0; k < wedges.stride; k += hn::Lanes(d)) {
      const Crossings lower = crossings(course, wedges.lower_x + k, wedges.lower_y + k);
      const Crossings upper = crossings(course, wedges.upper_x + k, wedges.upper_y + k);
      const Parts part = clockwise ? parts(course, upper, lower) : parts(course, lower, upper);
      if (hn::AllFalse(d, part.within)) { continue; }
      count_rings(course, part, end_squared, rings, wedges.stride, {counts.hits + k, counts.misses + k});
    }
  }
}

}  // namespace flirt::beta_grid_kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flirt::beta_grid_kernel {

HWY_EXPORT(count_all);

void count_courses(std::span<const Course> courses, const Wedges& wedges, const Rings& rings, const Counts& counts) {
  HWY_DYNAMIC_DISPATCH(count_all)(courses, wedges, rings, counts);
}

}  // namespace flirt::beta_grid_kernel
#endif
