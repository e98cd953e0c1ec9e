#include "flirt/graph/edge_error.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

#include <array>

namespace flirt {
namespace {

Pose2 random_pose(Rng& rng) {
  return {rng.uniform(-20, 20), rng.uniform(-20, 20), rng.uniform(-3.1, 3.1)};
}

TEST(EdgeError, IsZeroWhereTheMeasurementHolds) {
  Rng rng(1);
  for (int i = 0; i < 20; ++i) {
    const Pose2 map_from_a = random_pose(rng);
    const PoseEdge edge{.a = 0, .b = 1, .a_from_b = random_pose(rng)};
    EXPECT_LT(edge_error(edge, map_from_a, map_from_a * edge.a_from_b).norm(), 1e-12);
  }
}

TEST(EdgeError, IsStatedInTheFrameOfB) {
  const PoseEdge edge{.a_from_b = {1, 0, radians_from_degrees(90)}};
  // b is 0.1 m too far ahead of a, which is to the right of b, which looks left.
  const Eigen::Vector3d error = edge_error(edge, {5, 5, 0}, {6.1, 5, radians_from_degrees(90)});
  EXPECT_NEAR(error.x(), 0, 1e-12);
  EXPECT_NEAR(error.y(), -0.1, 1e-12);
  EXPECT_NEAR(error.z(), 0, 1e-12);
}

TEST(EdgeError, DerivativesAreThoseOfNumericDifferences) {
  Rng rng(2);
  constexpr double step = 1e-6;
  for (int i = 0; i < 50; ++i) {
    const std::array<Pose2, 2> poses{random_pose(rng), random_pose(rng)};
    const PoseEdge edge{.a_from_b = inverse(poses[0]) * poses[1] * Pose2{0.3, -0.2, rng.uniform(-1, 1)}};
    const LinearizedEdge linear = linearize(edge, poses[0], poses[1]);
    EXPECT_EQ(linear.error, edge_error(edge, poses[0], poses[1]));
    for (int column = 0; column < 6; ++column) {
      const auto error_at = [&](double offset) {
        std::array<Pose2, 2> moved = poses;
        Pose2& pose = moved.at(static_cast<std::size_t>(column / 3));
        (column % 3 == 0 ? pose.x : column % 3 == 1 ? pose.y : pose.theta) += offset;
        return edge_error(edge, moved[0], moved[1]);
      };
      const Eigen::Vector3d numeric = (error_at(step) - error_at(-step)) / (2 * step);
      const Eigen::Vector3d analytic = (column < 3 ? linear.by_a : linear.by_b).col(column % 3);
      EXPECT_LT((numeric - analytic).norm(), 1e-6) << "column " << column;
    }
  }
}

TEST(Chi2, WeighsErrorsByTheirInformation) {
  PoseGraph graph{.map_from_node = {{0, 0, 0}, {1.1, 0.2, 0}}};
  graph.edges.push_back({.a = 0, .b = 1, .a_from_b = {1, 0, 0}});
  graph.edges.back().information = Eigen::Vector3d(100, 25, 1).asDiagonal();
  EXPECT_NEAR(chi2(graph), 100 * 0.01 + 25 * 0.04, 1e-12);
}

TEST(Adjoint, MovesASmallErrorFromTheEndToTheStartOfAPose) {
  const Pose2 a_from_b{2, -1, 0.7};
  const Pose2 error{1e-6, -2e-6, 3e-6};
  const Pose2 in_a = a_from_b * error * inverse(a_from_b);
  const Eigen::Vector3d moved = adjoint(a_from_b) * Eigen::Vector3d(error.x, error.y, error.theta);
  EXPECT_NEAR(in_a.x, moved.x(), 1e-10);
  EXPECT_NEAR(in_a.y, moved.y(), 1e-10);
  EXPECT_NEAR(in_a.theta, moved.z(), 1e-10);
}

}  // namespace
}  // namespace flirt
