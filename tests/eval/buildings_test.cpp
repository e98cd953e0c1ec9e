#include "flirt/eval/buildings.hpp"

#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <vector>

namespace flirt {
namespace {

void add_walls(const std::vector<Point2>& corners, const Pose2& map_from_room, FloorPlan& plan) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    plan.segments.push_back({map_from_room * corners[i], map_from_room * corners[(i + 1) % corners.size()]});
  }
}

/// A room of 8 m × 5 m with a niche and a box, without symmetry.
void add_room(const Pose2& map_from_room, FloorPlan& plan) {
  add_walls({{0, 0}, {8, 0}, {8, 5}, {5.5, 5}, {5.5, 6.5}, {4, 6.5}, {4, 5}, {0, 5}}, map_from_room, plan);
  add_walls({{1.5, 1.2}, {2.7, 1.2}, {2.7, 1.9}, {1.5, 1.9}}, map_from_room, plan);
}

constexpr LidarParams lidar{.beams = 180, .field_of_view = 2 * std::numbers::pi, .mount_x = 0};

PlaceMap map_of(const FloorPlan& plan, const std::vector<Pose2>& rooms) {
  const RayCaster caster(plan);
  ScanLog log;
  for (const Pose2& map_from_room : rooms) {
    for (int i = 0; i < 8; ++i) {
      log.map_from_robot.push_back(map_from_room * Pose2{1 + 0.7 * i, 3.2 + 0.1 * (i % 3), 0.6 * i});
      log.scans.push_back(building_query(caster, lidar, log.map_from_robot.back(), 0, 7).scan);
    }
  }
  return build_place_map(log, {}, 1).value();
}

TEST(BuildingQuery, PutsAsManyPeopleInTheWayAsAskedFor) {
  FloorPlan plan;
  add_room({}, plan);
  const RayCaster caster(plan);
  for (const double share : {0.0, 0.1, 0.3}) {
    const BuildingQuery query = building_query(caster, lidar, {3, 3.5, 0.2}, share, 5);
    std::size_t nearer = 0;
    std::size_t on_people = 0;
    for (std::size_t i = 0; i < query.true_ranges.size(); ++i) {
      on_people += query.sees_building[i] == 0 ? 1 : 0;
      nearer += query.scan.ranges[i] < query.true_ranges[i] - 0.15 ? 1 : 0;
    }
    EXPECT_GE(static_cast<double>(on_people), share * 180);
    EXPECT_LE(static_cast<double>(on_people), share * 180 + 20);
    EXPECT_NEAR(static_cast<double>(nearer), static_cast<double>(on_people), 12);
  }
}

TEST(BuildingQuery, SharesCountOnlyBeamsThatSeeTheBuilding) {
  constexpr std::array ranges{1.0, 2.0, 3.0, 4.0};
  constexpr std::array others{1.05, 2.5, 9.0, 4.0};
  constexpr std::array<char, 4> sees{1, 1, 0, 1};
  EXPECT_DOUBLE_EQ(differing_share(ranges, others, sees, 0.1), 1.0 / 3);
}

TEST(BuildingBench, FindsScansOfARoomThatIsTheOnlyOneOfItsKind) {
  FloorPlan plan;
  add_room({}, plan);
  const std::vector<Pose2> places{{3, 3.5, 0.2}, {5.2, 2.5, -2.0}, {6.5, 3.1, 1.0}};
  const BuildingBench bench = bench_building(plan, map_of(plan, {{}}), lidar, places, {.people = 0.2}, 1);
  EXPECT_EQ(bench.success.total, 3U);
  EXPECT_EQ(bench.success.hits, 3U);
  EXPECT_GE(bench.people, 0.2);
}

TEST(BuildingBench, DoesNotAskForOneOfTwoTwinRooms) {
  FloorPlan plan;
  const std::vector<Pose2> rooms{{}, {15, 2, 0.5}};
  for (const Pose2& map_from_room : rooms) { add_room(map_from_room, plan); }
  const std::vector<Pose2> places{{3, 3.5, 0.2}, rooms[1] * Pose2{5.2, 2.5, -2.0}};
  const BuildingBench bench = bench_building(plan, map_of(plan, rooms), lidar, places, {}, 1);
  EXPECT_EQ(bench.success.total, 0U);
  EXPECT_EQ(bench.twins_right.total, 2U);
}

TEST(Buildings, MovedFurnitureDoesNotVeto) {
  OfficeParams office{.area = 500, .seed = 3};
  const LidarParams half_turn{.beams = 180, .mount_x = 0};
  const auto drive = [&](std::uint64_t seed) {
    return simulate(make_office(office),
                    {.lidar = half_turn, .drive = {.scan_distance = 0.6, .rounds = 1, .place_share = 1}, .seed = seed})
        .value();
  };
  const PlaceMap map = build_place_map(drive(1).log, {}, 1).value();
  office.changed = 0.4;
  const Simulation later = drive(2);
  std::vector<Pose2> places;
  for (std::size_t i = 0; i < later.log.scans.size(); i += 2) { places.push_back(later.log.map_from_sensor(i)); }
  const auto ask = [&](double moved_width) {
    BuildingBenchParams params;
    params.localize.search.score.moved_width = moved_width;
    return bench_building(later.plan, map, half_turn, places, params, 1);
  };
  const BuildingBench strict = ask(0);
  const BuildingBench lenient = ask(EvidenceScoreParams{}.moved_width);
  EXPECT_GE(lenient.success.value(), strict.success.value());
  EXPECT_GT(lenient.unique_right.hits, strict.unique_right.hits);
  EXPECT_GT(lenient.unique_right.value(), 0.98);
}

}  // namespace
}  // namespace flirt
