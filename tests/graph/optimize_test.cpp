#include "flirt/graph/optimize.hpp"

#include "flirt/graph/edge_error.hpp"

#include "tests/graph/graphs.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace flirt {
namespace {

/// Plain Gauss–Newton with dense matrices and no damping: slow, and as simple as the equations.
void gauss_newton(PoseGraph& graph, int iterations) {
  const auto n = static_cast<Eigen::Index>(3 * graph.map_from_node.size());
  for (int k = 0; k < iterations; ++k) {
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
    for (const PoseEdge& edge : graph.edges) {
      const LinearizedEdge linear = linearize(edge, graph.map_from_node[edge.a], graph.map_from_node[edge.b]);
      Eigen::Matrix<double, 3, 6> jacobian;
      jacobian << linear.by_a, linear.by_b;
      const Eigen::Matrix<double, 6, 6> h = jacobian.transpose() * edge.information * jacobian;
      const Eigen::Matrix<double, 6, 1> g = jacobian.transpose() * edge.information * linear.error;
      const std::array<Eigen::Index, 2> at{static_cast<Eigen::Index>(3 * edge.a),
                                           static_cast<Eigen::Index>(3 * edge.b)};
      for (std::size_t i = 0; i < 2; ++i) {
        const auto row = static_cast<Eigen::Index>(3 * i);
        gradient.segment<3>(at.at(i)) += g.segment<3>(row);
        for (std::size_t j = 0; j < 2; ++j) {
          hessian.block<3, 3>(at.at(i), at.at(j)) += h.block<3, 3>(row, static_cast<Eigen::Index>(3 * j));
        }
      }
    }
    hessian.topLeftCorner<3, 3>() += 1e9 * Eigen::Matrix3d::Identity();  // holds the first node
    const Eigen::VectorXd step = hessian.ldlt().solve(-gradient);
    for (std::size_t i = 0; i < graph.map_from_node.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(3 * i);
      Pose2& pose = graph.map_from_node[i];
      pose = {pose.x + step(at), pose.y + step(at + 1), wrap_angle(pose.theta + step(at + 2))};
    }
  }
}

PoseGraph with_start(const KnownGraph& known, const std::vector<Pose2>& start) {
  PoseGraph graph = known.graph;
  graph.map_from_node = start;
  return graph;
}

TEST(Optimize, OneStepBendsALongChainToItsClosure) {
  // All poses have heading 0 and no edge measures a turn, so that the problem is nearly linear. The chain's weakest
  // mode is a millionth as stiff as an edge: a damped step would leave it.
  constexpr std::uint32_t length = 500;
  PoseGraph graph;
  const Eigen::Matrix3d stiff_heading = Eigen::Vector3d(1, 1, 1e6).asDiagonal();
  for (std::uint32_t i = 0; i <= length; ++i) { graph.map_from_node.push_back({0.1 * i, 0, 0}); }
  for (std::uint32_t i = 0; i < length; ++i) { graph.edges.push_back({i, i + 1, {0.1, 0, 0}, stiff_heading}); }
  graph.edges.push_back({0, length, {0.1 * length + 1, 0, 0}, stiff_heading});
  static_cast<void>(optimize(graph, {.iterations = 1, .trust_radius = undamped}));
  EXPECT_NEAR(graph.map_from_node[length].x, 0.1 * length + length / (length + 1.0), 1e-3);
}

TEST(Optimize, BothBackendsFindTheTruthOfAConsistentGraph) {
  const KnownGraph known = rounds(3, {}, 0);
  Rng rng(4);
  std::vector<Pose2> start = known.truth;
  for (std::size_t i = 1; i < start.size(); ++i) {
    start[i] = start[i] * Pose2{rng.normal(0, 0.3), rng.normal(0, 0.3), rng.normal(0, 0.1)};
  }
  for (const Backend backend : {Backend::ceres, Backend::toro}) {
    PoseGraph graph = with_start(known, start);
    const OptimizeSummary summary = optimize(graph, {.backend = backend, .iterations = 300});
    EXPECT_LT(worst_position(graph, known.truth), backend == Backend::ceres ? 1e-6 : 1e-3) << to_string(backend);
    EXPECT_LT(summary.final_chi2, 1e-4 * summary.initial_chi2) << to_string(backend);
    EXPECT_TRUE(summary.rejected.empty());
  }
}

TEST(Optimize, BackendsAgreeOnANoisyGraph) {
  const KnownGraph known = rounds(4, {0.02, 0.01}, 1);
  PoseGraph by_ceres = known.graph;
  PoseGraph by_toro = known.graph;
  const OptimizeSummary ceres = optimize(by_ceres);
  const OptimizeSummary toro = optimize(by_toro, {.backend = Backend::toro});
  EXPECT_TRUE(ceres.converged);
  EXPECT_LE(ceres.final_chi2, toro.final_chi2);
  EXPECT_LT(toro.final_chi2, 1.3 * ceres.final_chi2);
  EXPECT_LT(worst_position(by_toro, by_ceres.map_from_node), 0.2);
  EXPECT_LT(worst_position(by_ceres, known.truth), worst_position(known.graph, known.truth) / 4);
}

TEST(Optimize, AFewPassesOfToroCanBeTheLast) {
  // Two ways from the first pose to the third, 0.1 m apart.
  const PoseGraph triangle{.map_from_node = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},
                           .edges = {{.a = 0, .b = 1, .a_from_b = {1, 0, 0}},
                                     {.a = 1, .b = 2, .a_from_b = {1, 0, 0}},
                                     {.a = 0, .b = 2, .a_from_b = {2.1, 0, 0}, .kind = EdgeKind::loop}}};
  PoseGraph settled = triangle;
  EXPECT_TRUE(optimize(settled, {.backend = Backend::toro, .iterations = 9}).converged);
  PoseGraph begun = triangle;
  begun.map_from_node[2] = {5, 4, 1};
  EXPECT_FALSE(optimize(begun, {.backend = Backend::toro, .iterations = 1}).converged);
}

TEST(Optimize, CeresEndsWherePlainGaussNewtonDoes) {
  const KnownGraph known = rounds(2, {0.02, 0.01}, 2);
  PoseGraph sparse = known.graph;
  PoseGraph dense = known.graph;
  (void)optimize(sparse);
  gauss_newton(dense, 15);
  EXPECT_NEAR(chi2(sparse), chi2(dense), 1e-6 * chi2(dense));
  EXPECT_LT(worst_position(sparse, dense.map_from_node), 1e-4);
}

TEST(Optimize, ToroUnwindsACircleFromZeroHeadingsWhereGaussNewtonDoesNot) {
  const KnownGraph known = circle(100, 10);
  const std::vector<Pose2> start(known.truth.size());  // every node at the origin with heading 0
  PoseGraph by_newton = with_start(known, start);
  gauss_newton(by_newton, 100);
  EXPECT_GT(worst_position(by_newton, known.truth), 1.0);
  PoseGraph by_toro = with_start(known, start);
  (void)optimize(by_toro, {.backend = Backend::toro});
  EXPECT_LT(worst_position(by_toro, known.truth), 0.05);
}

TEST(Optimize, HoldsTheFixedNodeAndTheFirstNodesOfOtherParts) {
  PoseGraph graph{.map_from_node = {{0, 0, 0}, {5, 5, 1}, {9, 9, 2}, {7, 7, 3}}};
  graph.edges.push_back({.a = 0, .b = 1, .a_from_b = {1, 0, 0}});
  graph.edges.push_back({.a = 2, .b = 3, .a_from_b = {1, 0, 0}});
  for (const Backend backend : {Backend::ceres, Backend::toro}) {
    PoseGraph moved = graph;
    (void)optimize(moved, {.backend = backend, .fixed_node = 1});
    EXPECT_EQ(moved.map_from_node[1], graph.map_from_node[1]);
    EXPECT_EQ(moved.map_from_node[2], graph.map_from_node[2]);
    EXPECT_LT(chi2(moved), 1e-6) << to_string(backend);
  }
}

TEST(Optimize, DoesNotDependOnTheMapsHeading) {
  const KnownGraph known = rounds(2, {0.02, 0.01}, 3);
  const Pose2 other_from_map{30, -70, 2.0};
  for (const Backend backend : {Backend::ceres, Backend::toro}) {
    PoseGraph here = known.graph;
    PoseGraph there = known.graph;
    for (Pose2& pose : there.map_from_node) { pose = other_from_map * pose; }
    (void)optimize(here, {.backend = backend});
    (void)optimize(there, {.backend = backend});
    for (Pose2& pose : there.map_from_node) { pose = inverse(other_from_map) * pose; }
    EXPECT_LT(worst_position(here, there.map_from_node), 1e-5) << to_string(backend);
  }
}

TEST(Optimize, GivesTheSameBitsEveryTime) {
  const KnownGraph known = rounds(3, {0.02, 0.01}, 4);
  for (const Backend backend : {Backend::ceres, Backend::toro}) {
    PoseGraph first = known.graph;
    PoseGraph second = known.graph;
    (void)optimize(first, {.backend = backend});
    (void)optimize(second, {.backend = backend});
    EXPECT_EQ(first.map_from_node, second.map_from_node);
  }
}

TEST(Optimize, CopesWithDirectionsThatNothingMeasured) {
  PoseGraph graph{.map_from_node = {{0, 0, 0}, {1.5, 0.2, 0.1}}};
  graph.edges.push_back({.a = 0, .b = 1, .a_from_b = {1, 0, 0}});
  graph.edges.back().information = Eigen::Vector3d(0, 100, 100).asDiagonal();  // a bare corridor
  for (const Backend backend : {Backend::ceres, Backend::toro}) {
    PoseGraph moved = graph;
    (void)optimize(moved, {.backend = backend});
    EXPECT_NEAR(moved.map_from_node[1].x, 1.5, 0.03) << to_string(backend);
    EXPECT_NEAR(moved.map_from_node[1].y, 0.0, 1e-4) << to_string(backend);
  }
}

TEST(Optimize, HasNothingToDoForAnEmptyGraph) {
  PoseGraph graph;
  EXPECT_TRUE(optimize(graph).converged);
}

TEST(Optimize, FalseLoopsBendAMapThatIsNotDefended) {
  KnownGraph known = rounds(4, {0.02, 0.005}, 5);
  add_false_loops(known.graph, 20, 5);
  (void)optimize(known.graph);
  EXPECT_GT(worst_position(known.graph, known.truth), 2.0);
}

class OptimizeFalseLoops : public testing::TestWithParam<int> {};  // per cent of the right loops

TEST_P(OptimizeFalseLoops, GraduatedNonConvexityFindsAndDropsThem) {
  for (const Graduated graduated : {Graduated::geman_mcclure, Graduated::truncated}) {
    KnownGraph known = rounds(5, {0.02, 0.005}, 6);
    const std::size_t right_edges = known.graph.edges.size();
    const std::size_t right_loops = right_edges - (known.truth.size() - 1);
    const std::size_t wrong = right_loops * static_cast<std::size_t>(GetParam()) / 100;
    add_false_loops(known.graph, wrong, 6);
    const OptimizeSummary summary = optimize(known.graph, {.graduated = graduated});
    EXPECT_LT(worst_position(known.graph, known.truth), 0.3) << to_string(graduated);
    std::size_t rejected_right = 0;
    for (const std::uint32_t edge : summary.rejected) { rejected_right += edge < right_edges ? 1 : 0; }
    EXPECT_LE(rejected_right, right_loops / 20) << to_string(graduated);
    EXPECT_GE(summary.rejected.size() - rejected_right, wrong - wrong / 50) << to_string(graduated);
  }
}

INSTANTIATE_TEST_SUITE_P(PerCent, OptimizeFalseLoops, testing::Values(0, 10, 50, 100, 200));

TEST(Optimize, BoundedLossShieldsAgainstAFewFalseLoopsInBothBackends) {
  for (const Backend backend : {Backend::ceres, Backend::toro}) {
    KnownGraph known = rounds(4, {0.02, 0.005}, 7);
    const std::size_t right_edges = known.graph.edges.size();
    (void)optimize(known.graph);  // a good start: a bounded loss only sees what is near
    add_false_loops(known.graph, 10, 7);
    const OptimizeSummary summary = optimize(known.graph, {.backend = backend, .loss = RobustLoss::geman_mcclure});
    EXPECT_LT(worst_position(known.graph, known.truth), 0.3) << to_string(backend);
    for (std::uint32_t k = 0; k < 10; ++k) {
      EXPECT_TRUE(std::count(summary.rejected.begin(), summary.rejected.end(), right_edges + k)) << to_string(backend);
    }
  }
}

}  // namespace
}  // namespace flirt
