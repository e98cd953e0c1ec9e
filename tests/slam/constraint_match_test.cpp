#include "flirt/slam/constraint_match.hpp"

#include "tests/slam/matched_scans.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace flirt {
namespace {

const Pose2 second_pose{0.3, -0.2, 0.25};

/// Two scans of which `agreeing` keypoints are the same; those of the second each `off` m from where they should be.
struct Two {
  SlamScan earlier{};
  SlamScan query{};
};
Two two_scans(std::size_t agreeing, double off = 0) {
  Two two;
  test::put_keypoints(two.earlier, {}, agreeing, 1);
  test::put_keypoints(two.query, second_pose, agreeing, 2);
  for (std::size_t i = 0; i < agreeing; ++i) {
    const double angle = 2.4 * static_cast<double>(i);
    Pose2& at = two.query.features.keypoints[i].sensor_from_keypoint;
    at.x += off * std::cos(angle);
    at.y += off * std::sin(angle);
  }
  two.query.keypoints = table_of(two.query.features.keypoints);
  return two;
}

std::optional<ConstraintMatch> matched(const Two& two, const FlirtParams& params = {}) {
  ConstraintMatcher matcher(params);
  matcher.set_query(two.query);
  return matcher.match(two.earlier);
}

/// Whether the full scans agree that the query's sensor stands at `found`.
std::optional<ConstraintMatch> verified(const Scan& earlier, const Scan& query, const Pose2& found,
                                        const FlirtParams& params = {}) {
  ConstraintMatcher matcher(params);
  const SlamScan second{.scan = query};
  matcher.set_query(second);
  return matcher.verified({.scan = earlier}, {.earlier_from_robot = found});
}

TEST(ConstraintMatch, NeedsMoreThanSixInliers) {
  EXPECT_FALSE(matched(two_scans(6)));
  const auto found = matched(two_scans(7));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers, 7U);
  EXPECT_LT(distance(found->earlier_from_robot, second_pose), 1e-4);
  EXPECT_LT(heading_difference(found->earlier_from_robot, second_pose), 1e-4);
  EXPECT_FALSE(matched(two_scans(7), {.min_inliers = 7}));
}

TEST(ConstraintMatch, RefusesInliersThatAreTooFarOffInTheMean) {
  const Two two = two_scans(12, 0.1);
  const auto found = matched(two);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers, 12U);
  EXPECT_NEAR(found->inlier_error, 0.01, 0.003);  // m², less what the motion takes up
  EXPECT_TRUE(matched(two, {.max_inlier_error = 1.01 * found->inlier_error}));
  EXPECT_FALSE(matched(two, {.max_inlier_error = 0.99 * found->inlier_error}));
}

TEST(ConstraintMatch, SamplesAsItIsTold) {
  Two two = two_scans(9);
  for (std::size_t i = 0; i < 9; ++i) { two.query.features.keypoints[i].sensor_from_keypoint.theta += 2; }
  two.query.keypoints = table_of(two.query.features.keypoints);
  EXPECT_FALSE(matched(two));  // no sample turns as its keypoints do
  FlirtParams params;
  params.ransac = {.sampling = Sampling::random, .max_turn_difference = std::numbers::pi};
  EXPECT_TRUE(matched(two, params));
}

TEST(ConstraintMatch, RefusesAScanThatIsShifted) {
  const Scan here = test::seen_in_room({});
  const Scan there = test::seen_in_room(second_pose);
  const auto found = verified(here, there, second_pose);
  ASSERT_TRUE(found);
  EXPECT_LT(found->scan_error, 0.01);
  const Pose2 shifted = Pose2{0.12, 0.12, 0} * second_pose;  // aside from walls along either axis
  EXPECT_FALSE(verified(here, there, shifted));
  const auto forgiven = verified(here, there, shifted, {.max_scan_error = 0.2});
  ASSERT_TRUE(forgiven);
  EXPECT_NEAR(forgiven->scan_error, 0.12, 0.04);
}

TEST(ConstraintMatch, RefusesAScanOfWhichMoreLiesInFreeSpaceThanOnWalls) {
  const Beams beams = turn_beams();
  const Scan small = scan_of(box({}, 4, 6), {}, beams, turn_beam_count);
  const Scan large = scan_of(box({}, 9, 6), {}, beams, turn_beam_count);  // two walls are the same
  EXPECT_FALSE(verified(large, small, {}));
  EXPECT_FALSE(verified(small, large, {}));
  const auto forgiven = verified(large, small, {}, {.max_scan_error = 0.31});
  ASSERT_TRUE(forgiven);
  EXPECT_EQ(forgiven->scan_error, 0.3);
}

TEST(ConstraintMatch, RefusesScansThatTellLittleOfEachOther) {
  const Scan whole = test::seen_in_room({});
  Scan part = whole;  // a fifth of the beams
  for (std::size_t i = turn_beam_count / 5; i < turn_beam_count; ++i) {
    part.ranges[i] = std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_FALSE(verified(part, whole, {}));
  EXPECT_FALSE(verified(whole, part, {}));  // both ways
  EXPECT_TRUE(verified(part, whole, {}, {.min_comparable = 0.1}));
}

TEST(ConstraintMatch, IcpDrawsTheMotionOntoTheScan) {
  const SlamScan here = test::with_keypoints(test::seen_in_room({}));
  const SlamScan there = test::with_keypoints(test::seen_in_room(second_pose));
  const ConstraintMatch coarse{.earlier_from_robot = second_pose * Pose2{0.05, -0.04, 0.02}};
  const auto off_after = [&](FlirtRefinement refinement) {
    ConstraintMatcher matcher({.refinement = refinement});
    matcher.set_query(there);
    return distance(matcher.refined(here, coarse).earlier_from_robot, second_pose);
  };
  EXPECT_NEAR(off_after(FlirtRefinement::off), std::hypot(0.05, 0.04), 1e-12);
  EXPECT_LT(off_after(FlirtRefinement::icp), 0.005);
}

/// A motion between sensors whose coordinates are wrong by chance, seen as the motion between robots that it means.
TEST(ConstraintMatch, CovarianceOfTheRobotsMotionIsThatOfManyMotions) {
  const Pose2 reference_from_query{1.5, -0.7, 0.9};
  const Pose2 robot_from_sensor{0.4, -0.3, 2.1};
  Eigen::Matrix3d root;  // of the covariance, in the reference's frame
  root << 2e-3, 0, 0, 1e-3, 1e-3, 0, -5e-4, 5e-4, 2e-3;
  const auto robots = [&](const Pose2& motion) { return robot_from_sensor * motion * inverse(robot_from_sensor); };
  constexpr int draws = 20000;
  Rng rng(5);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < draws; ++i) {
    const Eigen::Vector3d off = root * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    const Pose2 wrong{reference_from_query.x + off.x(), reference_from_query.y + off.y(),
                      reference_from_query.theta + off.z()};
    const Pose2 error = inverse(robots(wrong)) * robots(reference_from_query);  // as PoseEdge has it
    const Eigen::Vector3d e(error.x, error.y, error.theta);
    sum += e * e.transpose();
  }
  const Eigen::Matrix3d found =
      robot_information(root * root.transpose(), reference_from_query, robot_from_sensor).inverse();
  EXPECT_LT((found - sum / draws).norm(), 0.03 * found.norm()) << found << "\n" << sum / draws;
}

}  // namespace
}  // namespace flirt
