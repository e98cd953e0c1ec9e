#include "flirt/slam/global_places.hpp"

#include "tests/slam/buildings.hpp"

#include <gmock/gmock.h>

namespace flirt {
namespace {

TEST(GlobalPlaces, PlacesAtMostSoManyScansInOneCall) {
  const ScanLog log = drive_through(2, 4);
  const std::vector<SlamScan> scans = slam_scans(log);
  constexpr std::size_t most = 30;
  constexpr std::size_t earlier = 80;
  GlobalPlaces slowly;
  std::size_t calls = 1;
  while (!slowly.update(scans, log.map_from_robot, earlier, most)) { ++calls; }
  EXPECT_EQ(calls, earlier / most + 1);
  GlobalPlaces at_once;
  EXPECT_TRUE(at_once.update(scans, log.map_from_robot, earlier, earlier + 1));
  int found = 0;
  for (std::size_t i = 0; i < earlier; i += 9) {
    const auto one = slowly.find(log.scans[i]);
    const auto other = at_once.find(log.scans[i]);
    ASSERT_EQ(one.has_value(), other.has_value());
    if (!one) { continue; }
    EXPECT_EQ(one->map_from_robot, other->map_from_robot);
    EXPECT_LT(distance(one->map_from_robot, log.map_from_robot[i]), 0.1);
    ++found;
  }
  EXPECT_GT(found, 5);
}

TEST(GlobalPlaces, FollowTheGraphWhenItMoves) {
  const ScanLog log = drive_through(2, 4);
  const std::vector<SlamScan> scans = slam_scans(log);
  constexpr std::size_t earlier = 80;
  constexpr std::size_t query = 45;
  const Pose2 moved_from_map{3, -8, 0.7};
  std::vector<Pose2> moved;
  for (const Pose2& pose : log.map_from_robot) { moved.push_back(moved_from_map * pose); }
  GlobalPlaces places;
  ASSERT_TRUE(places.update(scans, log.map_from_robot, earlier, earlier + 1));
  ASSERT_TRUE(places.find(log.scans[query]));
  ASSERT_TRUE(places.update(scans, moved, earlier, earlier + 1));
  const auto found = places.find(log.scans[query]);
  ASSERT_TRUE(found);
  EXPECT_LT(distance(found->map_from_robot, moved[query]), 0.1);
}

TEST(GlobalPlaces, FindNothingInAnEmptyMap) {
  GlobalPlaces places;
  EXPECT_TRUE(places.update({}, {}, 0, 10));
  EXPECT_FALSE(places.find(drive_through(2, 4).scans.front()));
}

}  // namespace
}  // namespace flirt
