// flirt/registration/search.hpp: where in a map a scan was taken, without any prior: all distinct poses that explain
// it, best first.
//
//   const MapFields fields = map_fields(grid);                       // once a map
//   const std::vector<ScoredPose> poses = search(fields, scan);      // any number of threads may ask
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/registration/dense_search.hpp"
#include "flirt/registration/evidence_score.hpp"
#include "flirt/registration/map_fields.hpp"
#include "flirt/registration/refine.hpp"
#include "flirt/registration/scan_points.hpp"

#include <Eigen/Core>

#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

struct SearchParams {
  ScanPointParams points{};
  DenseSearchParams dense{};
  EvidenceScoreParams score{};
  RefineParams refine{};
  std::uint32_t heat_steps{1};           ///< iterations of refinement in each heat (see `finalists`)
  std::uint32_t first_heat_points{30};   ///< end points, evenly picked, of the first heat
  std::uint32_t second_heat{200};        ///< best coarse poses of the first heat that get into the second
  std::uint32_t second_heat_points{60};  ///< end points, evenly picked, of the second heat
  std::uint32_t heat_rays{20};           ///< beams, evenly picked, that are followed after the second heat
  std::uint32_t refined{30};             ///< best of the second heat that are refined to the end and scored
  double distinct_distance{0.5};         ///< m, poses nearer than this and
  double distinct_heading{radians_from_degrees(10)};  ///< rad, turned less than this are one pose
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, SearchParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit_fields(params.points, visit);
  visit_fields(params.dense, visit);
  visit_fields(params.score, visit);
  visit_fields(params.refine, visit);
  visit(params.heat_steps, Field{"heat_steps", "", "iterations of refinement in each heat", 0, 100});
  visit(params.first_heat_points, Field{"first_heat_points", "", "end points of the first heat", 1, 10000});
  visit(params.second_heat, Field{"second_heat", "", "coarse poses that get into the second heat", 1, 100000});
  visit(params.second_heat_points, Field{"second_heat_points", "", "end points of the second heat", 1, 10000});
  visit(params.heat_rays, Field{"heat_rays", "", "beams followed after the second heat", 1, 10000});
  visit(params.refined, Field{"refined", "", "best of the second heat that are refined to the end", 1, 100000});
  visit(params.distinct_distance, Field{"distinct_distance", "m", "poses nearer than this may be one", 0, 10});
  visit(params.distinct_heading, Field{"distinct_heading", "rad", "poses turned less than this may be one", 0, 3.2});
}

/// A refined pose with what the map's evidence says about it.
struct ScoredPose {
  Pose2 map_from_sensor;
  EvidenceScore score;
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};  ///< of (x, y, theta), map frame: m², m·rad, rad²
  double support{0};                                    ///< see RefinedPose
};

/// Refines and scores poses from any source, in their order; those that end where an earlier one ended (0.02 m, 0.2°)
/// are left out. O(poses · points).
[[nodiscard]] std::vector<ScoredPose> judge(const MapFields& fields, const ScanPoints& points,
                                            std::span<const Pose2> map_from_sensor, const SearchParams& params = {});

/// The most preferred first; of poses that are not distinct only the best stays. O(n²) at worst, n the number of
/// distinct poses.
[[nodiscard]] std::vector<ScoredPose> distinct(std::vector<ScoredPose> poses, const SearchParams& params = {});

/// The `params.refined` of `coarse` that are worth being refined to the end, drawn a little closer, most promising
/// first. Two heats: in each all poses are drawn closer by `heat_steps` and the best by preference stay; few end points
/// decide the first, more of them, and beams, the second. A coarse pose 0.1 m and a degree off says little of the
/// place: one step, even by every fourth point, says more than all beams did before it. O(coarse poses · points of a
/// heat).
[[nodiscard]] std::vector<Pose2> finalists(const MapFields& fields, const ScanPoints& points,
                                           std::span<const CoarsePose> coarse, const SearchParams& params = {});

/// Dense search, heats, refinement, score, merge.
[[nodiscard]] std::vector<ScoredPose> search(const MapFields& fields, const ScanPoints& points,
                                             const SearchParams& params = {});
[[nodiscard]] std::vector<ScoredPose> search(const MapFields& fields, const Scan& scan,
                                             const SearchParams& params = {});

}  // namespace flirt
