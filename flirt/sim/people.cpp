#include "flirt/sim/people.hpp"

#include "flirt/core/rng.hpp"
#include "flirt/sim/drive.hpp"
#include "flirt/sim/path_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace flirt {
namespace {

constexpr double stride = 1.4;          // m, two steps
constexpr double swing_length = 0.25;   // m, of a leg before and behind the middle
constexpr double half_stance = 0.1;     // m, of a leg to the side
constexpr double robot_distance = 0.6;  // m, that people keep from the robot's origin
constexpr double way_smoothing = 0.5;   // m
constexpr double way_snapping = 1.0;    // m
constexpr int attempts = 20;

/// A closed way by two to four places within `range` of a random first one; empty when there are none.
std::vector<Point2> closed_way(const FreeSpace& space, PathSearch& search, std::span<const Point2> places, double range,
                               Rng& rng) {
  const auto any_place = [&] { return places[rng.below(static_cast<std::uint32_t>(places.size()))]; };
  const Point2 first = any_place();
  std::vector<Point2> stops{first};
  const std::size_t wanted = 2 + rng.below(3);
  for (int attempt = 0; attempt < attempts * 5 && stops.size() < wanted; ++attempt) {
    const Point2 next = any_place();
    if (norm(next - first) <= range && next != stops.back()) { stops.push_back(next); }
  }
  if (stops.size() < 2) { return {}; }
  stops.push_back(first);
  std::vector<Point2> way{space.nearest(first, way_snapping)};
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const std::vector<Point2> leg = search.path(way.back(), space.nearest(stops[i], way_snapping)[0]);
    way.insert(way.end(), leg.begin(), leg.end());
  }
  way = smooth_way(space, std::move(way), way_smoothing);
  way.back() = way.front();
  return way;
}

}  // namespace

Crowd::Crowd(const FreeSpace& space, std::span<const Point2> places, const PeopleParams& params, std::uint64_t seed)
    : params_(params) {
  std::vector<Point2> reachable;
  for (const Point2 place : places) {
    if (!space.nearest(place, way_snapping).empty()) { reachable.push_back(place); }
  }
  if (params.count == 0 || reachable.size() < 2) { return; }
  PathSearch search(space);
  for (std::uint32_t i = 0; i < params.count; ++i) {
    Rng rng(seed, i);
    Person person;
    for (int attempt = 0; attempt < attempts && person.way.size() < 2; ++attempt) {
      person.way = closed_way(space, search, reachable, params.walking_range, rng);
    }
    if (person.way.size() < 2) { continue; }
    person.speed = params.walking_speed * rng.uniform(0.75, 1.25);
    double time = 0;
    for (std::size_t k = 0; k < person.way.size(); ++k) {
      if (k > 0) { time += norm(person.way[k] - person.way[k - 1]) / person.speed; }
      person.arrival.push_back(time);
      const bool turns_back = k > 0 && k + 1 < person.way.size() &&
                              dot(person.way[k + 1] - person.way[k], person.way[k] - person.way[k - 1]) <= 0;
      if (turns_back || k + 1 == person.way.size()) { time += rng.uniform(0, 2 * params.pause); }
      person.departure.push_back(time);
    }
    person.phase = rng.uniform(0, time);
    people_.push_back(std::move(person));
  }
}

Crowd::Step Crowd::step_of(const Person& person, double stamp) {
  const double round = person.departure.back();
  const double time = std::fmod(stamp + person.phase, round);
  const auto next = std::upper_bound(person.arrival.begin(), person.arrival.end(), time);
  const auto after = static_cast<std::size_t>(next - person.arrival.begin());
  if (after >= person.way.size()) { return {person.way.back(), {1, 0}, 0}; }
  const Point2 from = person.way[after - 1];
  const Point2 way = person.way[after] - from;
  const Point2 ahead = norm(way) > 0 ? (1 / norm(way)) * way : Point2{1, 0};
  if (time <= person.departure[after - 1]) { return {from, ahead, 0}; }
  const double walked = person.speed * (time - person.departure[after - 1]);
  const double phase = 2 * std::numbers::pi * person.speed * time / stride;
  return {from + walked * ahead, ahead, swing_length * std::sin(phase)};
}

std::vector<Point2> Crowd::positions(double stamp) const {
  std::vector<Point2> positions;
  positions.reserve(people_.size());
  for (const Person& person : people_) { positions.push_back(step_of(person, stamp).center); }
  return positions;
}

std::vector<PlanDisc> Crowd::legs(double stamp, Point2 robot) const {
  std::vector<PlanDisc> legs;
  legs.reserve(2 * people_.size());
  for (const Person& person : people_) {
    Step step = step_of(person, stamp);
    const double near = norm(step.center - robot);
    if (near < robot_distance) {
      const Point2 away = near > 0 ? (1 / near) * (step.center - robot) : Point2{-step.ahead.y, step.ahead.x};
      step.center = robot + robot_distance * away;
    }
    const Point2 left{-step.ahead.y, step.ahead.x};
    legs.push_back({step.center + half_stance * left + step.swing * step.ahead, params_.leg_radius});
    legs.push_back({step.center - half_stance * left - step.swing * step.ahead, params_.leg_radius});
  }
  return legs;
}

}  // namespace flirt
