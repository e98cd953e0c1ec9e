// flirt/registration/refine.hpp: a scan drawn onto the walls of a map, from a pose near the right one.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/registration/map_fields.hpp"
#include "flirt/registration/scan_points.hpp"

#include <Eigen/Core>

#include <concepts>
#include <cstdint>

namespace flirt {

struct RefineParams {
  std::uint32_t iterations{12};      ///< at most
  double start_width{0.3};           ///< m, residual that halves a point's pull, in the first iteration
  double end_width{0.05};            ///< m, the same at the end
  double shrink{0.6};                ///< factor of the width from one iteration to the next
  double before{0.15};               ///< m before a surface that the map must have seen, or nothing is drawn onto it
  double residual_sigma{0.03};       ///< m, standard deviation of a residual when the rms residual is the usual one
  double common_translation{0.003};  ///< m, error that all points share (cells, map), when it is
  double common_rotation{0.0003};    ///< rad, the same of the heading
  double usual_residual{0.015};      ///< m, rms residual of points drawn onto the right surface of a good map
  double unexplained{4};             ///< log of what the variance grows by when the map explains nothing of the scan
  double stop_translation{0.001};    ///< m, shorter steps at the end width stop the iteration
  double stop_rotation{0.0005};      ///< rad
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, RefineParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.iterations, Field{"refine_iterations", "", "iterations of point-to-line alignment", 0, 100});
  visit(params.start_width, Field{"refine_start_width", "m", "residual that halves a pull, at first", 0.01, 5});
  visit(params.end_width, Field{"refine_end_width", "m", "residual that halves a pull, at last", 0.01, 5});
  visit(params.shrink, Field{"refine_shrink", "", "factor of the width between iterations", 0.1, 1});
  visit(params.before, Field{"refine_before", "m", "before a surface that the map must have seen", 0, 1});
  visit(params.residual_sigma, Field{"residual_sigma", "m", "deviation of a residual, for the covariance", 0.001, 1});
  visit(params.common_translation, Field{"common_translation", "m", "error that all points share", 0, 1});
  visit(params.common_rotation, Field{"common_rotation", "rad", "error of the heading that all points share", 0, 1});
  visit(params.usual_residual, Field{"usual_residual", "m", "rms residual on the right surfaces", 0.001, 1});
  visit(params.unexplained, Field{"unexplained", "", "log growth of the variance with what is unexplained", 0, 10});
  visit(params.stop_translation, Field{"stop_translation", "m", "shorter steps end the iteration", 0, 0.1});
  visit(params.stop_rotation, Field{"stop_rotation", "rad", "smaller steps end the iteration", 0, 0.1});
}

struct RefinedPose {
  Pose2 map_from_sensor;
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};  ///< of (x, y, theta) in the map frame: m², m·rad, rad²
  double support{0};                                    ///< mean weight of the end points, 0..1
};

/// Iterated closest lines (point to line where the map has one, point to point on corners and heaps), each residual
/// weighted by 1 / (1 + r² / width²)² (Geman and McClure), the width shrinking. A surface that the map only saw from
/// its other side pulls nothing. The covariance is the inverse of the normal equations at the end, times
/// residual_sigma², and the common errors (residuals of neighbouring points are not independent, so residual_sigma is
/// larger than a range's noise), all times (rms residual / usual_residual)² · exp(unexplained · (1 − support)): the
/// fewer end points the map explains, the likelier is a fit to the wrong surfaces. Set on four simulated buildings,
/// checked on four others (docs/localization.md). Infinite directions (a bare corridor) come out as 1 m or 1 rad.
/// O(iterations · points).
[[nodiscard]] RefinedPose refine(const MapFields& fields, const ScanPoints& points, const Pose2& map_from_sensor,
                                 const RefineParams& params = {});

/// The pose that `refine` ends at, alone.
[[nodiscard]] Pose2 refined_pose(const MapFields& fields, const ScanPoints& points, const Pose2& map_from_sensor,
                                 const RefineParams& params = {});

}  // namespace flirt
