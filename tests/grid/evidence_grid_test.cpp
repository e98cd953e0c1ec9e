#include "flirt/grid/evidence_grid.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace flirt {
namespace {

Scan random_scan(Rng& rng, std::size_t beams) {
  Scan scan{.beams = {-std::numbers::pi, 2 * std::numbers::pi / static_cast<double>(beams), 0, 50}};
  for (std::size_t i = 0; i < beams; ++i) { scan.ranges.push_back(rng.uniform(0.2, 12)); }
  return scan;
}

Pose2 random_pose(Rng& rng) {
  return {rng.uniform(570, 580), rng.uniform(-20, 5), rng.uniform(-3, 3)};
}

Scan one_beam(double range) {
  return {.beams = {0, 0.1, 0, 50}, .ranges = {range}};
}

TEST(EvidenceGrid, CountsPassesBeforeTheEndAndAHitThere) {
  EvidenceGrid grid;
  grid.add(one_beam(0.26), {0.02, 0.02, 0});
  for (int x = 0; x < 5; ++x) { EXPECT_EQ(grid.cell({x, 0}), (EvidenceCell{0, 1})) << x; }
  EXPECT_EQ(grid.cell({5, 0}), (EvidenceCell{1, 0}));
  EXPECT_EQ(grid.cell({6, 0}), EvidenceCell{});
  EXPECT_EQ(grid.cell({0, 1}), EvidenceCell{});
  EXPECT_EQ(grid.cell({-1, 0}), EvidenceCell{});
}

TEST(EvidenceGrid, IgnoresBeamsWithoutAUsableReturn) {
  EvidenceGrid grid;
  for (const double range : {0.0, 0.04, 50.0, 81.83, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN(), -1.0}) {
    grid.add(one_beam(range), {});
  }
  EXPECT_EQ(grid, EvidenceGrid{});
  EXPECT_FALSE(grid.bounds().has_value());
}

TEST(EvidenceGrid, RemovingRestoresItBitForBit) {
  Rng rng(7);
  EvidenceGrid grid;
  std::vector<Scan> scans;
  std::vector<Pose2> poses;
  for (int i = 0; i < 20; ++i) {
    scans.push_back(random_scan(rng, 181));
    poses.push_back(random_pose(rng));
  }
  for (std::size_t i = 0; i < 10; ++i) { grid.add(scans[i], poses[i]); }
  const EvidenceGrid before = grid;
  for (std::size_t i = 10; i < 20; ++i) { grid.add(scans[i], poses[i]); }
  EXPECT_NE(grid, before);
  for (std::size_t i = 10; i < 20; ++i) { grid.remove(scans[i], poses[i]); }
  EXPECT_EQ(grid, before);
  EXPECT_EQ(grid.bytes(), before.bytes());
  for (std::size_t i = 0; i < 10; ++i) { grid.remove(scans[i], poses[i]); }
  EXPECT_EQ(grid, EvidenceGrid{});
  EXPECT_EQ(grid.bytes(), 0U);
}

TEST(EvidenceGrid, TakesNothingBackFromACellThatIsFull) {
  Rng rng(9);
  const Scan scan = random_scan(rng, 181);
  const CellIndex own{0, 0};  // that of the sensor, which every beam passes
  EvidenceGrid grid;
  std::size_t added = 0;
  for (; grid.lost_counts() == 0; ++added) { grid.add(scan, {0.02, 0.02, 0}); }
  for (std::size_t i = 0; i < added; ++i) { grid.remove(scan, {0.02, 0.02, 0}); }
  EvidenceGrid expected;
  expected.count(own, {0, 65535});
  EXPECT_EQ(grid.cell(own).passes, 65535);
  EXPECT_EQ(grid.save_tiles().cells, expected.save_tiles().cells);
}

TEST(EvidenceGrid, DoesNotDependOnTheOrderOfScans) {
  Rng rng(8);
  EvidenceGrid forward;
  EvidenceGrid backward;
  std::vector<Scan> scans;
  std::vector<Pose2> poses;
  for (int i = 0; i < 8; ++i) {
    scans.push_back(random_scan(rng, 90));
    poses.push_back(random_pose(rng));
  }
  for (std::size_t i = 0; i < 8; ++i) { forward.add(scans[i], poses[i]); }
  for (std::size_t i = 8; i-- > 0;) { backward.add(scans[i], poses[i]); }
  EXPECT_EQ(forward, backward);
}

TEST(EvidenceGrid, CountsAsTheCellsOfTheBeamsSay) {
  Rng rng(9);
  const Scan scan = random_scan(rng, 60);
  const Pose2 map_from_sensor{-3.3, 2.2, 0.7};
  EvidenceGrid grid;
  grid.add(scan, map_from_sensor);
  std::uint64_t hits = 0;
  std::uint64_t passes = 0;
  grid.for_each_row([&](CellIndex, std::span<const EvidenceCell> row) {
    for (const EvidenceCell& cell : row) {
      hits += cell.hits;
      passes += cell.passes;
    }
  });
  std::uint64_t expected_passes = 0;
  for (const BeamPoint& hit : hit_points(scan)) {
    const CellIndex end = grid.index(map_from_sensor * hit.point);
    const CellIndex begin = grid.index(map_from_sensor.translation());
    expected_passes += static_cast<std::uint64_t>(std::abs(end.x - begin.x) + std::abs(end.y - begin.y));
    EXPECT_GE(grid.cell(end).hits, 1);
  }
  EXPECT_EQ(hits, 60U);
  EXPECT_EQ(passes, expected_passes);
}

TEST(EvidenceGrid, SaysWhenACountIsFull) {
  EvidenceGrid grid;
  for (int i = 0; i < 65535; ++i) { grid.add(one_beam(0.06), {0.02, 0.02, 0}); }
  EXPECT_EQ(grid.lost_counts(), 0U);
  EXPECT_EQ(grid.cell({1, 0}).hits, 65535);
  grid.add(one_beam(0.06), {0.02, 0.02, 0});
  EXPECT_EQ(grid.lost_counts(), 2U);
  EXPECT_EQ(grid.cell({1, 0}).hits, 65535);
}

TEST(EvidenceCell, StatesFollowTheRatio) {
  EXPECT_FALSE(EvidenceCell{}.seen());
  EXPECT_FALSE(EvidenceCell{}.free());
  EXPECT_TRUE((EvidenceCell{0, 1}).free());
  EXPECT_TRUE((EvidenceCell{3, 17}).occupied());
  EXPECT_FALSE((EvidenceCell{3, 18}).occupied());
  EXPECT_TRUE((EvidenceCell{3, 18}).free());
  EXPECT_TRUE((EvidenceCell{2, 2}).strong());
  EXPECT_FALSE((EvidenceCell{1, 0}).strong());
  EXPECT_FALSE((EvidenceCell{2, 3}).strong());
}

TEST(EvidenceGrid, IsTheSameAfterSavingItsTiles) {
  const EvidenceGridParams params{.cell_size = 0.1};
  EvidenceGrid grid(params);
  grid.count({-70, 3}, {.hits = 4, .passes = 1});
  grid.count({200, -1}, {.hits = 0, .passes = 9});
  grid.count({5, 300}, {.hits = 2, .passes = 2});
  const EvidenceGrid::SavedTiles saved = grid.save_tiles();
  ASSERT_EQ(saved.tiles.size(), 3U);
  EXPECT_EQ(EvidenceGrid(params, saved.tiles, saved.cells), grid);
}

TEST(EvidenceGrid, CountsAddUpAndStopAtTheirLargest) {
  EvidenceGrid grid;
  grid.count({1, 1}, {.hits = 3, .passes = 2});
  grid.count({1, 1}, {.hits = 1, .passes = 65530});
  EXPECT_EQ(grid.cell({1, 1}), (EvidenceCell{.hits = 4, .passes = 65532}));
  EXPECT_EQ(grid.lost_counts(), 0U);
  grid.count({1, 1}, {.hits = 0, .passes = 10});
  EXPECT_EQ(grid.cell({1, 1}), (EvidenceCell{.hits = 4, .passes = 65535}));
  EXPECT_EQ(grid.lost_counts(), 7U);
}

}  // namespace
}  // namespace flirt
