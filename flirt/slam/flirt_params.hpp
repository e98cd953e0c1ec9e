// flirt/slam/flirt_params.hpp: what can be set about the papers' algorithm 1.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/match/ransac.hpp"

#include <array>
#include <concepts>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <type_traits>
#include <utility>

namespace flirt {

/// Whether the displacement of the keypoints is refined by all points of the two scans (P1 §4.2).
enum class FlirtRefinement : std::uint8_t {
  off,
  icp,  ///< points drawn onto the other scan's lines, from the keypoints' displacement
};
constexpr auto enum_names(FlirtRefinement /*tag*/) {
  return std::array{std::pair{FlirtRefinement::off, std::string_view("off")},
                    std::pair{FlirtRefinement::icp, std::string_view("icp")}};
}

/// Whether constraints must agree with the shortest path in the graph (P1 §3.2).
enum class FlirtGate : std::uint8_t { off, shortest_path };
constexpr auto enum_names(FlirtGate /*tag*/) {
  return std::array{std::pair{FlirtGate::off, std::string_view("off")},
                    std::pair{FlirtGate::shortest_path, std::string_view("shortest-path")}};
}

/// Defaults are the papers' where they give one, but for what docs/slam.md names ("Every front end").
struct FlirtParams {
  std::uint32_t min_inliers{6};        ///< a constraint has more inliers than this (n_min)
  double max_inlier_error{0.05};       ///< m², and a smaller mean squared distance of its inliers (E_max)
  double max_scan_error{0.05};         ///< m, and a smaller reprojection error of both scans in full
  double min_comparable{0.3};          ///< share of each scan's points that the other must tell about (not the papers')
  std::uint32_t best_constraints{15};  ///< of a step, at most
  std::uint32_t featureless_below{10};  ///< keypoints; fewer are a featureless place
  FlirtGate gate{FlirtGate::shortest_path};
  double gate_limit{7.815};  ///< squared Mahalanobis distance: χ²₃ at 0.95
  FlirtRefinement refinement{FlirtRefinement::off};
  RansacParams ransac{};             ///< its min_inliers is `min_inliers` + 1; the papers': random, turns up to π
  double odometry_translation{0.1};  ///< m per m, deviation of odometry where it has to do
  double odometry_rotation{0.1};     ///< rad per rad, and 0.05 rad per m
  double constant_translation{0.3};  ///< m, deviation of the motion before where that has to do
  double constant_rotation{0.2};     ///< rad
  std::uint32_t optimize_every{50};  ///< steps that small corrections wait for
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, FlirtParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.min_inliers, Field{"flirt_min_inliers", "", "constraints have more inliers", 2, 1000});
  visit(params.max_inlier_error,
        Field{"flirt_max_inlier_error", "m2", "mean squared distance of inliers is less", 0, 100});
  visit(params.max_scan_error,
        Field{"flirt_max_scan_error", "m", "reprojection error of the full scans is less", 0, 10});
  visit(params.min_comparable,
        Field{"flirt_min_comparable", "1", "share of each scan that the other tells about", 0, 1});
  visit(params.best_constraints, Field{"flirt_best_constraints", "", "of a step, at most", 1, 100000});
  visit(params.featureless_below, Field{"flirt_featureless_below", "", "fewer keypoints: featureless", 0, 1000});
  visit(params.gate, Field{"flirt_gate", "", "consistency of constraints with the graph"});
  visit(params.gate_limit, Field{"flirt_gate_limit", "1", "squared Mahalanobis distance from the path", 0, 1e9});
  visit(params.refinement, Field{"flirt_refinement", "", "of displacements by all points"});
  visit(params.ransac.sampling, Field{"flirt_sampling", "", "how pairs of candidates are chosen as hypotheses"});
  visit(params.ransac.inlier_probability,
        Field{"flirt_inlier_probability", "1", "random: share of right ones", 1e-3, 1});
  visit(params.ransac.max_turn_difference,
        Field{"flirt_max_turn_difference", "rad", "between a sample and its keypoints", 0, std::numbers::pi});
  visit(params.ransac.inlier_distance,
        Field{"flirt_inlier_distance", "m", "sigma of a keypoint's position", 1e-6, 1e3});
  visit(params.ransac.keypoint_deviation,
        Field{"flirt_keypoint_deviation", "m", "of a keypoint's coordinates, for the covariance", 1e-3, 1});
  visit(params.odometry_translation, Field{"flirt_odometry_translation", "1", "deviation of odometry", 0.001, 10});
  visit(params.odometry_rotation, Field{"flirt_odometry_rotation", "1", "deviation of odometry", 0.001, 10});
  visit(params.constant_translation, Field{"flirt_constant_translation", "m", "of the motion before", 0.01, 10});
  visit(params.constant_rotation, Field{"flirt_constant_rotation", "rad", "of the motion before", 0.01, 3.2});
  visit(params.optimize_every, Field{"flirt_optimize_every", "", "steps small corrections wait for", 1, 100000});
}

}  // namespace flirt
