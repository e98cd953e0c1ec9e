#include "flirt/graph/consistency.hpp"

#include "flirt/graph/clique.hpp"
#include "flirt/graph/optimize.hpp"

#include "tests/graph/graphs.hpp"

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

namespace flirt {
namespace {

using testing::ElementsAre;

RelativePose some_pose(double x, double y, double theta, double position, double heading) {
  return {{x, y, theta}, Eigen::Vector3d(position * position, position * position, heading * heading).asDiagonal()};
}

TEST(RelativePose, CovarianceOfAChainIsThatOfRandomDraws) {
  const RelativePose a_from_b = some_pose(3, 1, 0.8, 0.02, 0.03);
  const RelativePose b_from_c = inverse(some_pose(-2, 4, -1.2, 0.05, 0.01));
  const RelativePose chain = a_from_b * b_from_c;
  Rng rng(1);
  const Eigen::Matrix3d root_ab = a_from_b.covariance.llt().matrixL();
  const Eigen::Matrix3d root_bc = b_from_c.covariance.llt().matrixL();
  const auto draw = [&](const RelativePose& pose, const Eigen::Matrix3d& root) {
    const Eigen::Vector3d e = root * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    return pose.a_from_b * Pose2{e.x(), e.y(), e.z()};
  };
  Eigen::Matrix3d sample = Eigen::Matrix3d::Zero();
  constexpr int draws = 20000;
  for (int i = 0; i < draws; ++i) {
    const Pose2 error = inverse(chain.a_from_b) * draw(a_from_b, root_ab) * draw(b_from_c, root_bc);
    const Eigen::Vector3d e(error.x, error.y, error.theta);
    sample += e * e.transpose() / draws;
  }
  EXPECT_LT((sample - chain.covariance).norm(), 0.05 * chain.covariance.norm());
}

TEST(RelativePose, InverseOfTheInverseIsThePoseItself) {
  const RelativePose pose = some_pose(3, 1, 0.8, 0.02, 0.03);
  const RelativePose twice = inverse(inverse(pose));
  EXPECT_LT(distance(twice.a_from_b, pose.a_from_b), 1e-12);
  EXPECT_LT((twice.covariance - pose.covariance).norm(), 1e-12);
}

TEST(ShortestPaths, TakesTheDetourOfLessUncertainty) {
  PoseGraph graph{.map_from_node = std::vector<Pose2>(4)};
  const auto add = [&](std::uint32_t a, std::uint32_t b, Pose2 a_from_b, double deviation) {
    graph.edges.push_back({.a = a, .b = b, .a_from_b = a_from_b});
    graph.edges.back().information = Eigen::Matrix3d::Identity() / (deviation * deviation);
  };
  add(0, 3, {9, 9, 0}, 1.0);  // direct, and bad
  add(0, 1, {1, 0, 0}, 0.1);  // 0 → 1 → 2 → 3, one of them against its direction
  add(2, 1, {-1, 0, 0}, 0.1);
  add(2, 3, {1, 0, 0}, 0.1);
  const auto path = ShortestPaths(graph, 3).from(0);
  ASSERT_TRUE(path);
  EXPECT_LT(distance(path->a_from_b, {3, 0, 0}), 1e-12);
  EXPECT_NEAR(path->covariance(2, 2), 0.03, 1e-12);
  EXPECT_NEAR(path->covariance(0, 0), 0.03, 1e-12);
  // The heading errors of the first two edges both sit at node 1, of the second because it points back: 2 m of lever.
  EXPECT_NEAR(path->covariance(1, 1), 0.03 + 0.01 * (4 + 4), 1e-12);
}

TEST(ShortestPaths, IsNotThereBetweenSeparateParts) {
  PoseGraph graph{.map_from_node = std::vector<Pose2>(3)};
  graph.edges.push_back({.a = 0, .b = 1});
  const ShortestPaths to_last(graph, 2);
  EXPECT_FALSE(to_last.from(0));
  EXPECT_TRUE(passes_gate(to_last, {.a = 0, .b = 2})) << "nothing contradicts it";
}

TEST(Gate, PassesNineteenOfTwentyRightLoopsAndNoWrongOne) {
  const KnownGraph known = rounds(2, {0.01, 0.004}, 3);
  PoseGraph motion{.map_from_node = known.truth};
  for (const PoseEdge& edge : known.graph.edges) {
    if (edge.kind == EdgeKind::motion) { motion.edges.push_back(edge); }
  }
  int passed = 0;
  constexpr int tries = 400;
  for (int i = 0; i < tries; ++i) {
    Rng rng(static_cast<std::uint64_t>(1000 + i));
    PoseGraph drawn{.map_from_node = known.truth};
    for (std::uint32_t k = 0; k < 60; ++k) {
      drawn.edges.push_back(measured(known.truth, k, k + 1, EdgeKind::motion, {0.01, 0.004}, rng));
    }
    passed += passes_gate({drawn, 60}, measured(known.truth, 0, 60, EdgeKind::loop, {0.01, 0.004}, rng)) ? 1 : 0;
  }
  EXPECT_NEAR(passed, 0.95 * tries, 0.03 * tries);
  EXPECT_FALSE(passes_gate(
      {motion, 120}, {.a = 0, .b = 120, .a_from_b = {5, 5, 0}, .information = 1e4 * Eigen::Matrix3d::Identity()}));
}

std::size_t size_by_trying_all(const AgreementMatrix& agreement) {
  std::size_t best = 0;
  for (std::uint32_t set = 0; set < (1U << agreement.size()); ++set) {
    bool is_clique = true;
    for (std::size_t i = 0; i < agreement.size(); ++i) {
      for (std::size_t j = i + 1; j < agreement.size(); ++j) {
        if (((set >> i) & 1U) != 0 && ((set >> j) & 1U) != 0 && !agreement.agree(i, j)) { is_clique = false; }
      }
    }
    if (is_clique) { best = std::max(best, static_cast<std::size_t>(std::popcount(set))); }
  }
  return best;
}

TEST(LargestClique, IsAsLargeAsTheOneFoundByTryingAllSets) {
  Rng rng(5);
  for (int round = 0; round < 40; ++round) {
    AgreementMatrix agreement(12);
    for (std::size_t i = 0; i < 12; ++i) {
      for (std::size_t j = i + 1; j < 12; ++j) {
        if (rng.uniform() < 0.2 + 0.02 * round) { agreement.set(i, j); }
      }
    }
    const Clique clique = largest_clique(agreement, 1000000);
    EXPECT_TRUE(clique.is_largest);
    EXPECT_EQ(clique.members.size(), size_by_trying_all(agreement));
    for (const std::uint32_t i : clique.members) {
      for (const std::uint32_t j : clique.members) { EXPECT_TRUE(i == j || agreement.agree(i, j)); }
    }
  }
}

TEST(LargestClique, SaysWhenItGaveUp) {
  Rng rng(6);
  AgreementMatrix agreement(200);
  for (std::size_t i = 0; i < 200; ++i) {
    for (std::size_t j = i + 1; j < 200; ++j) {
      if (rng.uniform() < 0.5) { agreement.set(i, j); }
    }
  }
  const Clique clique = largest_clique(agreement, 10);
  EXPECT_FALSE(clique.is_largest);
  EXPECT_GE(clique.members.size(), 7U) << "greed alone finds as many in a random graph";
}

TEST(LargestClique, OfNothingIsNothing) {
  EXPECT_TRUE(largest_clique(AgreementMatrix(0), 10).members.empty());
  EXPECT_THAT(largest_clique(AgreementMatrix(1), 10).members, ElementsAre(0));
}

TEST(ConsistentLoops, KeepsRightLoopsAndDropsFalseOnes) {
  KnownGraph known = rounds(4, {0.02, 0.005}, 8);
  const std::size_t right_edges = known.graph.edges.size();
  const std::size_t right_loops = right_edges - (known.truth.size() - 1);
  add_false_loops(known.graph, 2 * right_loops, 8);
  const std::vector<std::uint32_t> kept = consistent_loops(known.graph);
  std::size_t right = 0;
  for (const std::uint32_t edge : kept) { right += edge < right_edges ? 1 : 0; }
  EXPECT_GE(right, right_loops * 8 / 10);
  EXPECT_LE(kept.size() - right, 1U);
}

TEST(ConsistentLoops, AllAgreeWithoutNoise) {
  const KnownGraph known = rounds(3, {}, 0);
  EXPECT_EQ(consistent_loops(known.graph).size(), known.graph.edges.size() - (known.truth.size() - 1));
}

TEST(ConsistentLoops, AMapOfThemSurvivesTwiceAsManyFalseLoopsAsRightOnes) {
  KnownGraph known = rounds(4, {0.02, 0.005}, 9);
  add_false_loops(known.graph, 2 * (known.graph.edges.size() - known.truth.size() + 1), 9);
  const std::vector<std::uint32_t> kept = consistent_loops(known.graph);
  PoseGraph graph{.map_from_node = known.graph.map_from_node};
  for (std::uint32_t k = 0; k < known.graph.edges.size(); ++k) {
    const bool stays = known.graph.edges[k].kind == EdgeKind::motion || std::binary_search(kept.begin(), kept.end(), k);
    if (stays) { graph.edges.push_back(known.graph.edges[k]); }
  }
  (void)optimize(graph, {.loss = RobustLoss::geman_mcclure});
  EXPECT_LT(worst_position(graph, known.truth), 0.3);
}

}  // namespace
}  // namespace flirt
