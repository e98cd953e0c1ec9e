#include "flirt/registration/map_fields.hpp"

#include "rooms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

namespace flirt {
namespace {

using rooms::asymmetric_room;
using rooms::evidence_of;
using rooms::moved;
using rooms::scan_of;
using rooms::walk;

void expect_equal(const CoarseField& a, const CoarseField& b) {
  EXPECT_EQ(a.block, b.block);
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.quads.cells, b.quads.cells);
  EXPECT_EQ(a.standable.cells, b.standable.cells);
  EXPECT_EQ(a.peaks, b.peaks);
  ASSERT_EQ(a.panels.size(), b.panels.size());
  for (std::size_t i = 0; i < a.panels.size(); ++i) {
    EXPECT_EQ(a.panels[i].corner, b.panels[i].corner);
    EXPECT_EQ(a.panels[i].pairs, b.panels[i].pairs);
    EXPECT_EQ(a.panels[i].standable, b.panels[i].standable);
  }
}

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
  ASSERT_EQ(a.coarse.size(), b.coarse.size());
  for (std::size_t i = 0; i < a.coarse.size(); ++i) { expect_equal(*a.coarse[i], *b.coarse[i]); }
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

/// The room, and another at a given place.
EvidenceGrid room_and_room_at(const Pose2& place) {
  EvidenceGrid grid = evidence_of(asymmetric_room(), walk({}));
  const auto walls = moved(asymmetric_room(), place);
  for (const Pose2& pose : walk(place)) { grid.add(scan_of(walls, pose, 6), pose); }
  return grid;
}

TEST(MapFields, TilesFarFromAllWouldBeBlank) {
  const EvidenceGrid grid = two_rooms();
  const MapFieldParams params;
  std::map<std::pair<std::int32_t, std::int32_t>, TileMarks> seen;
  grid.for_each_tile([&](CellIndex tile, std::span<const EvidenceCell> cells) {
    seen.emplace(std::pair{tile.x, tile.y}, TileMarks(cells));
  });
  int far = 0;
  int made = 0;
  for (std::int32_t y = -6; y < 16; ++y) {
    for (std::int32_t x = -6; x < 22; ++x) {
      TileSurroundings around{.reach = tile_reach(params, 0.05), .marks = {}};
      for (std::int32_t dy = -around.reach; dy <= around.reach; ++dy) {
        for (std::int32_t dx = -around.reach; dx <= around.reach; ++dx) {
          const auto found = seen.find({x + dx, y + dy});
          around.marks.push_back(found == seen.end() ? nullptr : &found->second);
        }
      }
      const bool blank = is_blank(map_tile(around, params, 0.05));
      if (is_far_from_all(around, params, 0.05)) {
        ++far;
        EXPECT_TRUE(blank) << x << ' ' << y;
      } else {
        made += blank ? 0 : 1;
      }
    }
  }
  EXPECT_GT(far, 100);
  EXPECT_GT(made, 20);
}

TEST(MapFields, EveryReachThatIsAllowedCounts) {
  const EvidenceGrid grid = evidence_of(asymmetric_room(), walk({}));
  const auto cells_with_line = [&](double reach) {
    std::size_t cells = 0;
    for (const auto& tile : map_fields(grid, {.reach = reach}).tiles) {
      cells += tile ? tile->line.size() - static_cast<std::size_t>(std::ranges::count(tile->line, 0)) : 0;
    }
    return cells;
  };
  EXPECT_LT(cells_with_line(0.1), cells_with_line(0.4));
  EXPECT_LT(cells_with_line(0.4), cells_with_line(0.7));
  EXPECT_LT(cells_with_line(0.7), cells_with_line(0.75));
  EXPECT_EQ(out_of_range(MapFieldParams{.reach = 0.75}), "");
  EXPECT_NE(out_of_range(MapFieldParams{.reach = 0.8}), "");
}

TEST(MapFields, HoldNoTilesWhereNothingWasSeen) {
  const MapFields far = map_fields(room_and_room_at({230, 100, 0.3}));
  std::size_t held = 0;
  for (const auto& tile : far.tiles) { held += tile ? 1 : 0; }
  EXPECT_LT(held, far.tiles.size() / 20);
}

TEST(MapFields, GrowWithWhatWasSeenAndNotWithTheBoxAroundIt) {
  const std::size_t near = map_fields(two_rooms()).bytes();
  const MapFields far = map_fields(room_and_room_at({3000, 4000, 0.3}));
  EXPECT_EQ(far.coarse.size(), 2U);
  EXPECT_LT(far.bytes() - far.tiles.size() * sizeof(far.tiles[0]), 2 * near);
}

TEST(MapFields, UpdatedEqualMadeAnewInAMapOfSeveralBlocks) {
  // The second room lies on both sides of the border between two blocks, at 409.6 m from the map's corner.
  EvidenceGrid grid = room_and_room_at({405, 20, 0});
  const MapFields before = map_fields(grid);
  ASSERT_EQ(before.coarse.size(), 2U);
  const auto walls = moved(asymmetric_room(), {405, 20, 0});
  const Pose2 pose{407, 23, 0.4};
  grid.add(scan_of(walls, pose, 3), pose);
  expect_equal(updated_fields(before, grid), map_fields(grid));
  grid.remove(scan_of(walls, pose, 3), pose);
  const Pose2 home{2, 3, 0.1};
  grid.add(scan_of(asymmetric_room(), home, 3), home);
  const MapFields after = updated_fields(before, grid);
  EXPECT_NE(after.coarse[0], before.coarse[0]);
  EXPECT_EQ(after.coarse[1], before.coarse[1]);
  expect_equal(after, map_fields(grid));
}

TEST(MapFields, AreNotMadeOfMapsTooWideForATableOfTiles) {
  EXPECT_FALSE(map_fields(room_and_room_at({9000, 9000, 0})).empty());
  EXPECT_TRUE(map_fields(room_and_room_at({20000, 20000, 0})).empty());
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
