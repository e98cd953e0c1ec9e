// flirt/sim/drive.hpp: a robot's way through a building, in several rounds.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/sim/free_space.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace flirt {

/// The first round visits places one after the other, the nearest first. Every later round visits the same places, in
/// part backwards, on a way that differs by some decimetres.
struct DriveParams {
  double robot_radius{0.25};      ///< m, kept free of surfaces around the robot's origin
  double speed{0.6};              ///< m/s at most
  double turn_rate{0.8};          ///< rad/s at most
  double scan_distance{0.25};     ///< m driven after which a scan is logged; 0: every scan is
  double scan_turn{0.2};          ///< rad turned after which a scan is logged
  std::uint32_t rounds{2};        ///< first round: for the map, later ones: for the questions
  double round_length{0};         ///< m after which a round ends; 0: when the places were visited
  double place_share{0.6};        ///< share of the places that are visited
  double place_spacing{6.0};      ///< m between places in plans that name none
  double lateral_deviation{0.2};  ///< m, standard deviation of the way from the best one, to either side
  double reversed_share{0.5};     ///< share of the places visited in reverse order in later rounds
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, DriveParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.robot_radius, Field{"robot_radius", "m", "kept free of surfaces around the robot's origin", 0.01, 5});
  visit(params.speed, Field{"speed", "m/s", "at most", 0.01, 50});
  visit(params.turn_rate, Field{"turn_rate", "rad/s", "at most", 0.01, 50});
  visit(params.scan_distance, Field{"scan_distance", "m", "driven between logged scans; 0: every scan", 0, 100});
  visit(params.scan_turn, Field{"scan_turn", "rad", "turned after which a scan is logged", 0.001, 100});
  visit(params.rounds, Field{"rounds", "", "first for the map, later ones for the questions", 1, 1000});
  visit(params.round_length, Field{"round_length", "m", "after which a round ends; 0: all places visited", 0, 1e7});
  visit(params.place_share, Field{"place_share", "1", "share of the places that are visited", 0, 1});
  visit(params.place_spacing, Field{"place_spacing", "m", "between places in plans that name none", 0.5, 1000});
  visit(params.lateral_deviation,
        Field{"lateral_deviation", "m", "of the way from the best one, to either side", 0, 5});
  visit(params.reversed_share, Field{"reversed_share", "1", "places in reverse order in later rounds", 0, 1});
}

/// A moment of the drive; in between, the robot moves evenly.
struct DriveKnot {
  double stamp{0};  ///< s
  Pose2 map_from_robot{};
};

struct Drive {
  std::vector<DriveKnot> knots{};     ///< stamps never decrease
  std::vector<double> round_begin{};  ///< s, one per round, the first is 0
};

/// Plans the drive. Places that the robot can't reach are left out; without a place that it can, the drive is empty.
/// The robot's disc touches nothing on the way. O(way · log way) in a building of like rooms.
[[nodiscard]] Drive plan_drive(const FreeSpace& space, std::span<const Point2> places, const DriveParams& params,
                               std::uint64_t seed);

/// A drive along a tour: forwards, and in every other later round backwards. Of the parameters, those about places do
/// not apply. Empty when the robot can't reach a place of the tour.
[[nodiscard]] Drive plan_tour(const FreeSpace& space, std::span<const Point2> tour, const DriveParams& params,
                              std::uint64_t seed);

/// Where the robot is at `stamp`; before the first and after the last knot it stands still. Drives are not empty.
[[nodiscard]] Pose2 pose_at(const Drive& drive, double stamp);

/// The moments at which a scan is logged: multiples of 1/scan_rate, thinned by way and turn.
[[nodiscard]] std::vector<DriveKnot> scan_stops(const Drive& drive, double scan_rate, const DriveParams& params);

/// A way of cells made smooth: every point moved to the middle of its neighbours again and again, over about `length`
/// m, as long as the disc of the space fits. Ends stay. O(points · length²).
[[nodiscard]] std::vector<Point2> smooth_way(const FreeSpace& space, std::vector<Point2> way, double length);

}  // namespace flirt
