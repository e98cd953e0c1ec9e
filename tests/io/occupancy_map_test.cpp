#include "flirt/io/occupancy_map.hpp"

#include "flirt/io/png.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>

namespace flirt {
namespace {

/// The pixel of a cell that so many beams ended in and crossed.
std::uint8_t pixel_of(std::uint16_t hits, std::uint16_t passes) {
  EvidenceGrid grid;
  grid.count({3, -2}, {.hits = hits, .passes = passes});
  const GridMapImage map = occupancy_map(grid, "map.pgm").value();
  EXPECT_EQ(map.image.pixels.size(), 1U);
  return map.image.pixels.front();
}

CellState state_of(std::uint16_t hits, std::uint16_t passes) {
  return cell_state(pixel_of(hits, passes), GridMapMetadata{});
}

TEST(OccupancyMap, SaysToMapServersWhatStandsAndWhatIsFree) {
  EXPECT_EQ(state_of(8, 0), CellState::occupied);
  EXPECT_EQ(state_of(2, 11), CellState::occupied);
  EXPECT_EQ(state_of(2, 12), CellState::free);
  EXPECT_EQ(state_of(0, 1), CellState::free);
  EXPECT_EQ(state_of(1, 6), CellState::free);
  EXPECT_EQ(state_of(1, 5), CellState::unknown);
}

TEST(OccupancyMap, ShadesWhatBeamsPassDifferentlyFromWhatTheyDoNot) {
  EXPECT_EQ(pixel_of(2, 2), 0);
  EXPECT_EQ(pixel_of(2, 3), 60);
  EXPECT_EQ(pixel_of(1, 0), 115);
}

TEST(OccupancyMap, OfNothingIsOneUnknownPixel) {
  const GridMapImage map = occupancy_map(EvidenceGrid{}, "map.pgm").value();
  ASSERT_EQ(map.image.pixels.size(), 1U);
  EXPECT_EQ(cell_state(map.image.pixels.front(), map.metadata), CellState::unknown);
}

TEST(OccupancyMap, OfAWideMapHasLargerPixelsThatShowTheDarkestCell) {
  EvidenceGrid grid;
  grid.count({-7, -5}, {.hits = 0, .passes = 1});
  grid.count({-6, -4}, {.hits = 3, .passes = 0});
  grid.count({-5, -5}, {.hits = 0, .passes = 1});
  grid.count({40'000, 20'000}, {.hits = 0, .passes = 1});  // 8 · 10⁸ cells
  const GridMapImage map = occupancy_map(grid, "map.pgm").value();
  EXPECT_DOUBLE_EQ(map.metadata.resolution, 0.1);
  EXPECT_DOUBLE_EQ(map.metadata.origin.x, -0.35);
  EXPECT_DOUBLE_EQ(map.metadata.origin.y, -0.25);
  ASSERT_EQ(map.image.width, 20'004U);
  ASSERT_EQ(map.image.height, 10'003U);
  EXPECT_EQ(map.image.at(0, map.image.height - 1), 0);
  EXPECT_EQ(map.image.at(1, map.image.height - 1), 254);
  EXPECT_EQ(map.image.at(2, map.image.height - 1), 205);
  EXPECT_EQ(map.image.at(map.image.width - 1, 0), 254);
}

TEST(OccupancyMap, OfALongRowOfCellsHasNoMoreThanAMillionPixelsASide) {
  for (const bool upright : {false, true}) {
    EvidenceGrid grid;
    grid.count({0, 0}, {.hits = 0, .passes = 1});
    grid.count(upright ? CellIndex{0, 1'000'000} : CellIndex{1'000'000, 0}, {.hits = 3, .passes = 0});
    const GridMapImage map = occupancy_map(grid, "map.png").value();
    EXPECT_EQ(map.metadata.resolution, 2 * grid.params().cell_size);
    EXPECT_EQ(map.image.width, upright ? 1U : 500'001U);
    EXPECT_EQ(map.image.height, upright ? 500'001U : 1U);
    EXPECT_EQ(decode_png(encode_png(map.image), "a").value(), map.image);
  }
}

TEST(OccupancyMap, RefusesScansTooFarApartForOneImage) {
  const Scan one_beam{.beams = {0, 0.1, 0, 50}, .ranges = {1.0}};
  EvidenceGrid grid;
  grid.add(one_beam, {});
  grid.add(one_beam, {1e6, 1e6, 0});
  EXPECT_THAT(occupancy_map(grid, "a.pgm").error().message,
              testing::HasSubstr("expected scans near each other, found a map of"));
}

}  // namespace
}  // namespace flirt
