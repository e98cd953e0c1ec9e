#include "flirt/features/geodesic.hpp"

#include "flirt/core/pose2.hpp"
#include "flirt/core/rng.hpp"

#include "tests/support/numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

namespace flirt {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct Points {
  std::vector<double> x;
  std::vector<double> y;
};

Points random_points(std::size_t count, std::uint64_t seed) {
  Rng rng(seed);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    points.x.push_back(rng.uniform(-5.0, 5.0));
    points.y.push_back(rng.uniform(-5.0, 5.0));
  }
  return points;
}

using Ends = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Ends ends_of(const std::vector<CurveEdge>& edges) {
  Ends ends;
  for (const CurveEdge& edge : edges) { ends.emplace(edge.low, edge.high); }
  return ends;
}

/// Kruskal's algorithm, tree after tree.
Ends kruskal(const Points& points, int trees) {
  std::vector<CurveEdge> candidates;
  const auto n = static_cast<std::uint32_t>(points.x.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = i + 1; j < n; ++j) {
      candidates.push_back({i, j, std::hypot(points.x[i] - points.x[j], points.y[i] - points.y[j])});
    }
  }
  std::ranges::sort(candidates, {}, &CurveEdge::length);
  Ends chosen;
  for (int tree = 0; tree < trees; ++tree) {
    std::vector<std::uint32_t> group(n);
    std::iota(group.begin(), group.end(), 0U);
    for (const CurveEdge& edge : candidates) {
      if (group[edge.low] == group[edge.high] || chosen.contains({edge.low, edge.high})) { continue; }
      const std::uint32_t low = group[edge.low];
      std::ranges::replace(group, low, std::uint32_t{group[edge.high]});
      chosen.emplace(edge.low, edge.high);
    }
  }
  return chosen;
}

TEST(ArcLengths, AddUpTheSegments) {
  AlignedVector<double> arc;
  const std::vector<double> x{0, 3, 3, 0};
  const std::vector<double> y{0, 0, 4, 0};
  EXPECT_EQ(arc_lengths(x, y, false, arc), 12.0);
  EXPECT_THAT(arc, ElementsAre(0, 3, 7, 12));
  EXPECT_EQ(arc_lengths(std::vector<double>{0, 3, 3}, std::vector<double>{0, 0, 4}, true, arc), 12.0);
  EXPECT_EQ(arc_lengths({}, {}, true, arc), 0.0);
}

TEST(SpanningTrees, AreThoseOfKruskalsAlgorithm) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const Points points = random_points(40, seed);
    const std::vector<CurveEdge> edges = spanning_tree_edges(points.x, points.y, 3);
    EXPECT_EQ(edges.size(), 3U * 39U);
    EXPECT_EQ(ends_of(edges), kruskal(points, 3));
    for (const CurveEdge& edge : edges) {
      EXPECT_NEAR(edge.length,
                  std::hypot(points.x[edge.low] - points.x[edge.high], points.y[edge.low] - points.y[edge.high]),
                  1e-12);
    }
  }
}

TEST(SpanningTrees, DoNotChangeWhenAScanFullOfTiesIsRotated) {
  Points points;
  for (int i = 0; i < 60; ++i) {  // equal ranges: all neighbours equally far
    points.x.push_back(2.0 * std::cos(0.1 * i));
    points.y.push_back(2.0 * std::sin(0.1 * i));
  }
  const Ends expected = ends_of(spanning_tree_edges(points.x, points.y, 3));
  for (double angle = 0.1; angle < 6.0; angle += 0.37) {
    Points rotated;
    for (std::size_t i = 0; i < points.x.size(); ++i) {
      const Point2 point = Pose2{0, 0, angle} * Point2{points.x[i], points.y[i]};
      rotated.x.push_back(point.x);
      rotated.y.push_back(point.y);
    }
    EXPECT_EQ(ends_of(spanning_tree_edges(rotated.x, rotated.y, 3)), expected);
  }
}

TEST(SpanningTrees, StopWhenNoEdgesAreLeft) {
  const Points points = random_points(3, 1);
  EXPECT_EQ(spanning_tree_edges(points.x, points.y, 5).size(), 3U);
  EXPECT_THAT(spanning_tree_edges({}, {}, 3), IsEmpty());
  EXPECT_THAT(spanning_tree_edges(std::vector<double>{1.0}, std::vector<double>{1.0}, 3), IsEmpty());
}

TEST(ShortestPaths, EqualFloydAndWarshallsWithinReach) {
  const Points points = random_points(30, 7);
  const std::vector<CurveEdge> edges = spanning_tree_edges(points.x, points.y, 2);
  std::vector<std::vector<double>> distance(30, std::vector<double>(30, infinity));
  for (std::size_t i = 0; i < 30; ++i) { distance[i][i] = 0.0; }
  for (const CurveEdge& edge : edges) { distance[edge.low][edge.high] = distance[edge.high][edge.low] = edge.length; }
  for (std::size_t k = 0; k < 30; ++k) {
    for (std::size_t i = 0; i < 30; ++i) {
      for (std::size_t j = 0; j < 30; ++j) {
        distance[i][j] = std::min(distance[i][j], distance[i][k] + distance[k][j]);
      }
    }
  }
  for (const double reach : {infinity, 4.0, 0.0}) {
    const GeodesicNeighbours neighbours = shortest_paths(edges, 30, reach);
    ASSERT_EQ(neighbours.first.size(), 31U);
    for (std::size_t i = 0; i < 30; ++i) {
      std::size_t k = neighbours.first[i];
      for (std::uint32_t j = 0; j < 30; ++j) {
        if (distance[i][j] > reach) { continue; }
        ASSERT_LT(k, neighbours.first[i + 1]);
        EXPECT_EQ(neighbours.point[k], j);
        EXPECT_NEAR(neighbours.distance[k], distance[i][j], 1e-12);
        ++k;
      }
      EXPECT_EQ(k, neighbours.first[i + 1]);
    }
  }
}

}  // namespace
}  // namespace flirt
