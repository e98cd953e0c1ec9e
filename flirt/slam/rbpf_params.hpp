// flirt/slam/rbpf_params.hpp: all that can be set about mapping with particles.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/slam/slam_params.hpp"

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace flirt {

struct RbpfParams {
  std::uint32_t particles{30};
  OdometryUse odometry{OdometryUse::use};  ///< without: each particle goes on as it went before
  double start_x{0};                       ///< m, pose of the robot at the first scan
  double start_y{0};                       ///< m
  double start_theta{0};                   ///< rad
  double update_travel{0.1};               ///< m; scans after less way, and
  double update_turn{0.1};                 ///< rad, after a smaller turn, are placed by odometry alone

  double cell_size{0.05};          ///< m, of each particle's grid
  double range_max{40};            ///< m, longer readings are not used
  double point_spacing{0.08};      ///< m, least distance between end points that are compared with the map
  std::uint32_t most_points{150};  ///< compared with the map, evenly picked
  double sigma{0.07};              ///< m, deviation of an end point from what it hit
  double free_miss{0.18};          ///< m; an end point with nothing near it in seen space counts as this far off
  double unknown_miss{0.14};       ///< m, the same where nothing was seen
  double points_worth{20};         ///< independent readings that a scan is worth: neighbours err together

  double step_translation{0.08};   ///< m, first step of the climb to the best pose
  double step_rotation{0.04};      ///< rad
  std::uint32_t step_halvings{4};  ///< after which the climb ends
  double doubt_share{0.75};        ///< share of points near something below which the climb is tried from more starts
  std::uint32_t doubt_starts{4};   ///< drawn from the motion
  double lost_share{0.3};          ///< share of points near something below which matching has failed

  std::uint32_t samples{40};        ///< drawn around the best pose for the proposal
  double sample_translation{0.02};  ///< m, half width of where they are drawn
  double sample_rotation{0.006};    ///< rad

  double way_per_way{0.1};    ///< m/m, deviation of odometry's way by the way
  double way_per_turn{0.05};  ///< m/rad, by the turn
  double turn_per_turn{0.3};  ///< rad/rad, deviation of odometry's turn by the turn
  double turn_per_way{0.1};   ///< rad/m, by the way
  double way_floor{0.02};     ///< m, deviation of a robot that does not move
  double turn_floor{0.03};    ///< rad
  double blind_way{0.3};      ///< m, deviation of the motion without odometry from the motion before
  double blind_turn{0.3};     ///< rad

  double weight_smoothing{0.2};  ///< share of a scan's log likelihood that goes into the weight: the grid is a model
  double resample_share{0.5};    ///< resampled when fewer than this share of the particles are effective
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, RbpfParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.particles, Field{"particles", "", "maps and trajectories that are followed", 1, 10000});
  visit(params.odometry, Field{"odometry", "", "whether the robot's dead reckoning is used"});
  visit(params.start_x, Field{"start_x", "m", "pose of the robot at the first scan", -1e6, 1e6});
  visit(params.start_y, Field{"start_y", "m", "pose of the robot at the first scan", -1e6, 1e6});
  visit(params.start_theta, Field{"start_theta", "rad", "pose of the robot at the first scan", -3.2, 3.2});
  visit(params.update_travel, Field{"update_travel", "m", "scans after less way are placed by odometry", 0, 10});
  visit(params.update_turn, Field{"update_turn", "rad", "and after a smaller turn", 0, 3.2});
  visit(params.cell_size, Field{"cell_size", "m", "side of a cell", 0.02, 1});
  visit(params.range_max, Field{"range_max", "m", "longer readings are not used", 1, 100});
  visit(params.point_spacing, Field{"point_spacing", "m", "least distance between compared end points", 0, 1});
  visit(params.most_points, Field{"most_points", "", "end points compared with the map", 1, 100000});
  visit(params.sigma, Field{"sigma", "m", "deviation of an end point", 0.005, 1});
  visit(params.free_miss, Field{"free_miss", "m", "what an end point in free space counts as", 0.01, 2});
  visit(params.unknown_miss, Field{"unknown_miss", "m", "what an end point in unseen space counts as", 0.01, 2});
  visit(params.points_worth, Field{"points_worth", "", "independent readings that a scan is worth", 1, 1000});
  visit(params.step_translation, Field{"step_translation", "m", "first step of the climb", 0.001, 1});
  visit(params.step_rotation, Field{"step_rotation", "rad", "first step of the climb", 0.001, 1});
  visit(params.step_halvings, Field{"step_halvings", "", "of the steps until the climb ends", 1, 20});
  visit(params.doubt_share, Field{"doubt_share", "1", "fewer points near something: more climbs", 0, 1});
  visit(params.doubt_starts, Field{"doubt_starts", "", "drawn from the motion for them", 0, 100});
  visit(params.lost_share, Field{"lost_share", "1", "fewer points near something: matching failed", 0, 1});
  visit(params.samples, Field{"samples", "", "drawn around the best pose", 8, 10000});
  visit(params.sample_translation, Field{"sample_translation", "m", "half width of the samples", 0.001, 1});
  visit(params.sample_rotation, Field{"sample_rotation", "rad", "half width of the samples", 0.0001, 1});
  visit(params.way_per_way, Field{"way_per_way", "1", "deviation of odometry", 0, 10});
  visit(params.way_per_turn, Field{"way_per_turn", "m/rad", "deviation of odometry", 0, 10});
  visit(params.turn_per_turn, Field{"turn_per_turn", "1", "deviation of odometry", 0, 10});
  visit(params.turn_per_way, Field{"turn_per_way", "rad/m", "deviation of odometry", 0, 10});
  visit(params.way_floor, Field{"way_floor", "m", "deviation of a robot that stands", 1e-4, 1});
  visit(params.turn_floor, Field{"turn_floor", "rad", "deviation of a robot that stands", 1e-4, 1});
  visit(params.blind_way, Field{"blind_way", "m", "deviation of the motion without odometry", 0.01, 10});
  visit(params.blind_turn, Field{"blind_turn", "rad", "deviation of the motion without odometry", 0.01, 3.2});
  visit(params.weight_smoothing, Field{"weight_smoothing", "1", "share of the log likelihood in weights", 0, 1});
  visit(params.resample_share, Field{"resample_share", "1", "fewer effective particles: resampling", 0, 1});
}

}  // namespace flirt
