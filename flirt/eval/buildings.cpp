#include "flirt/eval/buildings.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/rng.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace flirt {
namespace {

/// Number of beams that end on a disc before they meet the building; the same marked in `covered`.
std::size_t cover(const PlanDisc& disc, const Pose2& map_from_sensor, const Beams& beams,
                  std::span<const double> ranges, std::vector<char>& covered) {
  const Point2 centre = inverse(map_from_sensor) * disc.center;
  std::size_t added = 0;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const Point2 direction{std::cos(beams.angle(i)), std::sin(beams.angle(i))};
    const double along = dot(direction, centre);
    const bool hits = along > 0 && std::abs(cross(direction, centre)) < disc.radius && along < ranges[i];
    if (!hits || covered[i] != 0) { continue; }
    covered[i] = 1;
    ++added;
  }
  return added;
}

/// Pairs of legs 0.6 to 4 m away, before the walls, until `share` of the returning beams end on them.
std::vector<PlanDisc> legs_in_the_way(const Pose2& map_from_sensor, const Beams& beams, std::span<const double> ranges,
                                      double share, Rng& rng, std::vector<char>& covered) {
  constexpr double leg_radius = 0.06;  // m
  constexpr double stride = 0.3;       // m between the legs
  constexpr double room = 0.3;         // m between a person and the wall behind
  constexpr int most_people = 500;
  const auto returning = static_cast<double>(
      std::ranges::count_if(ranges, [&](double range) { return classify(range, beams) == Reading::hit; }));
  std::vector<PlanDisc> legs;
  std::size_t count = 0;
  for (int i = 0; i < most_people && static_cast<double>(count) < share * returning; ++i) {
    const std::size_t beam = rng.below(static_cast<std::uint32_t>(ranges.size()));
    const double distance = rng.uniform(0.6, 4.0);
    const double turn = rng.uniform(0, std::numbers::pi);
    if (distance + room > ranges[beam]) { continue; }
    const Pose2 sensor_from_person{distance * std::cos(beams.angle(beam)), distance * std::sin(beams.angle(beam)),
                                   turn};
    for (const double side : {-stride / 2, stride / 2}) {
      legs.push_back({map_from_sensor * (sensor_from_person * Point2{side, 0}), leg_radius});
      count += cover(legs.back(), map_from_sensor, beams, ranges, covered);
    }
  }
  return legs;
}

/// Whether any hypothesis away from the truth sees what the scan saw of the building.
bool has_twin(const RayCaster& caster, const BuildingQuery& query, const LocalizationResult& result,
              const BuildingBenchParams& params) {
  return std::ranges::any_of(result.hypotheses, [&](const PoseHypothesis& hypothesis) {
    const PoseTolerance& near = params.tolerance;
    if (is_within(hypothesis.map_from_sensor, query.map_from_sensor, near.correct_distance, near.correct_heading)) {
      return false;
    }
    const std::vector<double> seen =
        caster.cast(hypothesis.map_from_sensor, query.scan.beams, query.true_ranges.size());
    return differing_share(query.true_ranges, seen, query.sees_building, params.same_range) < params.told_apart;
  });
}

void count_answer(const BuildingAnswer& answer, BuildingBench& bench) {
  const bool called_unique = answer.result.verdict == Verdict::unique;
  Rate& rate = answer.is_unique ? bench.success : bench.twins_right;
  ++rate.total;
  rate.hits += answer.is_right ? 1 : 0;
  if (answer.is_unique) {
    ++bench.called_unique.total;
    bench.called_unique.hits += answer.is_right && called_unique ? 1 : 0;
  }
  bench.unique_right.total += called_unique ? 1 : 0;
  bench.unique_right.hits += called_unique && answer.is_right ? 1 : 0;
}

double people_share(const BuildingQuery& query) {
  std::size_t returning = 0;
  std::size_t on_people = 0;
  for (std::size_t i = 0; i < query.true_ranges.size(); ++i) {
    const bool returns = classify(query.true_ranges[i], query.scan.beams) == Reading::hit;
    returning += returns ? 1 : 0;
    on_people += returns && query.sees_building[i] == 0 ? 1 : 0;
  }
  return Rate{on_people, returning}.value();
}

}  // namespace

double differing_share(std::span<const double> ranges, std::span<const double> others,
                       std::span<const char> sees_building, double same_range) {
  FLIRT_ASSERT(ranges.size() == others.size() && ranges.size() == sees_building.size());
  Rate differing;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (sees_building[i] == 0) { continue; }
    ++differing.total;
    differing.hits += std::abs(ranges[i] - others[i]) > same_range ? 1 : 0;
  }
  return differing.value();
}

BuildingQuery building_query(const RayCaster& caster, const LidarParams& lidar_params, const Pose2& map_from_sensor,
                             double people, std::uint64_t seed) {
  const Lidar lidar(lidar_params);
  Rng rng(seed);
  BuildingQuery query{.map_from_sensor = map_from_sensor};
  query.scan.beams = lidar.beams();
  query.true_ranges = caster.cast(map_from_sensor, lidar.beams(), lidar_params.beams);
  std::vector<char> covered(query.true_ranges.size(), 0);
  const std::vector<PlanDisc> legs =
      legs_in_the_way(map_from_sensor, lidar.beams(), query.true_ranges, people, rng, covered);
  query.scan.ranges = lidar.measure(caster, legs, map_from_sensor, rng);
  for (std::size_t i = 0; i < covered.size(); ++i) {
    const bool returns = classify(query.true_ranges[i], query.scan.beams) == Reading::hit;
    query.sees_building.push_back(returns && covered[i] == 0 ? 1 : 0);
  }
  return query;
}

BuildingBench bench_building(const FloorPlan& plan, const PlaceMap& map, const LidarParams& lidar,
                             std::span<const Pose2> map_from_sensor, const BuildingBenchParams& params,
                             std::size_t threads, const Progress& progress) {
  const RayCaster caster(plan);
  std::vector<std::unique_ptr<Localizer>> localizers(thread_count(threads));
  std::vector<BuildingAnswer> answers(map_from_sensor.size());
  parallel_for(
      answers.size(), threads,
      [&](std::size_t k, std::size_t thread) {
        if (!localizers[thread]) { localizers[thread] = std::make_unique<Localizer>(map, params.localize); }
        BuildingAnswer& answer = answers[k];
        answer.query = building_query(caster, lidar, map_from_sensor[k], params.people, Rng(params.seed, k).bits());
        answer.result = localizers[thread]->localize(answer.query.scan);
        answer.is_unique = !has_twin(caster, answer.query, answer.result, params);
        const PoseHypothesis* best = answer.result.best();
        answer.is_right =
            best != nullptr && is_within(best->map_from_sensor, map_from_sensor[k], params.tolerance.correct_distance,
                                         params.tolerance.correct_heading);
      },
      progress);

  BuildingBench bench;
  for (BuildingAnswer& answer : answers) {
    const auto seen = static_cast<std::size_t>(std::ranges::count(answer.query.sees_building, 1));
    if (seen < params.min_beams) { continue; }
    count_answer(answer, bench);
    bench.people += people_share(answer.query);
    bench.answers.push_back(std::move(answer));
  }
  if (!bench.answers.empty()) { bench.people /= static_cast<double>(bench.answers.size()); }
  return bench;
}

}  // namespace flirt
