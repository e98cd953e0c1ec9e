#include "flirt/registration/window_search.hpp"

#include "flirt/registration/window_bounds.hpp"

#include "tests/registration/rooms.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

namespace flirt {
namespace {

struct Room {
  LocalMap map{};
  SurfacePoints query{};
  Pose2 map_from_query{};
};

Room room_at(const Pose2& map_from_room) {
  const auto walls = rooms::moved(rooms::asymmetric_room(), map_from_room);
  Rng rng(3);
  Room room;
  for (const Pose2& pose : rooms::walk(map_from_room)) {
    room.map.add(surface_points(rooms::scan_of(walls, pose, 2 * std::numbers::pi, &rng, 0.01)), pose);
    room.map_from_query = pose * Pose2{0.13, -0.08, 0.2};
  }
  room.query = surface_points(rooms::scan_of(walls, room.map_from_query, 2 * std::numbers::pi, &rng, 0.01));
  return room;
}

TEST(WindowSearch, LeavesOutNothingWorthKeeping) {
  for (const Pose2& map_from_room : {Pose2{0, 0, 0}, Pose2{-731.3, 50.9, 2.1}, Pose2{102.4, -0.05, 0.4}}) {
    const Room room = room_at(map_from_room);
    for (const double extent : {1.0, 1.3, 3.4}) {
      for (const double turn : {0.4, 4.0}) {
        SearchWindow window{.map_from_robot = room.map_from_query * Pose2{0.6, -0.5, 0.3},
                            .half_extent = extent,
                            .half_turn = turn,
                            .candidates = 6};
        const auto all = search_window(room.map, std::span(&room.query, 1), window);
        window.keep = 0.7;
        const auto kept = search_window(room.map, std::span(&room.query, 1), window);
        ASSERT_FALSE(all.empty());
        ASSERT_FALSE(kept.empty());
        for (std::size_t i = 0; i < all.size() && all[i].value >= window.keep * all.front().value; ++i) {
          ASSERT_LT(i, kept.size());
          EXPECT_EQ(kept[i].map_from_robot, all[i].map_from_robot);
          EXPECT_EQ(kept[i].value, all[i].value);
        }
      }
    }
  }
}

TEST(WindowSearch, FindsAScanFarFromTheMiddle) {
  const Room room = room_at({30, -7, 1});
  const SearchWindow window{
      .map_from_robot = room.map_from_query * Pose2{2.1, 1.7, 2.5}, .half_extent = 3, .half_turn = 4, .keep = 0.85};
  const auto found = search_window(room.map, std::span(&room.query, 1), window);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(distance(found.front().map_from_robot, room.map_from_query), 0.1);
  EXPECT_LT(heading_difference(found.front().map_from_robot, room.map_from_query), radians_from_degrees(2));
}

TEST(WindowBounds, AreNeverLessThanWhatTheyBound) {
  const Room room = room_at({-12.34, 5.6, 0.3});
  constexpr std::int32_t reach = 13;
  const CellIndex middle{static_cast<std::int32_t>(room.map_from_query.x / LocalMap::cell_size),
                         static_cast<std::int32_t>(room.map_from_query.y / LocalMap::cell_size)};
  std::vector<CellIndex> cells;
  for (std::size_t i = 0; i < room.query.size(); i += 3) {
    const Point2 at = room.map_from_query * Point2{room.query.x[i], room.query.y[i]};
    cells.push_back({static_cast<std::int32_t>(std::floor(at.x / LocalMap::cell_size)),
                     static_cast<std::int32_t>(std::floor(at.y / LocalMap::cell_size))});
  }
  const WindowBounds bounds(room.map, middle, 120, reach);
  const std::vector<std::uint16_t> of_strip = bounds.of(cells);
  ASSERT_EQ(of_strip.size(), static_cast<std::size_t>(bounds.tile_rows() * bounds.strips()));
  int largest = 0;
  for (std::int32_t y = -reach; y <= reach; ++y) {
    for (std::int32_t x = -reach; x <= reach; ++x) {
      int sum = 0;
      for (const CellIndex& cell : cells) { sum += *room.map.row({cell.x + x, cell.y + y}); }
      const std::int32_t strip =
          (y + reach) / WindowBounds::tile_side * bounds.strips() + (x + reach) / LocalMap::row_length;
      EXPECT_LE(sum, of_strip[static_cast<std::size_t>(strip)]);
      largest = std::max(largest, sum);
    }
  }
  // And near enough to be of use.
  EXPECT_LT(*std::ranges::max_element(of_strip), 1.5 * largest);
}

}  // namespace
}  // namespace flirt
