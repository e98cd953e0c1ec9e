#include "flirt/map/grid_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace flirt {
namespace {

/// All free but for one occupied pixel in the given column and row from the top.
GreyImage picture(std::size_t side, std::size_t column, std::size_t row) {
  GreyImage image{side, side, std::vector<std::uint8_t>(side * side, 254)};
  image.pixels[row * side + column] = 0;
  return image;
}

std::size_t count(const GridCells& cells, CellState state) {
  return static_cast<std::size_t>(std::ranges::count(cells.states, state));
}

TEST(GridCells, PixelsOfTheSizeOfCellsAreCells) {
  const GridCells cells = grid_cells(picture(10, 2, 9), {.origin = {-0.25, 1.0, 0}}, 0.05).value();
  EXPECT_EQ(cells.first, (CellIndex{-5, 20}));
  EXPECT_EQ(cells.width, 10);
  EXPECT_EQ(cells.height, 10);
  EXPECT_EQ(cells.at({-3, 20}), CellState::occupied);
  EXPECT_EQ(count(cells, CellState::occupied), 1U);
  EXPECT_EQ(count(cells, CellState::free), 99U);
  EXPECT_EQ(cells.at({-6, 20}), CellState::unknown);
}

TEST(GridCells, ACoarsePixelFillsAllItsCells) {
  const GridCells cells = grid_cells(picture(10, 2, 9), {.resolution = 0.1}, 0.05).value();
  EXPECT_EQ(count(cells, CellState::occupied), 4U);
  for (const CellIndex cell : {CellIndex{4, 0}, CellIndex{5, 0}, CellIndex{4, 1}, CellIndex{5, 1}}) {
    EXPECT_EQ(cells.at(cell), CellState::occupied);
  }
}

TEST(GridCells, AnyOccupiedFinePixelMakesItsCellOccupied) {
  for (const double resolution : {0.025, 0.01, 0.005}) {
    for (const double turn : {0.0, 0.4, std::numbers::pi / 4}) {
      const GreyImage image = picture(60, 31, 20);
      const GridMapMetadata metadata{.resolution = resolution, .origin = {0.3, -0.7, turn}};
      const GridCells cells = grid_cells(image, metadata, 0.05).value();
      const Point2 pixel = map_point(31, 20, image, metadata);
      const CellIndex cell{static_cast<std::int32_t>(std::floor(pixel.x / 0.05)),
                           static_cast<std::int32_t>(std::floor(pixel.y / 0.05))};
      EXPECT_EQ(cells.at(cell), CellState::occupied) << resolution << " " << turn;
      const double share = resolution * resolution / (0.05 * 0.05);
      double sum = 0;
      for (const float part : cells.occupied_share) { sum += static_cast<double>(part); }
      EXPECT_NEAR(sum, share, 0.6 * share);
    }
  }
}

TEST(GridCells, ShadesTellWhatBeamsPassFromWhatTheyDoNot) {
  GreyImage image{14, 1, std::vector<std::uint8_t>(14, 60)};  // dark, so that all that is occupied hangs together
  image.pixels[0] = 0;
  image.pixels[1] = 60;
  image.pixels[12] = 115;  // likelier than not
  image.pixels[13] = 205;
  const GridCells cells = grid_cells(image, {}, 0.05).value();
  const EvidenceGrid evidence = evidence_of(cells, 8, 0.05);
  EXPECT_TRUE(evidence.cell({0, 0}).strong());
  for (const std::int32_t x : {1, 12}) {
    EXPECT_TRUE(evidence.cell({x, 0}).occupied()) << x;
    EXPECT_FALSE(evidence.cell({x, 0}).strong()) << x;
  }
  EXPECT_FALSE(evidence.cell({13, 0}).seen());
}

/// A free square of 4 m with a wall along its middle, x from left to right.
GreyImage room_with_wall(double resolution, std::size_t thickness) {
  const auto side = static_cast<std::size_t>(std::lround(4 / resolution));
  GreyImage image{side, side, std::vector<std::uint8_t>(side * side, 254)};
  const auto first = image.pixels.begin() + static_cast<std::ptrdiff_t>(side / 2 * side);
  std::fill(first, first + static_cast<std::ptrdiff_t>(thickness * side), 0);
  return image;
}

TEST(GridCells, HardlyAnyBeamGetsThroughAWallHoweverTheMapIsTurned) {
  for (const double resolution : {0.1, 0.05, 0.025}) {
    for (const std::size_t thickness : {1U, 2U, 3U, 5U}) {
      int through = 0;
      int beams = 0;
      for (double turn = 0; turn < std::numbers::pi; turn += 0.13) {
        const GridMapMetadata metadata{.resolution = resolution, .origin = {0.017, 0.031, turn}};
        const GridCells cells = grid_cells(room_with_wall(resolution, thickness), metadata, 0.05).value();
        for (double x = 0.5; x < 3.5; x += 0.01) {
          bool is_stopped = false;
          traverse(fixed_point(20.0 * (metadata.origin * Point2{x, 1.0})),
                   fixed_point(20.0 * (metadata.origin * Point2{x, 3.0})), [&](std::int32_t column, std::int32_t row) {
                     is_stopped |= cells.contains({column, row}) && cells.solid[cells.offset({column, row})] != 0;
                   });
          through += is_stopped ? 0 : 1;
          ++beams;
        }
      }
      EXPECT_LT(through, beams / 100) << resolution << " " << thickness;
    }
  }
}

TEST(GridCells, AThinWallAcrossTwoRowsOfCellsIsSolidInOne) {
  const GridCells cells = grid_cells(room_with_wall(0.05, 1), {.origin = {0, 0.035, 0}}, 0.05).value();
  std::vector<std::int32_t> occupied;
  std::vector<std::int32_t> solid;
  for (std::int32_t y = cells.first.y; y < cells.first.y + cells.height; ++y) {
    if (cells.at({40, y}) == CellState::occupied) { occupied.push_back(y); }
    if (cells.solid[cells.offset({40, y})] != 0) { solid.push_back(y); }
  }
  EXPECT_EQ(occupied, (std::vector{39, 40}));
  EXPECT_EQ(solid, (std::vector{40}));
}

TEST(GridCells, TheCoreOfAThickWallStopsBeamsAndHardlyDrawsScans) {
  const GridCells cells = grid_cells(room_with_wall(0.05, 3), {}, 0.05).value();
  const EvidenceGrid evidence = evidence_of(cells, 8, 0.05);
  for (const std::int32_t front : {37, 39}) {
    EXPECT_EQ(evidence.cell({40, front}), (EvidenceCell{.hits = 8, .passes = 9})) << front;
  }
  EXPECT_EQ(evidence.cell({40, 38}), (EvidenceCell{.hits = 2, .passes = 0}));
}

TEST(GridCells, ATurnedImageHasNoHoles) {
  const GreyImage white{100, 100, std::vector<std::uint8_t>(10000, 254)};
  const GridMapMetadata metadata{.resolution = 0.08, .origin = {3, -2, 0.6}};
  const GridCells cells = grid_cells(white, metadata, 0.05).value();
  EXPECT_NEAR(static_cast<double>(count(cells, CellState::free)) * 0.05 * 0.05, 64.0, 0.5);
  for (double x = 0.1; x < 7.9; x += 0.03) {
    const Point2 at = metadata.origin * Point2{x, 8 - x};
    EXPECT_EQ(cells.at({static_cast<std::int32_t>(std::floor(at.x / 0.05)),
                        static_cast<std::int32_t>(std::floor(at.y / 0.05))}),
              CellState::free);
  }
}

TEST(GridCells, WhatIsTooLargeTooFarOrTooFineIsAnError) {
  const GreyImage white{2000, 2000, std::vector<std::uint8_t>(4000000, 254)};
  EXPECT_FALSE(grid_cells(white, {.resolution = 0.51}, 0.05).has_value());
  EXPECT_FALSE(grid_cells(white, {.origin = {2e6, 0, 0}}, 0.05).has_value());
  EXPECT_FALSE(grid_cells(white, {.origin = {0, -2e6, 0}}, 0.05).has_value());
  EXPECT_FALSE(grid_cells(white, {.resolution = 0.0005}, 0.05).has_value());
}

TEST(GridCells, EvidenceGoesByTheOccupiedShareAndStaysSolid) {
  const GridCells cells{.first = {-1, 7},
                        .width = 4,
                        .height = 1,
                        .states = {CellState::occupied, CellState::occupied, CellState::free, CellState::unknown},
                        .occupied_share = {1.0F, 0.1F, 0.0F, 0.0F},
                        .solid = {1, 1, 0, 0}};
  const EvidenceGrid evidence = evidence_of(cells, 8, 0.05);
  EXPECT_EQ(evidence.cell({-1, 7}), (EvidenceCell{.hits = 8, .passes = 0}));
  EXPECT_EQ(evidence.cell({0, 7}), (EvidenceCell{.hits = 2, .passes = 0}));
  EXPECT_TRUE(evidence.cell({0, 7}).strong());
  EXPECT_EQ(evidence.cell({1, 7}), (EvidenceCell{.hits = 0, .passes = 8}));
  EXPECT_FALSE(evidence.cell({2, 7}).seen());
}

}  // namespace
}  // namespace flirt
