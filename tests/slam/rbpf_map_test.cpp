#include "flirt/slam/rbpf_map.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace flirt {
namespace {

std::vector<Point2> random_ends(Rng& rng, std::size_t count) {
  std::vector<Point2> ends;
  for (std::size_t i = 0; i < count; ++i) { ends.push_back({rng.uniform(-6, 6), rng.uniform(-6, 6)}); }
  return ends;
}

Pose2 random_pose(Rng& rng) {
  return {rng.uniform(-8, 8), rng.uniform(-8, 8), rng.uniform(-3, 3)};
}

TEST(RbpfMap, CountsBeamsAsTheEvidenceGridDoes) {
  Rng rng(3);
  RbpfMap map(0.05);
  EvidenceGrid grid({.cell_size = 0.05});
  for (int k = 0; k < 5; ++k) {
    Scan scan{.beams = {.angle_min = -1.5, .angle_step = 0.1, .range_min = 0, .range_max = 20}};
    for (int i = 0; i < 31; ++i) { scan.ranges.push_back(rng.uniform(0.5, 9)); }
    const Pose2 pose = random_pose(rng);
    std::vector<Point2> ends;
    for (const BeamPoint& hit : hit_points(scan)) { ends.push_back(hit.point); }
    map.add({}, ends, pose);
    grid.add(scan, pose);
  }
  std::size_t seen = 0;
  grid.for_each_row([&](CellIndex first, std::span<const EvidenceCell> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      EXPECT_EQ(map.cell({first.x + static_cast<std::int32_t>(i), first.y}).evidence, row[i]);
      seen += row[i].seen() ? 1 : 0;
    }
  });
  EXPECT_GT(seen, 5000U);
}

TEST(RbpfMap, FindsTheNearestMeanEndPointInTheCellsAround) {
  Rng rng(1);
  RbpfMap map(0.05);
  for (int k = 0; k < 3; ++k) { map.add({0, 0}, random_ends(rng, 300), random_pose(rng)); }
  int near = 0;
  for (int k = 0; k < 5000; ++k) {
    const Point2 at{rng.uniform(-9, 9), rng.uniform(-9, 9)};
    const auto x = static_cast<std::int32_t>(std::floor(at.x / 0.05));
    const auto y = static_cast<std::int32_t>(std::floor(at.y / 0.05));
    double least = std::numeric_limits<double>::infinity();
    for (std::int32_t i = x - 1; i <= x + 1; ++i) {
      for (std::int32_t j = y - 1; j <= y + 1; ++j) {
        const RbpfCell cell = map.cell({i, j});
        if (!cell.evidence.occupied()) { continue; }
        least = std::min(least, squared_norm(Point2{0.05 * (i + double{cell.x}), 0.05 * (j + double{cell.y})} - at));
      }
    }
    const double found = map.squared_distance(at);
    if (least == std::numeric_limits<double>::infinity()) {
      EXPECT_LT(found, 0);
    } else {
      ++near;
      EXPECT_NEAR(found, least, 1e-7);
    }
  }
  EXPECT_GT(near, 100);
}

TEST(RbpfMap, TellsSeenSpaceFromUnseen) {
  RbpfMap map(0.05);
  map.add({0, 0}, std::vector<Point2>{{3, 0.01}}, {});
  EXPECT_EQ(map.squared_distance({1.5, 0.01}), RbpfMap::nothing_near);
  EXPECT_EQ(map.squared_distance({1.5, 0.5}), RbpfMap::unseen);
  EXPECT_EQ(map.squared_distance({-40, 70}), RbpfMap::unseen);
  EXPECT_LT(map.squared_distance({3, 0.01}), 1e-6);
}

TEST(RbpfMap, CopiesShareTilesUntilOneChangesAndThenKeepTheirOwn) {
  RbpfMap first(0.05);
  Rng rng(7);
  first.add({0, 0}, random_ends(rng, 200), {});
  const RbpfMap second = first;
  EXPECT_EQ(first.tiles(), second.tiles());
  const RbpfCell before = second.cell({20, 0});
  first.add({0, 0}, std::vector<Point2>{{1.01, 0.01}}, {});
  EXPECT_EQ(second.cell({20, 0}).evidence, before.evidence);
  EXPECT_EQ(first.cell({20, 0}).evidence.hits, before.evidence.hits + 1);
  std::size_t shared = 0;
  for (std::size_t i = 0; i < first.tiles().size(); ++i) { shared += first.tiles()[i] == second.tiles()[i] ? 1 : 0; }
  EXPECT_EQ(shared, first.tiles().size() - 1);  // the beam stays in one tile
}

TEST(RbpfMap, WhatLiesBetweenFarPlacesCostsNothing) {
  RbpfMap map(0.05);
  const std::vector<Point2> ends{{1.01, 0.01}};
  map.add({0, 0}, ends, {});
  const RbpfMap near = map;
  map.add({0, 0}, ends, {100000, -100000, 0});  // a table of all tiles between would take 60 GB
  EXPECT_EQ(map.tiles().size(), near.tiles().size() + 1);
  EXPECT_EQ(map.cell({20, 0}).evidence, near.cell({20, 0}).evidence);
  EXPECT_EQ(map.cell({2000020, -2000000}).evidence.hits, 1);
}

}  // namespace
}  // namespace flirt
