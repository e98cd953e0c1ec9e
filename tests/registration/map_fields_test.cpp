#include "flirt/registration/map_fields.hpp"

#include "rooms.hpp"

#include <gtest/gtest.h>

namespace flirt {
namespace {

using rooms::asymmetric_room;
using rooms::evidence_of;
using rooms::moved;
using rooms::scan_of;
using rooms::walk;

void expect_equal(const MapFields& a, const MapFields& b) {
  EXPECT_EQ(a.origin.x, b.origin.x);
  EXPECT_EQ(a.origin.y, b.origin.y);
  ASSERT_EQ(a.columns, b.columns);
  ASSERT_EQ(a.rows, b.rows);
  for (std::size_t i = 0; i < a.tiles.size(); ++i) {
    ASSERT_EQ(a.tiles[i] == nullptr, b.tiles[i] == nullptr) << i;
    if (!a.tiles[i]) { continue; }
    EXPECT_EQ(a.tiles[i]->agreement, b.tiles[i]->agreement) << i;
    EXPECT_EQ(a.tiles[i]->clearance, b.tiles[i]->clearance) << i;
    EXPECT_EQ(a.tiles[i]->line, b.tiles[i]->line) << i;
    EXPECT_EQ(a.tiles[i]->lines, b.tiles[i]->lines) << i;
  }
  EXPECT_EQ(a.coarse.quads.cells, b.coarse.quads.cells);
  EXPECT_EQ(a.coarse.standable.cells, b.coarse.standable.cells);
  EXPECT_EQ(a.coarse.peaks, b.coarse.peaks);
  ASSERT_EQ(a.coarse.panels.size(), b.coarse.panels.size());
  for (std::size_t i = 0; i < a.coarse.panels.size(); ++i) {
    EXPECT_EQ(a.coarse.panels[i].corner, b.coarse.panels[i].corner);
    EXPECT_EQ(a.coarse.panels[i].pairs, b.coarse.panels[i].pairs);
    EXPECT_EQ(a.coarse.panels[i].standable, b.coarse.panels[i].standable);
  }
}

/// Two rooms 30 m apart, so that most tiles of the one know nothing of the other.
EvidenceGrid two_rooms() {
  EvidenceGrid grid = evidence_of(asymmetric_room(), walk({}));
  const Pose2 far{30, 4, 0.3};
  const auto walls = moved(asymmetric_room(), far);
  for (const Pose2& pose : walk(far)) { grid.add(scan_of(walls, pose, 6), pose); }
  return grid;
}

TEST(MapFields, UpdatedEqualMadeAnewCellForCell) {
  const auto walls = asymmetric_room();
  EvidenceGrid grid = two_rooms();
  MapFields fields = map_fields(grid);
  std::vector<std::pair<Scan, Pose2>> added;
  for (const Pose2& pose : {Pose2{2, 3, 0.1}, Pose2{6.5, 2, 2.5}, Pose2{4.7, 5.5, -2}}) {
    // A wall that was not there before: evidence changes all around it.
    auto more = walls;
    more.push_back({{1 + 0.3 * pose.x, 3.9}, {3, 4.2 - 0.1 * pose.y}});
    added.emplace_back(scan_of(more, pose, 3), pose);
    grid.add(added.back().first, added.back().second);
    fields = updated_fields(fields, grid);
    expect_equal(fields, map_fields(grid));
  }
  for (const auto& [scan, pose] : added) { grid.remove(scan, pose); }
  expect_equal(updated_fields(fields, grid), map_fields(two_rooms()));
}

TEST(MapFields, UpdatedEqualMadeAnewWhenTheBoxGrowsAndShrinks) {
  EvidenceGrid grid = evidence_of(asymmetric_room(), walk({}));
  const MapFields small = map_fields(grid);
  const auto far = moved(asymmetric_room(), {-17, -9, 1});
  const Pose2 pose = Pose2{-17, -9, 1} * Pose2{4, 3, 0};
  grid.add(scan_of(far, pose, 6), pose);
  const MapFields large = updated_fields(small, grid);
  expect_equal(large, map_fields(grid));
  grid.remove(scan_of(far, pose, 6), pose);
  expect_equal(updated_fields(large, grid), small);
}

TEST(MapFields, UpdatedShareTheTilesThatNothingChangedAround) {
  EvidenceGrid grid = two_rooms();
  const MapFields before = map_fields(grid);
  grid.add(scan_of(asymmetric_room(), {2, 3, 0.1}, 3), {2, 3, 0.1});
  const MapFields after = updated_fields(before, grid);
  ASSERT_EQ(before.tiles.size(), after.tiles.size());
  std::size_t shared = 0;
  for (std::size_t i = 0; i < after.tiles.size(); ++i) {
    shared += after.tiles[i] && after.tiles[i] == before.tiles[i] ? 1 : 0;
  }
  EXPECT_GE(shared, 9U);
}

TEST(MapFields, HoldNoTilesWhereNothingWasSeen) {
  const std::size_t near = map_fields(two_rooms()).bytes();
  EvidenceGrid grid = evidence_of(asymmetric_room(), walk({}));
  const auto walls = moved(asymmetric_room(), {230, 100, 0.3});
  for (const Pose2& pose : walk({230, 100, 0.3})) { grid.add(scan_of(walls, pose, 6), pose); }
  const MapFields far = map_fields(grid);
  std::size_t held = 0;
  for (const auto& tile : far.tiles) { held += tile ? 1 : 0; }
  EXPECT_LT(held, far.tiles.size() / 20);
  EXPECT_LT(far.bytes() - far.coarse.bytes(), 3 * near);
}

TEST(MapFields, TilesDoNotDependOnWhereTheMapLies) {
  const double tile = MapTile::side * 0.05;
  // No wall along the cells' borders, where the last bit of a coordinate decides between two cells.
  const Pose2 map_from_room{1.03, 1.52, 0.3};
  const auto walls = moved(asymmetric_room(), map_from_room);
  EvidenceGrid here;
  EvidenceGrid there;
  for (const Pose2& pose : walk(map_from_room)) {
    const Scan scan = scan_of(walls, pose, 6);
    here.add(scan, pose);
    there.add(scan, {pose.x - 5 * tile, pose.y + 7 * tile, pose.theta});
  }
  const MapFields a = map_fields(here);
  const MapFields b = map_fields(there);
  ASSERT_EQ(a.columns, b.columns);
  ASSERT_EQ(a.rows, b.rows);
  EXPECT_EQ(b.first_tile.x - a.first_tile.x, -5);
  EXPECT_EQ(b.first_tile.y - a.first_tile.y, 7);
  for (std::size_t i = 0; i < a.tiles.size(); ++i) {
    ASSERT_EQ(a.tiles[i] == nullptr, b.tiles[i] == nullptr) << i;
    if (!a.tiles[i]) { continue; }
    EXPECT_EQ(a.tiles[i]->agreement, b.tiles[i]->agreement) << i;
    EXPECT_EQ(a.tiles[i]->clearance, b.tiles[i]->clearance) << i;
    EXPECT_EQ(a.tiles[i]->lines, b.tiles[i]->lines) << i;
  }
}

}  // namespace
}  // namespace flirt
