#include "flirt/sim/simulate.hpp"

#include "flirt/core/rng.hpp"
#include "flirt/sim/free_space.hpp"
#include "flirt/sim/ray_caster.hpp"

#include <algorithm>
#include <string>

namespace flirt {
namespace {

// What the random numbers of one seed are for; scans use the streams from `first_scan` on.
enum Stream : std::uint64_t { drive_stream, people_stream, odometry_stream, places_stream, first_scan };

std::uint64_t seed_of(const SimulateParams& params, Stream stream) {
  return Rng(params.seed, stream).bits();
}

std::vector<std::size_t> first_scans(const Drive& drive, const std::vector<DriveKnot>& stops) {
  std::vector<std::size_t> begins;
  for (const double stamp : drive.round_begin) {
    const auto first = std::lower_bound(stops.begin(), stops.end(), stamp,
                                        [](const DriveKnot& stop, double value) { return stop.stamp < value; });
    begins.push_back(static_cast<std::size_t>(first - stops.begin()));
  }
  return begins;
}

/// Small enough for grids over all of it, and where a log can say poses.
bool is_buildable(const Rectangle& box) {
  constexpr double widest = 10e3;   // m
  constexpr double farthest = 1e6;  // m
  return box.width() <= widest && box.height() <= widest &&
         std::max({-box.low.x, -box.low.y, box.high.x, box.high.y}) <= farthest;
}

}  // namespace

Result<Simulation> simulate(const World& world, const SimulateParams& params, const Progress& progress) {
  const Rectangle box = bounds(world.plan);
  if (!is_buildable(box)) {
    return fail("expected a plan of up to 10 km x 10 km within 1000 km of its origin, found one of " +
                std::to_string(box.width()) + " m x " + std::to_string(box.height()) + " m at " +
                std::to_string(box.low.x) + ", " + std::to_string(box.low.y));
  }
  const FreeSpace space(world.plan, params.drive.robot_radius);
  const std::vector<Point2> places =
      world.places.empty() ? space.spread(params.drive.place_spacing, seed_of(params, places_stream)) : world.places;
  const Drive drive = world.tour.empty() ? plan_drive(space, places, params.drive, seed_of(params, drive_stream))
                                         : plan_tour(space, world.tour, params.drive, seed_of(params, drive_stream));
  if (drive.knots.empty()) {
    return fail("expected room for a robot of radius " + std::to_string(params.drive.robot_radius) +
                " m, found a plan with none");
  }
  const std::vector<DriveKnot> stops = scan_stops(drive, params.lidar.scan_rate, params.drive);
  const Crowd crowd(space, places, params.people, seed_of(params, people_stream));
  const RayCaster caster(world.plan);
  const Lidar lidar(params.lidar);

  Simulation simulation{{}, first_scans(drive, stops), world.plan};
  std::vector<Pose2>& map_from_robot = simulation.log.map_from_robot;
  for (const DriveKnot& stop : stops) { map_from_robot.push_back(stop.map_from_robot); }
  std::vector<Scan>& scans = simulation.log.scans;
  scans.resize(stops.size());
  if (params.odometry.mode == OdometryMode::drifting) {
    const auto odom_from_robot = drifting_odometry(map_from_robot, params.odometry, seed_of(params, odometry_stream));
    for (std::size_t i = 0; i < scans.size(); ++i) { scans[i].odom_from_robot = odom_from_robot[i]; }
  }
  parallel_for(
      scans.size(), params.threads,
      [&](std::size_t i, std::size_t) {
        Rng rng(params.seed, first_scan + i);
        scans[i].stamp = stops[i].stamp;
        scans[i].beams = lidar.beams();
        scans[i].robot_from_sensor = lidar.robot_from_sensor();
        const auto legs = crowd.legs(stops[i].stamp, map_from_robot[i].translation());
        scans[i].ranges = lidar.measure(caster, legs, simulation.log.map_from_sensor(i), rng);
      },
      progress, 16);
  return simulation;
}

}  // namespace flirt
