// flirt/features/selection.hpp: from the peaks of all scales to keypoints.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/features/scan_curve.hpp"

#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace flirt {

/// Which of two detections of the same scale within the duplicate radius stays.
enum class Precedence {
  response,  ///< the stronger: does not depend on where the scan starts
  angle,     ///< the one at the smaller angle
};
constexpr auto enum_names(Precedence /*tag*/) {
  return std::to_array<std::pair<Precedence, std::string_view>>(
      {{Precedence::response, "response"}, {Precedence::angle, "angle"}});
}

/// Where a keypoint takes its direction and support region from when it was moved to the foreground.
enum class Anchor {
  keypoint,  ///< the point that it was moved to
  peak,  ///< the point where the signal peaks. A curvature keypoint then points from itself to the smoothed curve at
         ///< the peak, more than `foreground_jump` behind it on the next beam: nearly along the line of sight
};
constexpr auto enum_names(Anchor /*tag*/) {
  return std::to_array<std::pair<Anchor, std::string_view>>({{Anchor::keypoint, "keypoint"}, {Anchor::peak, "peak"}});
}

/// Which peaks become keypoints. None of this is in the papers. The authors' own program has foreground_jump 0,
/// Precedence::angle and, for duplicates, a box along the axes of the world in place of the radius.
struct SelectionParams {
  NoReturn no_return{NoReturn::drop};           ///< what becomes of beams without a return
  bool foreground_shift{true};                  ///< move a detection at a jump of the range to the nearer beam
  double foreground_jump{0.5};                  ///< m; by which that neighbouring beam must be nearer
  Anchor anchor{Anchor::peak};                  ///< of direction and support region after such a move
  double duplicate_radius{0.2};                 ///< m; drop a detection this close to one of a finer scale; 0: keep all
  Precedence precedence{Precedence::response};  ///< between two of the same scale within the radius
};

/// A peak of one scale.
struct Candidate {
  std::uint32_t peak;   ///< index of the curve's point where the signal peaks
  std::uint32_t point;  ///< index of the curve's point where the keypoint lies
  double response;      ///< value of the signal at the peak
  std::uint8_t level;   ///< index of the scale
};

/// The point that a detection at `peak` is moved to: the nearer in range of the points under the two adjacent beams
/// (the one at the larger angle when equally near) if it is nearer than the peak itself, else the peak.
[[nodiscard]] std::uint32_t foreground_point(const ScanCurve& curve, std::uint32_t peak, double jump);

/// Working memory of drop_duplicates.
struct DuplicateWork {
  std::vector<std::uint32_t> order{};
  std::vector<Point2> kept_points{};  ///< m
};

/// Keeps in `candidates` (sorted by level, then peak) those that are not duplicates: each in turn, fine scales first,
/// unless a kept one lies closer than the radius. Two candidates of one level at the same point count once whatever the
/// radius. O(candidates · kept).
void drop_duplicates(const ScanCurve& curve, const SelectionParams& params, DuplicateWork& work,
                     std::vector<Candidate>& candidates);

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, SelectionParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.no_return, Field{"no_return", "", "what becomes of beams without a return"});
  visit(params.foreground_shift, Field{"foreground_shift", "", "move detections to a nearer neighbouring beam"});
  visit(params.foreground_jump, Field{"foreground_jump", "m", "by which that beam must be nearer", 0.0, 1e3});
  visit(params.anchor, Field{"anchor", "", "where direction and support region are taken after such a move"});
  visit(params.duplicate_radius,
        Field{"duplicate_radius", "m", "detections this close are one; 0 keeps all", 0.0, 1e3});
  visit(params.precedence, Field{"precedence", "", "which of two close detections of one scale stays"});
}

}  // namespace flirt
