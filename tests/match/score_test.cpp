#include "flirt/match/score.hpp"

#include "tests/match/random_features.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace flirt {
namespace {

KeypointTable random_table(Rng& rng, std::size_t count) {
  std::vector<Keypoint> keypoints;
  for (std::size_t i = 0; i < count; ++i) {
    keypoints.push_back({.sensor_from_keypoint = test::random_pose(rng, 3.0)});
  }
  return table_of(keypoints);
}

double slow_cost(const Pose2& reference_from_query, const KeypointTable& query, const KeypointTable& reference,
                 double limit) {
  double cost = 0.0;
  for (std::size_t i = 0; i < query.x.size(); ++i) {
    double smallest = limit;
    for (std::size_t j = 0; j < reference.x.size(); ++j) {
      const Point2 moved = reference_from_query * Point2{query.x[i], query.y[i]};
      smallest = std::min(smallest, squared_norm(moved - Point2{reference.x[j], reference.y[j]}));
    }
    cost += smallest;
  }
  return cost;
}

ScoredPoints scored(const KeypointTable& table) {
  ScoredPoints points;
  points.assign(table.columns());
  return points;
}

std::vector<float> costs_of(const std::vector<Motion>& motions, const KeypointTable& query,
                            const KeypointTable& reference, MovedPoints& workspace) {
  std::vector<float> costs(motions.size());
  truncated_costs(motions, scored(query), reference.columns(), 0.5F, workspace, costs);
  return costs;
}

Motion motion_from(const Pose2& pose) {
  return motion_of({std::cos(pose.theta), std::sin(pose.theta), pose.translation()});
}

TEST(TruncatedCosts, AgreeWithPlainLoopsForAnyCount) {
  Rng rng(1);
  MovedPoints workspace;
  for (const std::size_t queries : {1U, 7U, 16U, 17U, 33U}) {
    for (const std::size_t references : {0U, 1U, 5U, 40U}) {
      const KeypointTable query = random_table(rng, queries);
      const KeypointTable reference = random_table(rng, references);
      for (const std::size_t count : {0U, 1U, 2U, 5U, 30U}) {
        std::vector<Pose2> poses(count);
        std::vector<Motion> motions;
        motions.reserve(count);
        for (Pose2& pose : poses) { motions.push_back(motion_from(pose = test::random_pose(rng, 2.0))); }
        const std::vector<float> costs = costs_of(motions, query, reference, workspace);
        for (std::size_t i = 0; i < count; ++i) {
          EXPECT_NEAR(costs[i], slow_cost(poses[i], query, reference, 0.5), 1e-4);
        }
      }
    }
  }
}

TEST(TruncatedCosts, OfManyMotionsAreThoseOfEachAloneBitByBit) {
  Rng rng(2);
  MovedPoints workspace;
  for (const std::size_t queries : {3U, 16U, 25U, 40U}) {
    const KeypointTable query = random_table(rng, queries);
    const KeypointTable reference = random_table(rng, 26);
    std::vector<Motion> motions;
    motions.reserve(50);
    for (int i = 0; i < 50; ++i) { motions.push_back(motion_from(test::random_pose(rng, 1.0))); }
    const std::vector<float> together = costs_of(motions, query, reference, workspace);
    for (std::size_t i = 0; i < motions.size(); ++i) {
      EXPECT_EQ(together[i], costs_of({motions[i]}, query, reference, workspace).front());
    }
  }
}

TEST(NearestPoints, AgreesWithPlainLoopsAndTakesTheFirstOfEqualOnes) {
  Rng rng(3);
  const KeypointTable query = random_table(rng, 37);
  KeypointTable reference = random_table(rng, 20);
  for (std::size_t j = 0; j < 20; ++j) {  // every reference point twice
    reference.x.push_back(reference.x[j]);
    reference.y.push_back(reference.y[j]);
    reference.theta.push_back(0.0F);
  }
  ScoredPoints points;
  points.assign(query.columns());
  std::vector<std::uint32_t> nearest(48);
  std::vector<float> distances(48);
  nearest_points({}, points, reference.columns(), nearest, distances);
  for (std::size_t i = 0; i < 37; ++i) {
    std::uint32_t expected = 0;
    const auto squared = [&](std::size_t j) {
      return std::pow(query.x[i] - reference.x[j], 2.0F) + std::pow(query.y[i] - reference.y[j], 2.0F);
    };
    for (std::uint32_t j = 1; j < 40; ++j) {
      if (squared(j) < squared(expected)) { expected = j; }
    }
    EXPECT_EQ(nearest[i], expected);
    EXPECT_LT(nearest[i], 20U);
    EXPECT_FLOAT_EQ(distances[i], squared(expected));
  }
}

CandidateColumns random_candidates(Rng& rng, std::size_t count) {
  CandidateColumns candidates;
  candidates.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (auto* column : {&candidates.query_x, &candidates.query_y, &candidates.reference_x, &candidates.reference_y}) {
      (*column)[i] = static_cast<float>(rng.uniform(-2.0, 2.0));
    }
    candidates.turn[i] = static_cast<float>(rng.uniform(-6.2, 6.2));
  }
  fill_turns(candidates);
  return candidates;
}

TEST(FillTurns, IsCosineAndSine) {
  Rng rng(4);
  const CandidateColumns candidates = random_candidates(rng, 45);
  for (std::size_t i = 0; i < 45; ++i) {
    EXPECT_NEAR(candidates.turn_cosine[i], std::cos(candidates.turn[i]), 1e-6);
    EXPECT_NEAR(candidates.turn_sine[i], std::sin(candidates.turn[i]), 1e-6);
  }
}

/// The papers' quantities with angles and lengths.
bool may_be_rigid(const CandidateColumns& c, std::size_t i, std::size_t j, const PairLimits& limits) {
  const Point2 query{c.query_x[j] - c.query_x[i], c.query_y[j] - c.query_y[i]};
  const Point2 reference{c.reference_x[j] - c.reference_x[i], c.reference_y[j] - c.reference_y[i]};
  const double sum = squared_norm(query) + squared_norm(reference);
  const double change = squared_norm(query) - squared_norm(reference);
  const double turn = std::atan2(reference.y, reference.x) - std::atan2(query.y, query.x);
  const auto agrees = [&](std::size_t k) { return std::cos(turn - c.turn[k]) >= limits.turn_cosine; };
  return change * change / (8.0 * sum) <= limits.length_change && agrees(i) && agrees(j);
}

TEST(RigidPairs, AreThoseThatKeepLengthAndTurnByTheirLaterCandidate) {
  Rng rng(5);
  std::size_t found = 0;
  RigidPairs pairs;
  for (const std::size_t count : {2U, 9U, 16U, 17U, 50U}) {
    const CandidateColumns candidates = random_candidates(rng, count);
    for (const PairLimits limits : {PairLimits{0.0384F, 1e-6F, -2.0F}, PairLimits{0.1F, 1e-6F, 0.3F}}) {
      rigid_pairs(candidates, count, limits, pairs);
      std::vector<CandidatePair> expected;
      for (std::uint32_t j = 0; j < count; ++j) {
        for (std::uint32_t i = 0; i < j; ++i) {
          EXPECT_EQ(may_be_rigid(candidates, i, j, limits), is_rigid_pair(candidates, i, j, limits));
          if (is_rigid_pair(candidates, i, j, limits)) { expected.push_back({i, j}); }
        }
      }
      EXPECT_EQ(pairs.pairs, expected);
      found += pairs.pairs.size();
    }
  }
  EXPECT_GT(found, 20U);
}

TEST(RigidPairs, KnowNoneAmongFewerThanTwoCandidates) {
  Rng rng(8);
  const CandidateColumns candidates = random_candidates(rng, 20);
  RigidPairs pairs{{{0, 1}}, {}};
  rigid_pairs(candidates, 1, {0.0384F, 1e-6F, -2.0F}, pairs);
  EXPECT_TRUE(pairs.pairs.empty());
}

TEST(RigidPairs, LeaveOutSegmentsWithoutDirection) {
  CandidateColumns candidates;
  candidates.resize(2);
  candidates.query_x[1] = 0.5e-3F;
  candidates.reference_x[1] = 0.5e-3F;
  RigidPairs pairs;
  rigid_pairs(candidates, 2, {0.04F, 1e-6F, -2.0F}, pairs);
  EXPECT_EQ(pairs.pairs.size(), 0U);
  rigid_pairs(candidates, 2, {0.04F, 1e-8F, -2.0F}, pairs);
  EXPECT_EQ(pairs.pairs.size(), 1U);
}

TEST(MotionOfSegment, IsTheSameFromEitherEnd) {
  Rng rng(9);
  const CandidateColumns c = random_candidates(rng, 16);
  for (std::size_t i = 0; i < 16; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Motion forth = motion_of_segment(c, i, j);
      const Motion back = motion_of_segment(c, j, i);
      EXPECT_EQ(forth.cosine, back.cosine);
      EXPECT_EQ(forth.sine, back.sine);
      EXPECT_EQ(forth.x, back.x);
      EXPECT_EQ(forth.y, back.y);
    }
  }
}

TEST(MotionOfSegment, MapsMiddleAndDirection) {
  Rng rng(6);
  const CandidateColumns c = random_candidates(rng, 2);
  const Pose2 pose = rigid_motion_of(motion_of_segment(c, 0, 1)).pose();
  const Point2 first = pose * Point2{c.query_x[0], c.query_y[0]};
  const Point2 second = pose * Point2{c.query_x[1], c.query_y[1]};
  EXPECT_NEAR(first.x + second.x, c.reference_x[0] + c.reference_x[1], 1e-5);
  EXPECT_NEAR(first.y + second.y, c.reference_y[0] + c.reference_y[1], 1e-5);
  const Point2 segment{c.reference_x[1] - c.reference_x[0], c.reference_y[1] - c.reference_y[0]};
  EXPECT_NEAR(cross(second - first, segment), 0.0, 1e-4);
  EXPECT_GT(dot(second - first, segment), 0.0);
}

TEST(TableOf, PutsKeypointsThatAreNotUsableOutOfSight) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Keypoint> keypoints{{.sensor_from_keypoint = {1, 2, 3}},
                                        {.sensor_from_keypoint = {nan, 0, 0}},
                                        {.sensor_from_keypoint = {0, 0, nan}},
                                        {.sensor_from_keypoint = {0, -1e9, 0}}};
  const KeypointTable table = table_of(keypoints);
  EXPECT_EQ(table.x, (std::vector<float>{1.0F, out_of_sight, out_of_sight, out_of_sight}));
  EXPECT_EQ(table.theta, (std::vector<float>{3.0F, 0.0F, 0.0F, 0.0F}));
  MovedPoints workspace;
  EXPECT_NEAR(costs_of(std::vector<Motion>(1), table, table, workspace).front(), 1.5F, 1e-6)
      << "only the usable point lies on itself";
}

}  // namespace
}  // namespace flirt
