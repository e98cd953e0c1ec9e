// flirt/sim/people.hpp: people who walk through the building, seen by a laser as pairs of legs.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/pose2.hpp"
#include "flirt/sim/floor_plan.hpp"
#include "flirt/sim/free_space.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace flirt {

struct PeopleParams {
  std::uint32_t count{0};      ///< in the whole building
  double walking_speed{1.2};   ///< m/s, the mean; from one to the next it differs by a quarter
  double walking_range{20.0};  ///< m around where a person starts that he or she walks in
  double pause{4.0};           ///< s, the mean time a person stands at a place
  double leg_radius{0.06};     ///< m
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, PeopleParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.count, Field{"count", "", "walking in the whole building", 0, 100000});
  visit(params.walking_speed, Field{"walking_speed", "m/s", "mean over the people", 0.01, 10});
  visit(params.walking_range, Field{"walking_range", "m", "around a person's start that he or she walks in", 1, 1000});
  visit(params.pause, Field{"pause", "s", "mean time a person stands at a place", 0, 10000});
  visit(params.leg_radius, Field{"leg_radius", "m", "of a person's leg", 0.01, 0.5});
}

/// Everyone walks a closed round of a few places for ever, stopping at each, and steps aside for the robot.
class Crowd {
 public:
  /// People walk where the disc of `space` fits. Nobody comes when there is no place to walk between.
  Crowd(const FreeSpace& space, std::span<const Point2> places, const PeopleParams& params, std::uint64_t seed);

  [[nodiscard]] std::size_t size() const { return people_.size(); }

  /// Middle of each person at `stamp`, m, map frame.
  [[nodiscard]] std::vector<Point2> positions(double stamp) const;

  /// Two legs for each person, who keep 0.6 m from the robot.
  [[nodiscard]] std::vector<PlanDisc> legs(double stamp, Point2 robot) const;

 private:
  struct Person {
    std::vector<Point2> way;        ///< m, closed: the last point is the first
    std::vector<double> arrival;    ///< s, at each point of the way
    std::vector<double> departure;  ///< s, from each point of the way
    double phase;                   ///< s, into the round at stamp 0
    double speed;                   ///< m/s
  };
  struct Step {
    Point2 center;
    Point2 ahead;  ///< unit vector
    double swing;  ///< m, by which the left leg is ahead of the middle
  };
  [[nodiscard]] static Step step_of(const Person& person, double stamp);

  PeopleParams params_;
  std::vector<Person> people_;
};

}  // namespace flirt
