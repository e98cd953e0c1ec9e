#include "flirt/sim/drive.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/rng.hpp"
#include "flirt/sim/path_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flirt {
namespace {

constexpr double smoothing_length = 0.6;   // m, of the way's corners
constexpr double deviation_length = 5.0;   // m, over which the deviation to the side changes
constexpr double cutting_reserve = 1.5;    // rounds are planned this much too long, since smooth ways are shorter
constexpr double snapping_distance = 1.0;  // m, from a place to where the robot fits

double way_length(std::span<const Point2> way) {
  double length = 0;
  for (std::size_t i = 1; i < way.size(); ++i) { length += norm(way[i] - way[i - 1]); }
  return length;
}

/// Places where the robot fits, each with the chance `share`; at least one if there is any.
std::vector<Point2> reachable_places(const FreeSpace& space, std::span<const Point2> places, double share, Rng& rng) {
  std::vector<Point2> reachable;
  std::vector<Point2> chosen;
  for (const Point2 place : places) {
    const std::vector<Point2> spot = space.nearest(place, snapping_distance);
    if (spot.empty()) { continue; }
    reachable.push_back(spot[0]);
    if (rng.uniform() < share) { chosen.push_back(spot[0]); }
  }
  if (chosen.empty() && !reachable.empty()) { chosen.push_back(reachable[0]); }
  return chosen;
}

bool append_leg(std::vector<Point2>& way, std::span<const Point2> leg) {
  way.insert(way.end(), leg.begin() + (way.empty() || leg.empty() ? 0 : 1), leg.end());
  return !leg.empty();
}

/// The first round: always to the nearest place not yet seen. Leaves `places` in the order of visiting, and in
/// `reached_after` the way to each in m.
std::vector<Point2> exploring_way(PathSearch& search, std::vector<Point2>& places, double max_length,
                                  std::vector<double>& reached_after) {
  std::vector<Point2> remaining(places.begin() + 1, places.end());
  places.resize(1);
  reached_after = {0};
  std::vector<Point2> way{places[0]};
  double length = 0;
  while (!remaining.empty() && (max_length == 0 || length < max_length)) {
    const PathSearch::Found found = search.path_to_nearest(way.back(), remaining);
    if (!append_leg(way, found.path)) { break; }
    length += way_length(found.path);
    places.push_back(remaining[found.goal]);
    reached_after.push_back(length);
    remaining[found.goal] = remaining.back();
    remaining.pop_back();
  }
  return way;
}

/// A later round: the last places backwards, then the first ones forwards.
std::vector<Point2> revisiting_way(PathSearch& search, std::span<const Point2> places, Point2 start,
                                   const DriveParams& params) {
  const auto backwards =
      static_cast<std::size_t>(std::lround(params.reversed_share * static_cast<double>(places.size())));
  std::vector<Point2> order(places.rbegin(), places.rbegin() + static_cast<std::ptrdiff_t>(backwards));
  order.insert(order.end(), places.begin(), places.end() - static_cast<std::ptrdiff_t>(backwards));
  std::vector<Point2> way{start};
  double length = 0;
  for (const Point2 place : order) {
    if (params.round_length > 0 && length >= cutting_reserve * params.round_length) { break; }
    const std::vector<Point2> leg = search.path(way.back(), place);
    length += way_length(leg);
    append_leg(way, leg);
  }
  return way;
}

/// Leaves the places that were reached on the first `driven` m, and one at least.
void forget_unreached(std::vector<Point2>& places, std::span<const double> reached_after, double driven) {
  const auto reached = std::upper_bound(reached_after.begin(), reached_after.end(), driven + 1e-6);
  places.resize(static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, reached - reached_after.begin())));
}

/// Smooth random numbers of deviation 1 along a way.
class Meander {
 public:
  explicit Meander(std::uint64_t seed) : seed_(seed) {}
  [[nodiscard]] double at(double way) const {
    const double knot = std::floor(way / deviation_length);
    const double share = way / deviation_length - knot;
    const double blend = share * share * (3 - 2 * share);
    return (1 - blend) * knot_value(knot) + blend * knot_value(knot + 1);
  }

 private:
  [[nodiscard]] double knot_value(double knot) const {
    return std::clamp(Rng(seed_, static_cast<std::uint64_t>(knot)).normal(), -2.0, 2.0);
  }
  std::uint64_t seed_;
};

/// Moves the way to the side by a meander, as far as the robot fits.
std::vector<Point2> meandering_way(const FreeSpace& space, std::vector<Point2> way, double deviation,
                                   std::uint64_t seed) {
  const Meander meander(seed);
  const std::vector<Point2> straight = way;
  double driven = 0;
  for (std::size_t i = 1; i + 1 < way.size(); ++i) {
    driven += norm(straight[i] - straight[i - 1]);
    const Point2 along = straight[i + 1] - straight[i - 1];
    if (norm(along) == 0) { continue; }
    const Point2 left{-along.y / norm(along), along.x / norm(along)};
    double offset = deviation * meander.at(driven);
    for (int attempt = 0; attempt < 4; ++attempt, offset /= 2) {
      const Point2 moved = straight[i] + offset * left;
      if (!space.contains(way[i - 1], moved) || !space.contains(moved, straight[i + 1])) { continue; }
      way[i] = moved;
      break;
    }
  }
  return way;
}

/// Adds the knots of a way: at full speed, or as slow as the turns ask for; on the spot where it turns back.
void add_knots(std::span<const Point2> way, const DriveParams& params, std::vector<DriveKnot>& knots) {
  constexpr double spot_turn = 1.0;  // rad, between two steps, from which the robot stops and turns
  constexpr double shortest_step = 1e-3;
  const auto arrive = [&](Point2 point, double heading) {
    const Pose2 pose{point.x, point.y, wrap_angle(heading)};
    if (knots.empty()) {
      knots.push_back({0, pose});
      return;
    }
    const DriveKnot& last = knots.back();
    const double driving = distance(last.map_from_robot, pose) / params.speed;
    const double turning = heading_difference(last.map_from_robot, pose) / params.turn_rate;
    if (driving + turning > 0) { knots.push_back({last.stamp + std::max(driving, turning), pose}); }
  };
  std::vector<Point2> points;
  for (const Point2 point : way) {
    if (points.empty() || norm(point - points.back()) > shortest_step) { points.push_back(point); }
  }
  const auto heading_after = [&](std::size_t i) {
    const Point2 step = points[i + 1] - points[i];
    return std::atan2(step.y, step.x);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool has_before = i > 0;
    const bool has_after = i + 1 < points.size();
    const double before = has_before ? heading_after(i - 1) : (has_after ? heading_after(i) : 0.0);
    const double turn = has_after ? wrap_angle(heading_after(i) - before) : 0.0;
    if (std::abs(turn) < spot_turn) {
      arrive(points[i], before + turn / 2);
    } else {
      arrive(points[i], before);
      arrive(points[i], before + turn);
    }
  }
}

/// Points of the way about `spacing` m apart, and more of them where the robot does not fit straight in between.
std::vector<Point2> thin_way(const FreeSpace& space, std::span<const Point2> way, double spacing) {
  std::vector<Point2> thinned;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const bool can_wait = i > 0 && i + 1 < way.size() && norm(way[i + 1] - thinned.back()) <= spacing &&
                          space.contains(thinned.back(), way[i + 1]);
    if (!can_wait) { thinned.push_back(way[i]); }
  }
  return thinned;
}

/// The way cut off after `length` m; 0: whole.
std::vector<Point2> cut(std::vector<Point2> way, double length) {
  double driven = 0;
  for (std::size_t i = 1; i < way.size() && length > 0; ++i) {
    driven += norm(way[i] - way[i - 1]);
    if (driven >= length) { way.resize(i + 1); }
  }
  return way;
}

}  // namespace

std::vector<Point2> smooth_way(const FreeSpace& space, std::vector<Point2> way, double length) {
  constexpr double spacing = 0.15;  // m, between the points that are moved
  const auto sweeps = static_cast<std::size_t>(std::ceil(length * length / (spacing * spacing)));
  way = thin_way(space, way, spacing);
  for (std::size_t sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t i = 1; i + 1 < way.size(); ++i) {
      const Point2 middle = 0.5 * (way[i - 1] + way[i + 1]);
      const Point2 moved = 0.5 * (way[i] + middle);
      if (space.contains(way[i - 1], moved) && space.contains(moved, way[i + 1])) { way[i] = moved; }
    }
  }
  return way;
}

Drive plan_drive(const FreeSpace& space, std::span<const Point2> places, const DriveParams& params,
                 std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Point2> order = reachable_places(space, places, params.place_share, rng);
  Drive drive;
  if (order.empty()) { return drive; }
  std::swap(order[0], order[rng.below(static_cast<std::uint32_t>(order.size()))]);
  PathSearch search(space);
  Point2 start = order[0];
  std::vector<double> reached_after;
  for (std::uint32_t round = 0; round < params.rounds; ++round) {
    const double limit = cutting_reserve * params.round_length;
    std::vector<Point2> way =
        round == 0 ? exploring_way(search, order, limit, reached_after) : revisiting_way(search, order, start, params);
    const double planned = way_length(way);
    way = smooth_way(space, std::move(way), smoothing_length);
    way = meandering_way(space, std::move(way), params.lateral_deviation, rng.bits());
    way = smooth_way(space, std::move(way), smoothing_length / 2);
    const double smooth = way_length(way);
    way = cut(std::move(way), params.round_length);
    if (round == 0) { forget_unreached(order, reached_after, planned * way_length(way) / std::max(smooth, 1e-9)); }
    start = way.back();
    drive.round_begin.push_back(drive.knots.empty() ? 0.0 : drive.knots.back().stamp);
    add_knots(way, params, drive.knots);
  }
  return drive;
}

Drive plan_tour(const FreeSpace& space, std::span<const Point2> tour, const DriveParams& params, std::uint64_t seed) {
  Rng rng(seed);
  Drive drive;
  std::vector<Point2> stops;
  for (const Point2 place : tour) {
    const std::vector<Point2> spot = space.nearest(place, snapping_distance);
    if (spot.empty()) { return drive; }
    stops.push_back(spot[0]);
  }
  PathSearch search(space);
  for (std::uint32_t round = 0; round < params.rounds; ++round) {
    std::vector<Point2> way{stops[0]};
    for (std::size_t i = 1; i < stops.size(); ++i) {
      if (!append_leg(way, search.path(stops[i - 1], stops[i]))) { return {}; }
    }
    way = smooth_way(space, std::move(way), smoothing_length);
    way = meandering_way(space, std::move(way), params.lateral_deviation, rng.bits());
    way = cut(smooth_way(space, std::move(way), smoothing_length / 2), params.round_length);
    drive.round_begin.push_back(drive.knots.empty() ? 0.0 : drive.knots.back().stamp);
    add_knots(way, params, drive.knots);
    std::ranges::reverse(stops);
  }
  return drive;
}

Pose2 pose_at(const Drive& drive, double stamp) {
  FLIRT_ASSERT(!drive.knots.empty());
  const auto after = std::upper_bound(drive.knots.begin(), drive.knots.end(), stamp,
                                      [](double value, const DriveKnot& knot) { return value < knot.stamp; });
  if (after == drive.knots.begin()) { return drive.knots.front().map_from_robot; }
  if (after == drive.knots.end()) { return drive.knots.back().map_from_robot; }
  const DriveKnot& a = *(after - 1);
  const DriveKnot& b = *after;
  const double share = (stamp - a.stamp) / (b.stamp - a.stamp);
  const Point2 way = b.map_from_robot.translation() - a.map_from_robot.translation();
  const double turn = wrap_angle(b.map_from_robot.theta - a.map_from_robot.theta);
  return {a.map_from_robot.x + share * way.x, a.map_from_robot.y + share * way.y,
          wrap_angle(a.map_from_robot.theta + share * turn)};
}

std::vector<DriveKnot> scan_stops(const Drive& drive, double scan_rate, const DriveParams& params) {
  std::vector<DriveKnot> stops;
  if (drive.knots.empty()) { return stops; }
  double driven = 0;
  double turned = 0;
  Pose2 last = drive.knots.front().map_from_robot;
  const double ticks = std::floor(drive.knots.back().stamp * scan_rate);
  for (double tick = 0; tick <= ticks; ++tick) {
    const double stamp = tick / scan_rate;
    const Pose2 now = pose_at(drive, stamp);
    driven += distance(last, now);
    turned += heading_difference(last, now);
    last = now;
    if (!stops.empty() && driven < params.scan_distance && turned < params.scan_turn) { continue; }
    stops.push_back({stamp, now});
    driven = 0;
    turned = 0;
  }
  return stops;
}

}  // namespace flirt
