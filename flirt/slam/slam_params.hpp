// flirt/slam/slam_params.hpp: all that can be set about mapping.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/graph/optimize.hpp"
#include "flirt/registration/surface_points.hpp"
#include "flirt/slam/flirt_params.hpp"

#include <array>
#include <concepts>
#include <cstdint>
#include <string_view>
#include <utility>

namespace flirt {

/// How the motion from one scan to the next is found.
enum class FrontEndKind : std::uint8_t {
  automatic,  ///< `scan`, helped by keypoints where it is not sure, and loops closed anywhere in the map
  scan,       ///< the whole scan against the accumulated map of the last metres, loops closed in a window
  flirt,      ///< the papers' algorithm 1: keypoints alone, against all scans of the map
  olson,      ///< correlative search against the scan before alone, for comparison
  icp,        ///< points drawn onto lines of the scan before alone, for comparison
};
constexpr auto enum_names(FrontEndKind /*tag*/) {
  using enum FrontEndKind;
  return std::array<std::pair<FrontEndKind, std::string_view>, 5>{
      {{automatic, "auto"}, {scan, "scan"}, {flirt, "flirt"}, {olson, "olson"}, {icp, "icp"}}};
}

/// Whether the robot's own dead reckoning is used.
enum class OdometryUse : std::uint8_t {
  use,     ///< where scans carry it
  ignore,  ///< as if there were none
};
constexpr auto enum_names(OdometryUse /*tag*/) {
  return std::array{std::pair{OdometryUse::use, std::string_view("use")},
                    std::pair{OdometryUse::ignore, std::string_view("ignore")}};
}

struct SlamParams {
  FrontEndKind front_end{FrontEndKind::automatic};
  Backend backend{Backend::ceres};  ///< optimizer of the pose graph; the papers': toro
  OdometryUse odometry{OdometryUse::use};
  std::uint32_t window{0};  ///< > 0: incremental mapping over the last `window` scans: no odometry, no loop closing
  double start_x{0};        ///< m, pose of the robot at the first scan
  double start_y{0};        ///< m
  double start_theta{0};    ///< rad
  SurfacePointParams points{};
  FlirtParams flirt{};  ///< of the front end `flirt`

  std::uint32_t map_scans{20};       ///< scans in the accumulated map, at least
  double map_travel{6};              ///< m of travel that the accumulated map covers, at least
  double narrow_extent{0.5};         ///< m, half width of the first search, without odometry
  double narrow_turn{0.42};          ///< rad, the same for the heading
  double odometry_extent{0.3};       ///< m, half width of the first search, with odometry
  double odometry_turn{0.15};        ///< rad
  double wide_extent{1.3};           ///< m, half width of the search that follows when the first does not convince
  double widest_extent{3.5};         ///< m, the same where the robot moved far between the last scans
  double convincing_score{11.0};     ///< a score above which the first search is believed
  double usable_score{5.0};          ///< a score below which no pose is believed: prediction instead
  double surprise_translation{1.0};  ///< score lost per m from the predicted pose
  double surprise_rotation{1.0};     ///< score lost per rad from the predicted heading
  double rival_lead{1.0};            ///< score by which a place must lead over others, else it is not seen which it is
  double range_sigma{0.03};          ///< m, of the distance of a point from a line, for the information of edges
  double floor_translation{0.3};     ///< m, deviation of a motion nothing was measured of
  double floor_rotation{0.1};        ///< rad
  double unobservable_share{0.015};  ///< less of the points' information about a direction than this: unobservable
  double unobservable_drop{0.5};  ///< score that a pose 0.3 m aside must lose for such a direction to be held after all

  double loop_every{0.7};                 ///< m of travel between queries for earlier visits
  double loop_min_travel{12};             ///< m of travel after which a place counts as visited earlier
  std::uint32_t loop_min_scans{40};       ///< scans after which it does, or `global_min_travel` of way
  double loop_query_travel{3};            ///< m of travel whose scans are moved together
  std::uint32_t loop_query_scans{6};      ///< scans that are moved together
  double loop_extent{0.8};                ///< m, half width of the search, and
  double loop_extent_growth{0.03};        ///< m per m of travel since the last closure
  double loop_turn{0.105};                ///< rad, half width of the search, and
  double loop_turn_growth{0.005};         ///< rad per m
  double loop_extent_most{8};             ///< m, half width of the search at most
  double loop_score{8.5};                 ///< least score of a closure
  double loop_margin{2};                  ///< least lead of its score over a second pose
  double loop_lead{1};                    ///< least lead over poses 0.3 m aside in the direction that holds it least
  double loop_clear_margin{6};            ///< a lead that needs no second query to agree
  double loop_unknown{0.4};               ///< most of the points that may lie where nothing was seen
  std::uint32_t loop_points{100};         ///< least number of points of a query
  double loop_drift{0.3};                 ///< m that the graph may well be off where it was just closed, and
  double loop_drift_growth{0.02};         ///< m per m of travel since the last closure; if it is off by more,
  double loop_turn_drift_growth{0.0005};  ///< rad per m, the same beside `loop_turn`
  double loop_sure_travel{6};             ///< m of travel over which the same displacement has to be found
  double global_after{30};                ///< m of travel without closure, some of it unseen, until the map is searched
  double global_every{6};                 ///< m of travel between such searches, but only
  double global_agree_travel{1.5};        ///< m once one found something
  double global_min_travel{20};      ///< m of travel after which scans take part in that map, and places are earlier
  double global_forget_travel{12};   ///< m of travel after which a place found no longer confirms others
  std::uint32_t global_agreeing{3};  ///< places found that must agree
  std::uint32_t polish_rounds{3};    ///< rounds of joint alignment of all scans at the end
  double polish_spacing{0.04};       ///< m, least distance between consecutive points that take part in it
  double polish_in_line{0.175};  ///< rad, `points.in_line` of these: in hundreds of pairs what is no wall averages out
  double polish_keep{0.02};      ///< weight of what was measured before, beside the pairs
  double repair_fit{0.6};     ///< share of a scan's points that its best partners see: with less it is looked for anew
  double suspect_score{8.0};  ///< scans whose motion was found with less are looked for anew
  double repair_gain{1.0};    ///< score that a scan must gain to be moved
  std::uint32_t polish_pairs{10};  ///< other scans that each scan is aligned with
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, SlamParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.front_end, Field{"front_end", "", "how the motion between scans is found"});
  visit(params.backend, Field{"backend", "", "optimizer of the pose graph; the papers': toro"});
  visit(params.odometry, Field{"odometry", "", "whether the robot's dead reckoning is used"});
  visit(params.window, Field{"window", "", "incremental mapping over the last N scans; 0: whole map", 0, 1e6});
  visit(params.start_x, Field{"start_x", "m", "pose of the robot at the first scan", -1e6, 1e6});
  visit(params.start_y, Field{"start_y", "m", "pose of the robot at the first scan", -1e6, 1e6});
  visit(params.start_theta, Field{"start_theta", "rad", "pose of the robot at the first scan", -3.2, 3.2});
  visit_fields(params.points, visit);
  visit_fields(params.flirt, visit);
  visit(params.map_scans, Field{"map_scans", "", "scans in the accumulated map, at least", 1, 1000});
  visit(params.map_travel, Field{"map_travel", "m", "travel that the accumulated map covers, at least", 0, 20});
  visit(params.narrow_extent, Field{"narrow_extent", "m", "half width of the first search", 0.1, 5});
  visit(params.narrow_turn, Field{"narrow_turn", "rad", "half width of the first search", 0.02, 3.2});
  visit(params.odometry_extent, Field{"odometry_extent", "m", "the same with odometry", 0.1, 5});
  visit(params.odometry_turn, Field{"odometry_turn", "rad", "the same with odometry", 0.02, 3.2});
  visit(params.wide_extent, Field{"wide_extent", "m", "half width of the search that follows", 0.1, 10});
  visit(params.widest_extent, Field{"widest_extent", "m", "the same where scans are far apart", 0.1, 10});
  visit(params.convincing_score, Field{"convincing_score", "", "the first search is believed above", -50, 50});
  visit(params.usable_score, Field{"usable_score", "", "no pose is believed below", -50, 50});
  visit(params.surprise_translation,
        Field{"surprise_translation", "1/m", "score lost by leaving the prediction", 0, 50});
  visit(params.surprise_rotation, Field{"surprise_rotation", "1/rad", "score lost by leaving the prediction", 0, 50});
  visit(params.rival_lead, Field{"rival_lead", "", "lead over other places below which a motion is not seen", -50, 50});
  visit(params.range_sigma, Field{"range_sigma", "m", "deviation of a point from a line", 0.001, 1});
  visit(params.floor_translation, Field{"floor_translation", "m", "deviation of an unmeasured motion", 0.01, 10});
  visit(params.floor_rotation, Field{"floor_rotation", "rad", "deviation of an unmeasured motion", 0.001, 3.2});
  visit(params.unobservable_share,
        Field{"unobservable_share", "1", "less information a point about a direction: unobservable", 0, 1});
  visit(params.unobservable_drop,
        Field{"unobservable_drop", "", "score lost 0.3 m aside that shows a motion after all", 0, 50});
  visit(params.loop_every, Field{"loop_every", "m", "travel between queries for earlier visits", 0.05, 100});
  visit(params.loop_min_travel, Field{"loop_min_travel", "m", "travel until a place counts as earlier", 1, 1000});
  visit(params.loop_min_scans, Field{"loop_min_scans", "", "scans until a place counts as earlier", 1, 10000});
  visit(params.loop_query_travel, Field{"loop_query_travel", "m", "travel whose scans move together", 0, 20});
  visit(params.loop_query_scans, Field{"loop_query_scans", "", "scans that are moved together", 1, 50});
  visit(params.loop_extent, Field{"loop_extent", "m", "half width of the search for closures", 0.1, 20});
  visit(params.loop_extent_growth, Field{"loop_extent_growth", "1", "its growth per m since the last closure", 0, 1});
  visit(params.loop_turn, Field{"loop_turn", "rad", "half width of the search for closures", 0.02, 3.2});
  visit(params.loop_turn_growth, Field{"loop_turn_growth", "rad/m", "its growth since the last closure", 0, 1});
  visit(params.loop_extent_most, Field{"loop_extent_most", "m", "half width of that search at most", 0.1, 20});
  visit(params.loop_score, Field{"loop_score", "", "least score of a closure", -50, 50});
  visit(params.loop_margin, Field{"loop_margin", "", "least lead of its score over a second pose", 0, 50});
  visit(params.loop_lead, Field{"loop_lead", "", "least lead of its score over poses 0.3 m aside", -50, 50});
  visit(params.loop_clear_margin, Field{"loop_clear_margin", "", "a lead that needs no second query", 0, 50});
  visit(params.loop_unknown, Field{"loop_unknown", "1", "most points where nothing was seen", 0, 1});
  visit(params.loop_points, Field{"loop_points", "", "least number of points of a query", 1, 100000});
  visit(params.loop_drift, Field{"loop_drift", "m", "the graph may well be off by", 0, 100});
  visit(params.loop_drift_growth, Field{"loop_drift_growth", "1", "its growth since the last closure", 0, 1});
  visit(params.loop_turn_drift_growth,
        Field{"loop_turn_drift_growth", "rad/m", "the same of the heading, beside loop_turn", 0, 1});
  visit(params.loop_sure_travel,
        Field{"loop_sure_travel", "m", "travel that shows a larger displacement all along", 0, 1000});
  visit(params.global_after,
        Field{"global_after", "m", "travel without closure until the whole map is searched", 0, 1e9});
  visit(params.global_every, Field{"global_every", "m", "travel between searches of the whole map", 0.1, 1e9});
  visit(params.global_agree_travel, Field{"global_agree_travel", "m", "the same once one found something", 0, 1000});
  visit(params.global_min_travel, Field{"global_min_travel", "m", "travel until scans take part in them", 1, 1e6});
  visit(params.global_forget_travel, Field{"global_forget_travel", "m", "until a place confirms no more", 0, 1e6});
  visit(params.global_agreeing, Field{"global_agreeing", "", "places found that must agree", 1, 100});
  visit(params.polish_rounds, Field{"polish_rounds", "", "rounds of joint alignment at the end", 0, 100});
  visit(params.polish_spacing, Field{"polish_spacing", "m", "least distance between points in them", 0.01, 1.0});
  visit(params.polish_in_line,
        Field{"polish_in_line", "rad", "bend up to which neighbours are in line in them", 0, 0.5});
  visit(params.polish_keep, Field{"polish_keep", "1", "weight of what was measured before, beside the pairs", 0, 1});
  visit(params.repair_fit, Field{"repair_fit", "1", "scans whose partners see less of them are looked for", 0, 1});
  visit(params.suspect_score, Field{"suspect_score", "", "scans found with less are looked for anew", -50, 50});
  visit(params.repair_gain, Field{"repair_gain", "", "score that a scan must gain to be moved", 0, 50});
  visit(params.polish_pairs, Field{"polish_pairs", "", "scans that each scan is aligned with", 1, 1000});
}

}  // namespace flirt
