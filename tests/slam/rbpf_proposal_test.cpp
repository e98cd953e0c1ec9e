#include "flirt/slam/rbpf_proposal.hpp"

#include <gtest/gtest.h>

namespace flirt {
namespace {

/// The walls of a room of 6 m × 4 m around the robot, no two alike.
std::vector<Point2> room() {
  std::vector<Point2> ends;
  for (double x = -2; x <= 4; x += 0.04) { ends.insert(ends.end(), {{x, -1.5}, {x, 2.5}}); }
  for (double y = -1.5; y <= 2.5; y += 0.04) { ends.insert(ends.end(), {{-2, y}, {4, y}}); }
  return ends;
}

std::vector<Point2> seen_from(const std::vector<Point2>& points, const Pose2& robot) {
  std::vector<Point2> seen;
  for (const Point2 p : points) { seen.push_back(inverse(robot) * p); }
  return seen;
}

class RbpfProposal : public testing::Test {
 protected:
  RbpfProposal() { map_.add({}, room(), {}); }
  RbpfMap map_{0.05};
  Pose2 truth_{0.12, -0.05, 0.06};
  std::vector<Point2> scan_ = seen_from(room(), truth_);
  RbpfParams params_{};
};

TEST_F(RbpfProposal, ClimbsToTheTruePose) {
  const MotionBelief belief{{}, 0.2, 0.1};
  const Pose2 found = climb(map_, scan_, belief.map_from_robot, belief, params_);
  EXPECT_LT(distance(found, truth_), 0.02);
  EXPECT_LT(heading_difference(found, truth_), 0.01);
}

TEST_F(RbpfProposal, DrawsPosesAroundIt) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed);
    const Proposal proposal = propose(map_, scan_, {{}, 0.2, 0.1}, params_, rng);
    EXPECT_TRUE(proposal.matched);
    EXPECT_LT(distance(proposal.map_from_robot, truth_), 0.06);
  }
}

TEST_F(RbpfProposal, DrawsFromTheMotionWhereTheMapExplainsNothing) {
  const MotionBelief far{{50, 50, 0}, 0.2, 0.1};
  Rng rng(1);
  const Proposal proposal = propose(map_, scan_, far, params_, rng);
  EXPECT_FALSE(proposal.matched);
  EXPECT_LT(distance(proposal.map_from_robot, far.map_from_robot), 1);
  EXPECT_NE(proposal.map_from_robot, far.map_from_robot);
}

TEST_F(RbpfProposal, WeighsAParticleMoreWhoseMapExplainsTheScanBetter) {
  RbpfMap other(0.05);
  std::vector<Point2> crooked = room();
  for (Point2& p : crooked) { p.x *= 1.06; }
  other.add({}, crooked, {});
  Rng rng(1);
  Rng again(1);
  EXPECT_GT(propose(map_, scan_, {{}, 0.2, 0.1}, params_, rng).log_weight,
            propose(other, scan_, {{}, 0.2, 0.1}, params_, again).log_weight + 1);
}

TEST(RbpfMotion, IsLessSureAfterALongerMotion) {
  const MotionBelief still = belief_from_odometry({}, {}, {});
  const MotionBelief moved = belief_from_odometry({1, 2, 0.5}, {2, 0, 1}, {});
  EXPECT_GT(moved.way_deviation, still.way_deviation);
  EXPECT_GT(moved.turn_deviation, still.turn_deviation);
  EXPECT_EQ(moved.map_from_robot, (Pose2{1, 2, 0.5} * Pose2{2, 0, 1}));
}

}  // namespace
}  // namespace flirt
