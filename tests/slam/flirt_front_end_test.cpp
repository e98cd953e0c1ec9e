#include "flirt/slam/flirt_front_end.hpp"

#include "tests/slam/matched_scans.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace flirt {
namespace {

constexpr double corridor_half_width = 1.2;  // m

/// Two bare walls whose ends are out of sight.
Scan corridor() {
  Scene walls{{{-100, -corridor_half_width}, {100, -corridor_half_width}},
              {{-100, corridor_half_width}, {100, corridor_half_width}}};
  Beams beams = turn_beams();
  beams.range_max = 8;
  return scan_of(walls, {}, beams, turn_beam_count);
}

/// Each beam ends somewhere.
Scan clutter_of(std::uint64_t seed) {
  Rng rng(seed);
  Scan scan{.beams = turn_beams()};
  for (std::size_t i = 0; i < turn_beam_count; ++i) { scan.ranges.push_back(rng.uniform(0.5, 6.0)); }
  return scan;
}

const Pose2 room_step{0.2, 0.05, 0.1};

/// A front end that has seen one step in a furnished room, and its motion.
ScanMotion first_motion(FlirtFrontEnd& front_end) {
  static_cast<void>(front_end.add(test::with_keypoints(test::seen_in_room({}))));
  return front_end.add(test::with_keypoints(test::seen_in_room(room_step)));
}

void expect_prediction(const ScanMotion& motion, const Pose2& expected) {
  const FlirtParams params;
  EXPECT_EQ(motion.source, MotionSource::prediction);
  EXPECT_TRUE(motion.unobservable);
  const RelativeMotion& relative = motion.relative.at(0);
  EXPECT_LT(distance(relative.earlier_from_robot, expected), 1e-9);
  EXPECT_LT(heading_difference(relative.earlier_from_robot, expected), 1e-9);
  const Eigen::Matrix3d covariance = relative.information.inverse();
  EXPECT_NEAR(covariance(0, 0), params.constant_translation * params.constant_translation, 1e-9);
  EXPECT_NEAR(covariance(1, 1), params.constant_translation * params.constant_translation, 1e-9);
  EXPECT_NEAR(covariance(2, 2), params.constant_rotation * params.constant_rotation, 1e-9);
}

TEST(FlirtFrontEnd, FindsAStepInAFurnishedRoom) {
  FlirtFrontEnd front_end{SlamParams{}};
  const ScanMotion motion = first_motion(front_end);
  EXPECT_EQ(motion.source, MotionSource::narrow);
  EXPECT_EQ(motion.structure, Structure::structured);
  EXPECT_FALSE(motion.unobservable);
  EXPECT_LT(distance(motion.relative.at(0).earlier_from_robot, room_step), 0.03);
}

TEST(FlirtFrontEnd, ABareCorridorIsFeaturelessAndTheLastMotionGoesOn) {
  FlirtFrontEnd front_end{SlamParams{}};
  const Pose2 last = first_motion(front_end).relative.at(0).earlier_from_robot;
  const ScanMotion motion = front_end.add(test::with_keypoints(corridor()));
  EXPECT_EQ(motion.structure, Structure::featureless);
  expect_prediction(motion, last);
  expect_prediction(front_end.add(test::with_keypoints(corridor())), last);  // and on
}

TEST(FlirtFrontEnd, RangesByChanceAreCluttered) {
  FlirtFrontEnd front_end{SlamParams{}};
  const Pose2 last = first_motion(front_end).relative.at(0).earlier_from_robot;
  for (const std::uint64_t seed : {1U, 2U}) {
    const ScanMotion motion = front_end.add(test::with_keypoints(clutter_of(seed)));
    EXPECT_EQ(motion.structure, Structure::cluttered);
    expect_prediction(motion, last);
  }
}

TEST(FlirtFrontEnd, FewKeypointsThatAgreeAreStructure) {
  FlirtFrontEnd front_end{SlamParams{}};
  SlamScan scan = test::with_keypoints(test::seen_in_room({}));
  test::put_keypoints(scan, {}, 9, 1);
  scan.features.keypoints.resize(9);  // fewer than `featureless_below`
  scan.features.descriptors.rows.resize(9 * std::size_t{scan.features.descriptors.stride});
  scan.features.descriptors.roots.resize(9 * std::size_t{scan.features.descriptors.stride});
  scan.keypoints = table_of(scan.features.keypoints);
  EXPECT_EQ(front_end.add(scan).structure, Structure::featureless);  // nothing to agree with
  const ScanMotion motion = front_end.add(scan);
  EXPECT_EQ(motion.structure, Structure::structured);
  EXPECT_EQ(motion.source, MotionSource::narrow);
}

TEST(DeadReckoning, TheMotionBeforeGoesOnWithoutOdometry) {
  DeadReckoning reckoning{SlamParams{}};
  const SlamScan scan;
  EXPECT_EQ(reckoning.motion(scan), Pose2{});
  reckoning.remember(scan, room_step);
  EXPECT_EQ(reckoning.motion(scan), room_step);
  reckoning.forget_motion();
  EXPECT_EQ(reckoning.motion(scan), Pose2{});
}

TEST(DeadReckoning, OdometryCountsOnceItMoves) {
  const SlamScan there{.odom_from_robot = Pose2{5, 3, 1}};
  const SlamScan next{.odom_from_robot = Pose2{5, 3, 1} * Pose2{1, 0, 0}};
  DeadReckoning reckoning{SlamParams{}};
  reckoning.remember(there, room_step);
  EXPECT_EQ(reckoning.motion(there), room_step);  // zeros in the log are no odometry
  EXPECT_LT(distance(reckoning.motion(next), {1, 0, 0}), 1e-12);
  // 0.05 m and 10 % of the way; 0.05 rad and as much a metre.
  EXPECT_NEAR(reckoning.information(next)(0, 0), 1 / (0.15 * 0.15), 1e-6);
  EXPECT_NEAR(reckoning.information(next)(2, 2), 1 / (0.1 * 0.1), 1e-6);
  EXPECT_NEAR(reckoning.information(there)(0, 0), 1 / (0.3 * 0.3), 1e-6);
  reckoning.remember(next, room_step);
  EXPECT_LT(norm(reckoning.motion(next).translation()), 1e-12);  // and then it may stand
}

TEST(DeadReckoning, OdometryCanBeIgnoredAndAWindowDoesSo) {
  const SlamScan there{.odom_from_robot = Pose2{}};
  const SlamScan next{.odom_from_robot = Pose2{1, 0, 0}};
  for (const SlamParams& params : {SlamParams{.odometry = OdometryUse::ignore}, SlamParams{.window = 20}}) {
    DeadReckoning reckoning(params);
    reckoning.remember(there, room_step);
    EXPECT_EQ(reckoning.motion(next), room_step);
  }
}

}  // namespace
}  // namespace flirt
