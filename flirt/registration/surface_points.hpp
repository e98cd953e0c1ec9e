// flirt/registration/surface_points.hpp: a scan as small pieces of surface in the robot's frame, ready to be aligned.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/core/scan.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

struct SurfacePointParams {
  double spacing{0.08};     ///< m, least distance between consecutive points that are kept
  double fit_radius{0.15};  ///< m, neighbours that a piece of surface is fitted to; more where beams are far apart
  double in_line{0.0524};   ///< rad, bend up to which two neighbours that are far apart lie in line with a point
  double range_min{0.05};   ///< m, shorter readings are not used
  double range_max{40.0};   ///< m, longer readings are not used
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, SurfacePointParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.spacing, Field{"spacing", "m", "least distance between points that are kept", 0.01, 1.0});
  visit(params.fit_radius, Field{"fit_radius", "m", "neighbours that a piece of surface is fitted to", 0.01, 1.0});
  visit(params.in_line, Field{"in_line", "rad", "bend up to which neighbours far apart are in line", 0.0, 0.5});
  visit(params.range_min, Field{"surface_range_min", "m", "shorter readings are not used", 0.0, 10.0});
  visit(params.range_max, Field{"surface_range_max", "m", "longer readings are not used", 0.1, 40.0});
}

/// End points in order of increasing bearing from `origin`, each moved onto the line through its neighbours where
/// there is one (which takes out most of the noise), with the normal of that line. Along a corridor neighbours lie far
/// apart: there the next ones count that lie in line with it (`in_line`, 1 m). A point without a line holds a scan in
/// all directions, and where beams meet a wall at a grazing angle moves with the robot.
struct SurfacePoints {
  Point2 origin{};                ///< m, the sensor in the robot's frame; bearings are taken from here
  std::vector<float> x{};         ///< m, robot frame
  std::vector<float> y{};         ///< m
  std::vector<float> normal_x{};  ///< unit vector towards the sensor; (0, 0) where no line fits
  std::vector<float> normal_y{};
  std::vector<float> bearing{};              ///< rad, about `origin`, robot frame, (−π, π], ascending
  std::vector<std::uint16_t> first_after{};  ///< per bin of bearing, the first point at or after the bin's lower end

  static constexpr std::size_t bins = 256;  ///< of a full turn

  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// Keeps the first end point, and each that lies at least `spacing` from the last one kept. At most 65535 points.
/// O(beams · neighbours).
[[nodiscard]] SurfacePoints surface_points(const Scan& scan, const SurfacePointParams& params = {});

/// Every `stride`-th point as seen from another robot, for moving several scans together. Without the index of bearings
/// that looking points up needs.
[[nodiscard]] SurfacePoints seen_from(const SurfacePoints& points, const Pose2& other_from_robot,
                                      std::size_t stride = 1);

}  // namespace flirt
