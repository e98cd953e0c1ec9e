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
  std::uint32_t ranking_rays{20};  ///< beams, evenly picked, that are followed when coarse poses are ranked
  double ray_weight{1.0};          ///< coarse value lost when all beams cross something solid
  std::uint32_t refined{60};       ///< best ranked coarse poses that are refined and scored
  std::uint32_t unranked{10};      ///< of them the best by coarse value alone, whatever their beams cross
  double distinct_distance{0.5};   ///< m, poses nearer than this and
  double distinct_heading{radians_from_degrees(10)};  ///< rad, turned less than this are one pose
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, SearchParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit_fields(params.points, visit);
  visit_fields(params.dense, visit);
  visit_fields(params.score, visit);
  visit_fields(params.refine, visit);
  visit(params.ranking_rays, Field{"ranking_rays", "", "beams followed when coarse poses are ranked", 1, 10000});
  visit(params.ray_weight, Field{"ray_weight", "", "coarse value lost when all beams cross something solid", 0, 10});
  visit(params.refined, Field{"refined", "", "best ranked coarse poses that are refined", 1, 100000});
  visit(params.unranked, Field{"unranked", "", "of them the best by coarse value alone", 0, 100000});
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

/// The `params.refined` best of `coarse` (best first, as dense_search gives them) by value and by beams that cross
/// something solid, best first; before them, and counted among them, the `params.unranked` best by value alone.
[[nodiscard]] std::vector<Pose2> ranked_candidates(const MapFields& fields, const ScanPoints& points,
                                                   std::span<const CoarsePose> coarse, const SearchParams& params = {});

/// Dense search, ranking by beams, refinement, score, merge.
[[nodiscard]] std::vector<ScoredPose> search(const MapFields& fields, const ScanPoints& points,
                                             const SearchParams& params = {});
[[nodiscard]] std::vector<ScoredPose> search(const MapFields& fields, const Scan& scan,
                                             const SearchParams& params = {});

}  // namespace flirt
