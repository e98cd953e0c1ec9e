#include "flirt/map/tracker.hpp"

#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"

#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

namespace flirt {
namespace {

/// A building's map from the first round, and the scans of a second round, with odometry that drifts.
struct Building {
  PlaceMap map;
  ScanLog drive;
};

ScanLog part_of(const ScanLog& log, std::size_t begin, std::size_t end) {
  ScanLog part;
  for (std::size_t i = begin; i < std::min(end, log.scans.size()); ++i) {
    part.scans.push_back(log.scans[i]);
    part.map_from_robot.push_back(log.map_from_robot[i]);
  }
  return part;
}

Building building(std::uint32_t people) {
  SimulateParams params;
  params.drive.round_length = 70;
  params.people.count = people;
  const Simulation simulation = simulate(make_office({.area = 600, .seed = 3}), params).value();
  const std::size_t second = simulation.round_begin[1];
  // The first round is driven without people in both.
  params.people.count = 0;
  const Simulation empty = people == 0 ? simulation : simulate(make_office({.area = 600, .seed = 3}), params).value();
  return {build_place_map(part_of(empty.log, 0, second)).value(),
          part_of(simulation.log, second, simulation.log.scans.size())};
}

const Building& office() {
  static const Building made = building(0);
  return made;
}

bool is_right(const TrackStep& step, const Pose2& truth) {
  return step.verdict == Verdict::unique && distance(step.map_from_robot, truth) <= 0.5 &&
         heading_difference(step.map_from_robot, truth) <= radians_from_degrees(10);
}

struct Tracked {
  std::optional<std::size_t> until_right{};  ///< scans
  std::size_t right{0};
  std::size_t wrong{0};  ///< unique, but elsewhere
  std::vector<TrackStep> steps{};
};

Tracked tracked(Tracker& tracker, const ScanLog& drive) {
  Tracked result;
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    result.steps.push_back(tracker.add(drive.scans[i]));
    const TrackStep& step = result.steps.back();
    const bool right = is_right(step, drive.map_from_robot[i]);
    result.right += right ? 1U : 0U;
    result.wrong += step.verdict == Verdict::unique && !right ? 1U : 0U;
    if (right && !result.until_right) { result.until_right = i + 1; }
  }
  return result;
}

Tracked tracked(const PlaceMap& map, const ScanLog& drive, const TrackerParams& params = {}, std::size_t threads = 1) {
  Tracker tracker(map, params, threads);
  return tracked(tracker, drive);
}

TEST(Tracker, FollowsADriveByOdometryThatDrifts) {
  const ScanLog drive = part_of(office().drive, 0, 100);
  const Tracked result = tracked(office().map, drive);
  EXPECT_GE(result.right, 95U);
  EXPECT_EQ(result.wrong, 0U);
}

TEST(Tracker, FollowsADriveWithoutOdometry) {
  ScanLog drive = part_of(office().drive, 0, 100);
  for (Scan& scan : drive.scans) { scan.odom_from_robot.reset(); }
  const Tracked result = tracked(office().map, drive);
  EXPECT_GE(result.right, 95U);
  EXPECT_EQ(result.wrong, 0U);
}

TEST(Tracker, KidnappedRobotRecovers) {
  // The robot is carried away: its odometry goes on from where it was, as if nothing had happened.
  const ScanLog before = part_of(office().drive, 0, 30);
  ScanLog after = part_of(office().drive, 100, 140);
  ASSERT_GT(distance(before.map_from_robot.back(), after.map_from_robot.front()), 3.0);
  const Pose2 odom_from_new = *before.scans.back().odom_from_robot * inverse(*after.scans.front().odom_from_robot);
  for (Scan& scan : after.scans) { scan.odom_from_robot = odom_from_new * *scan.odom_from_robot; }
  Tracker tracker(office().map);
  EXPECT_GE(tracked(tracker, before).right, 25U);
  const Tracked recovered = tracked(tracker, after);
  ASSERT_TRUE(recovered.until_right);
  std::printf("kidnapped: right again after %zu scans\n", *recovered.until_right);
  EXPECT_LE(*recovered.until_right, 20U);
  EXPECT_TRUE(is_right(recovered.steps.back(), after.map_from_robot.back()));
}

TEST(Tracker, TwinRoomsAreResolvedByMoving) {
  // Two like rooms; behind the door of one there is a closet, behind that of the other there is none.
  const Pose2 map_from_twin{30, 5, 1.2};
  const Scene closet = box({8, 2, 0}, 3, 2);
  const auto opened = [] {
    Scene room;
    for (const Wall& wall : furnished_room()) {
      const bool is_door = wall.begin == Point2{5, 2} && wall.end == Point2{5, 4};
      if (!is_door) { room.push_back(wall); }
    }
    return room;
  };
  const Scene first = joined(opened(), closet);
  const Scene scene = joined(first, moved(opened(), map_from_twin));
  std::vector<Pose2> poses = poses_around(1.2, 6);
  poses.push_back({4.5, 3, 0});
  for (std::size_t i = 0, n = poses.size(); i < n; ++i) { poses.push_back(map_from_twin * poses[i]); }
  const PlaceMap map = build_place_map(log_of(scene, poses)).value();
  ScanLog drive;
  for (int i = 0; i < 24; ++i) {
    // From a corner from which the door can't be seen through, to the door.
    const double share = std::max(0.0, (i - 4) / 19.0);
    const Pose2 pose{-3.9 + 8.4 * share, -3 + 6 * share, 0.5};
    drive.scans.push_back(scan_of(scene, pose, turn_beams(), turn_beam_count));
    for (double& range : drive.scans.back().ranges) { range = range > 6 ? 30 : range; }  // sees 6 m
    drive.scans.back().odom_from_robot = pose;
    drive.map_from_robot.push_back(pose);
  }
  const Tracked result = tracked(map, drive);
  EXPECT_EQ(result.steps.front().verdict, Verdict::ambiguous);
  EXPECT_GE(result.steps.front().clusters.size(), 2U);
  EXPECT_TRUE(is_right(result.steps.back(), drive.map_from_robot.back()));
  EXPECT_EQ(result.wrong, 0U);
}

TEST(Tracker, CrowdDoesNotBreakIt) {
  const Building crowded = building(15);
  const ScanLog drive = part_of(crowded.drive, 0, 100);
  const Tracked result = tracked(crowded.map, drive);
  EXPECT_GE(result.right, 90U);
  EXPECT_LE(result.wrong, 1U);
}

ScanLog drive_elsewhere() {
  SimulateParams params;
  params.drive.round_length = 25;
  params.drive.rounds = 1;
  params.seed = 8;
  ScanLog drive = simulate(make_office({.area = 600, .seed = 8}), params).value().log;
  for (Pose2& pose : drive.map_from_robot) { pose.x += 1000; }  // whatever is said is wrong
  return drive;
}

TEST(Tracker, ADriveThroughAnotherBuildingIsNotFound) {
  const ScanLog drive = drive_elsewhere();
  const Tracked result = tracked(office().map, drive);
  ASSERT_GE(drive.scans.size(), 60U);
  EXPECT_EQ(result.right, 0U);
  EXPECT_LE(static_cast<double>(result.wrong), 0.01 * static_cast<double>(drive.scans.size()));
}

TEST(Tracker, ADriveThroughAnotherBuildingIsNotFoundWithoutOdometryEither) {
  ScanLog drive = part_of(drive_elsewhere(), 0, 40);
  for (Scan& scan : drive.scans) { scan.odom_from_robot.reset(); }
  const Tracked result = tracked(office().map, drive);
  EXPECT_EQ(result.right, 0U);
  EXPECT_EQ(result.wrong, 0U);
}

TEST(Tracker, AScanWithoutReadingsOnTheWayDoesNotLoseIt) {
  ScanLog drive = part_of(office().drive, 0, 40);
  std::ranges::fill(drive.scans[20].ranges, std::nan(""));
  const Tracked result = tracked(office().map, drive);
  EXPECT_EQ(result.steps[20].points, 0U);
  EXPECT_TRUE(is_right(result.steps[20], drive.map_from_robot[20]));
  EXPECT_TRUE(is_right(result.steps[21], drive.map_from_robot[21]));
}

TEST(Tracker, EqualSeedsGiveEqualAnswersOnAnyNumberOfThreads) {
  const ScanLog drive = part_of(office().drive, 0, 20);
  const Tracked one = tracked(office().map, drive, {.seed = 5}, 1);
  const Tracked same = tracked(office().map, drive, {.seed = 5}, 3);
  const Tracked other = tracked(office().map, drive, {.seed = 6}, 1);
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    EXPECT_EQ(one.steps[i].map_from_robot, same.steps[i].map_from_robot);
    EXPECT_EQ(one.steps[i].share, same.steps[i].share);
  }
  EXPECT_NE(one.steps.back().map_from_robot, other.steps.back().map_from_robot);
}

TEST(Tracker, HypothesesNeedFewerScansThanParticlesAllOverTheMap) {
  // One room, so that plain Monte Carlo localization has a fair chance, too.
  const PlaceMap map = build_place_map(log_of(furnished_room(), poses_around(1.2, 8))).value();
  std::vector<Pose2> poses;
  poses.reserve(30);
  for (int i = 0; i < 30; ++i) { poses.push_back({-1.5 + 0.1 * i, 0.5 - 0.05 * i, 0.03 * i}); }
  ScanLog drive = log_of(furnished_room(), poses);
  for (std::size_t i = 0; i < poses.size(); ++i) { drive.scans[i].odom_from_robot = poses[i]; }
  std::printf("scans until rightly localized, in one room:\n");
  const auto until = [&](const TrackerParams& params, std::uint32_t particles) {
    const Tracked result = tracked(map, drive, params, 2);
    std::printf("  %-10s  %5u particles: %zu, %zu wrong\n", std::string(to_string(params.initialisation)).c_str(),
                particles, result.until_right.value_or(poses.size() + 1), result.wrong);
    return result.until_right.value_or(poses.size() + 1);
  };
  const std::size_t from_hypotheses = until({.particles = 200}, 200);
  EXPECT_LE(from_hypotheses, 4U);
  for (const std::uint32_t particles : {200U, 2000U, 20000U}) {
    const std::size_t everywhere =
        until({.initialisation = TrackInitialisation::uniform, .uniform = {.particles = particles}}, particles);
    EXPECT_LT(from_hypotheses, everywhere);
    if (particles == 20000) { EXPECT_LE(everywhere, poses.size()) << "the baseline works where it should"; }
  }
}

TEST(Tracker, IsLostInAnEmptyMapAndWithoutReadings) {
  Tracker nowhere(PlaceMapBuilder().build());
  EXPECT_EQ(nowhere.add(office().drive.scans.front()).verdict, Verdict::lost);
  Scan blind = office().drive.scans.front();
  std::ranges::fill(blind.ranges, std::nan(""));
  Tracker tracker(office().map);
  EXPECT_EQ(tracker.add(blind).verdict, Verdict::lost);
  EXPECT_TRUE(tracker.particles().empty());
}

}  // namespace
}  // namespace flirt
