#include "flirt/eval/trajectory_metrics.hpp"

#include "flirt/core/rng.hpp"

#include "tests/support/numbers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace flirt {
namespace {

std::vector<PosePair> pairs_of(const std::vector<Pose2>& estimate, const std::vector<Pose2>& truth) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < truth.size(); ++i) { pairs.push_back({static_cast<double>(i), estimate[i], truth[i]}); }
  return pairs;
}

TEST(Align, UndoesAMotionOfTheWholeTrajectory) {
  Rng rng(1);
  const Pose2 truth_from_estimate{3, -40, 2.5};
  std::vector<Pose2> estimate;
  std::vector<Pose2> truth;
  for (int i = 0; i < 30; ++i) {
    estimate.push_back({rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-3, 3)});
    truth.push_back(truth_from_estimate * estimate.back());
  }
  const Pose2 found = align_trajectories(pairs_of(estimate, truth));
  EXPECT_LT(distance(found, truth_from_estimate), 1e-9);
  EXPECT_LT(heading_difference(found, truth_from_estimate), 1e-9);
  EXPECT_LT(absolute_error(pairs_of(estimate, truth)).translation.max, 1e-9);
}

TEST(Align, GoesByTheFirstHeadingWhereTheRobotStoodStill) {
  const std::vector<Pose2> estimate(3, {1, 1, 0.2});
  const std::vector<Pose2> truth(3, {5, 5, 1.2});
  const TrajectoryError error = absolute_error(pairs_of(estimate, truth));
  EXPECT_NEAR(error.translation.max, 0, 1e-12);
  EXPECT_NEAR(error.rotation_degrees.max, 0, 1e-9);
}

TEST(AbsoluteError, OfFourPosesIsWhatOneFindsByHand) {
  // A straight line, the estimate off sideways by +0.3, −0.3, −0.3, +0.3: the alignment can change nothing about it.
  const std::vector<Pose2> truth{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const std::vector<Pose2> estimate{{0, 0.3, 0}, {1, -0.3, 0}, {2, -0.3, 0}, {3, 0.3, 0}};
  const TrajectoryError error = absolute_error(pairs_of(estimate, truth));
  EXPECT_NEAR(error.translation.rmse, 0.3, 1e-12);
  EXPECT_NEAR(error.translation.mean, 0.3, 1e-12);
  EXPECT_NEAR(error.translation.median, 0.3, 1e-12);
  EXPECT_NEAR(error.translation.max, 0.3, 1e-12);
  EXPECT_EQ(error.translation.count, 4U);
}

TEST(AbsoluteError, HasNoScale) {
  // Twice as long an estimate: centred at 0, ±1 against ±2 leaves 1 m at both ends.
  const TrajectoryError error = absolute_error(pairs_of({{0, 0, 0}, {4, 0, 0}}, {{0, 0, 0}, {2, 0, 0}}));
  EXPECT_NEAR(error.translation.rmse, 1.0, 1e-12);
}

TEST(ErrorSummary, TakesTheSampleDeviation) {
  const ErrorSummary summary = summarize_errors(std::vector<double>{1, 2, 3, 6});
  EXPECT_DOUBLE_EQ(summary.mean, 3);
  EXPECT_DOUBLE_EQ(summary.deviation, std::sqrt(14.0 / 3));
  EXPECT_DOUBLE_EQ(summary.rmse, std::sqrt(50.0 / 4));
  EXPECT_DOUBLE_EQ(summary.median, 2.5);
  EXPECT_DOUBLE_EQ(summary.max, 6);
  EXPECT_EQ(summarize_errors({}).count, 0U);
}

TEST(RelativeError, OfOneBentStepIsWhatOneFindsByHand) {
  // Steps of 0.5 m; the estimate turns by 90° at its third pose and goes on straight, the truth never turns.
  const std::vector<Pose2> truth{{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {1.5, 0, 0}, {2, 0, 0}};
  const std::vector<Pose2> estimate{{0, 0, 0}, {0.5, 0, 0}, {1, 0, pi / 2}, {1, 0.5, pi / 2}, {1, 1, pi / 2}};
  const TrajectoryError error = relative_error(pairs_of(estimate, truth), 1.0);
  // 0 → 2: turn 90°, no shift. 1 → 3: (0.5, 0.5) instead of (1, 0), 90°. 2 → 4: right. The others have no partner.
  EXPECT_EQ(error.translation.count, 3U);
  EXPECT_NEAR(error.translation.max, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(error.translation.rmse, std::sqrt(0.5 / 3), 1e-12);
  EXPECT_NEAR(error.rotation_degrees.mean, 60, 1e-9);
}

TEST(RelativeError, LeavesOutPosesWithoutAPartnerNearTheAskedPath) {
  const std::vector<Pose2> poses{{0, 0, 0}, {0.85, 0, 0}, {1.9, 0, 0}};
  EXPECT_EQ(relative_error(pairs_of(poses, poses), 1.0).translation.count, 1U) << "1.05 m counts, 0.85 m does not";
}

TEST(PairsByStamp, TakesTheNearestWithinTheToleranceAndCountsTheOthers) {
  const std::vector<StampedPose> truth{{2.0, {2, 0, 0}}, {1.0, {1, 0, 0}}, {3.0, {3, 0, 0}}};
  const std::vector<StampedPose> estimate{{1.0004, {}}, {1.9, {}}, {2.9996, {}}, {7.0, {}}};
  const PairedTrajectory paired = pairs_by_stamp(estimate, truth);
  ASSERT_EQ(paired.pairs.size(), 2U);
  EXPECT_EQ(paired.skipped, 2U);
  EXPECT_EQ(paired.pairs[0].truth.x, 1);
  EXPECT_EQ(paired.pairs[1].truth.x, 3);
  EXPECT_EQ(pairs_by_stamp(estimate, truth, 0.2).pairs.size(), 3U);
}

TEST(PosesOfScans, NothingWhereTheTrajectoryHasNone) {
  ScanLog log;
  for (const double stamp : {1.0, 1.0, 2.0, 3.0}) { log.scans.push_back({.stamp = stamp}); }
  const std::vector<StampedPose> trajectory{{1, {1, 0, 0}}, {1, {2, 0, 0}}, {3, {3, 0, 0}}, {4, {4, 0, 0}}};
  const std::vector<std::optional<Pose2>> poses = poses_of_scans(log, trajectory);
  ASSERT_EQ(poses.size(), 4U);
  EXPECT_EQ(poses[0].value_or(Pose2{}).x, 1);
  EXPECT_EQ(poses[1].value_or(Pose2{}).x, 2);
  EXPECT_FALSE(poses[2].has_value());
  EXPECT_EQ(poses[3].value_or(Pose2{}).x, 3);
}

TEST(PairsByStamp, PairsRepeatedStampsInTheirOrder) {
  const std::vector<StampedPose> truth{{5, {1, 0, 0}}, {5, {2, 0, 0}}, {5, {3, 0, 0}}};
  const std::vector<StampedPose> estimate{{5, {1, 0, 0}}, {5, {2, 0, 0}}, {5, {3, 0, 0}}, {5, {4, 0, 0}}};
  const PairedTrajectory paired = pairs_by_stamp(estimate, truth);
  ASSERT_EQ(paired.pairs.size(), 3U);
  for (const PosePair& pair : paired.pairs) { EXPECT_EQ(pair.truth, pair.estimate); }
  EXPECT_EQ(paired.skipped, 1U);
}

TEST(PairsByStamp, PairsManyPosesOfOneStampInNoTime) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 300'000; ++i) { poses.push_back({5, {static_cast<double>(i), 0, 0}}); }
  const PairedTrajectory paired = pairs_by_stamp(poses, poses);
  ASSERT_EQ(paired.pairs.size(), poses.size());
  EXPECT_TRUE(std::ranges::all_of(paired.pairs, [](const PosePair& pair) { return pair.truth == pair.estimate; }));
}

TEST(RelationsError, TellsItsTwoFormsApart) {
  // Expected 2 m ahead; found 2 m ahead after a turn of 90° at the second pose: the component difference sees no
  // shift, found * inverse(expected) goes back 2 m in the turned direction.
  const std::vector<StampedPose> estimate{{1, {5, 5, pi / 2}}, {2, {5, 7, pi}}};
  const std::vector<Relation> relations{{1, 2, {2, 0, 0}}, {1, 3, {0, 0, 0}}};
  const RelationsError error = relations_error(estimate, relations);
  EXPECT_EQ(error.skipped, 1U);
  EXPECT_EQ(error.difference.translation.count, 1U);
  EXPECT_NEAR(error.difference.translation.mean, 0, 1e-12);
  EXPECT_NEAR(error.motion.translation.mean, std::sqrt(8.0), 1e-12);
  EXPECT_NEAR(error.difference.rotation_degrees.mean, 90, 1e-9);
  EXPECT_NEAR(error.motion.rotation_degrees.mean, 90, 1e-9);
}

TEST(DerivedRelations, AreThoseOfTheTruthItself) {
  std::vector<StampedPose> truth;
  for (int i = 0; i < 50; ++i) { truth.push_back({0.1 * i, {0.5 * i, std::sin(0.3 * i), wrap_angle(0.2 * i)}}); }
  const std::vector<Relation> relations = derive_relations(truth, 7);
  EXPECT_EQ(relations.size(), 98U);
  EXPECT_LT(relations_error(truth, relations).motion.translation.max, 1e-9);
  for (const Relation& relation : relations) { EXPECT_LE(norm(relation.first_from_second.translation()), 10); }
  const std::vector<Relation> again = derive_relations(truth, 7);
  EXPECT_EQ(relations.back().first_stamp, again.back().first_stamp);
  EXPECT_TRUE(derive_relations({}, 7).empty());
}

}  // namespace
}  // namespace flirt
