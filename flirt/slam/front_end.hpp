// flirt/slam/front_end.hpp: the seam between mapping and the ways to find the motion from one scan to the next.
//
// A front-end is a class with `ScanMotion add(const SlamScan&)`, one alternative of the variant in front_ends.hpp, and
// a name in FrontEndKind. It knows nothing of loops and of the map's frame: it answers with motions relative to earlier
// scans.
#pragma once

#include "flirt/core/pose2.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// How the pose of a scan was found.
enum class MotionSource : std::uint8_t {
  first,       ///< it is the first
  narrow,      ///< near the prediction
  wide,        ///< only a wide search found it
  prediction,  ///< nothing in the scan was to be believed: odometry, or the motion before
};
constexpr auto enum_names(MotionSource /*tag*/) {
  using enum MotionSource;
  return std::array<std::pair<MotionSource, std::string_view>, 4>{
      {{first, "first"}, {narrow, "narrow"}, {wide, "wide"}, {prediction, "prediction"}}};
}

/// What a scan's keypoints say about the place (P1 §4.2), where a front-end looks at them.
enum class Structure : std::uint8_t {
  unknown,      ///< not looked at
  structured,   ///< keypoints, and they agree with other scans
  featureless,  ///< few keypoints, and they do not agree
  cluttered,    ///< many keypoints of which few agree with the scan before: clutter, or no plane world
};
constexpr auto enum_names(Structure /*tag*/) {
  using enum Structure;
  return std::array<std::pair<Structure, std::string_view>, 4>{
      {{unknown, "unknown"}, {structured, "structured"}, {featureless, "featureless"}, {cluttered, "cluttered"}}};
}

/// A scan's pose relative to one `back` scans earlier.
struct RelativeMotion {
  std::uint32_t back{1};
  Pose2 earlier_from_robot{};
  Eigen::Matrix3d information{Eigen::Matrix3d::Identity()};  ///< as PoseEdge::information
};

/// What a front-end says of one scan.
struct ScanMotion {
  MotionSource source{MotionSource::first};
  std::vector<RelativeMotion> relative{};  ///< the first is relative to the scan before; empty for the first scan
  double score{0};                         ///< how well the scan agrees with the scans before
  bool unobservable{false};                ///< some direction of the motion cannot be seen in the scan
  Structure structure{Structure::unknown};
};

}  // namespace flirt
