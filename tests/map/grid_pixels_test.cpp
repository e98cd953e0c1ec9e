#include "flirt/map/grid_pixels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

namespace flirt {
namespace {

constexpr std::uint8_t occupied_shade = 0;
constexpr std::uint8_t free_shade = 254;

GreyImage room(std::size_t side) {
  return {side, side, std::vector<std::uint8_t>(side * side, free_shade)};
}

/// Blackens what lies within half of `thickness` of the segment, pixels.
void draw_wall(GreyImage& image, Point2 from, Point2 to, double thickness) {
  const Point2 along = to - from;
  for (std::size_t row = 0; row < image.height; ++row) {
    for (std::size_t column = 0; column < image.width; ++column) {
      const Point2 pixel{static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5};
      const double part = std::clamp(dot(pixel - from, along) / dot(along, along), 0.0, 1.0);
      if (norm(pixel - (from + part * along)) <= thickness / 2) {
        image.pixels[row * image.width + column] = occupied_shade;
      }
    }
  }
}

std::size_t count(const GridPixels& pixels, GridPixel pixel) {
  return static_cast<std::size_t>(std::ranges::count(pixels.pixels, pixel));
}

/// From the top: # solid, + passed, c core, . free, ? unknown.
std::vector<std::string> rows_of(const GridPixels& pixels) {
  std::vector<std::string> rows;
  for (std::int32_t row = 0; row < pixels.height; ++row) {
    rows.emplace_back();
    for (std::int32_t column = 0; column < pixels.width; ++column) {
      rows.back() += ".?+#c"[static_cast<std::size_t>(pixels.at(column, row))];
    }
  }
  return rows;
}

/// Rows from the top: # black, . white, ? unknown; coarse enough for every piece to be a wall.
std::vector<std::string> parts(const std::vector<std::string>& rows) {
  GreyImage image{rows[0].size(), rows.size(), {}};
  for (const std::string& row : rows) {
    for (const char c : row) { image.pixels.push_back(c == '#' ? occupied_shade : c == '.' ? free_shade : 205); }
  }
  return rows_of(grid_pixels(image, {.resolution = 1}));
}

TEST(GridPixels, BeamsPassALegAndNotAWall) {
  for (const double resolution : {0.1, 0.05, 0.025}) {
    const double pixels_per_metre = 1 / resolution;
    GreyImage leg = room(100);
    draw_wall(leg, {50.5, 50.5}, {50.5 + 0.1 * pixels_per_metre, 50.5}, 0.1 * pixels_per_metre);
    const GridPixels leg_pixels = grid_pixels(leg, {.resolution = resolution});
    EXPECT_GT(count(leg_pixels, GridPixel::passed), 0U) << resolution;
    EXPECT_EQ(count(leg_pixels, GridPixel::solid) + count(leg_pixels, GridPixel::core), 0U) << resolution;

    GreyImage wall = room(100);
    draw_wall(wall, {50.5, 50.5}, {50.5 + 0.8 * pixels_per_metre, 50.5}, 1);
    const GridPixels wall_pixels = grid_pixels(wall, {.resolution = resolution});
    EXPECT_GT(count(wall_pixels, GridPixel::solid), 0U) << resolution;
    EXPECT_EQ(count(wall_pixels, GridPixel::passed) + count(wall_pixels, GridPixel::core), 0U) << resolution;
  }
}

TEST(GridPixels, AWallIsAWallHoweverItIsTurned) {
  for (const double resolution : {0.1, 0.05, 0.025}) {
    for (double turn = 0; turn < std::numbers::pi; turn += 0.1) {
      const Point2 half = (0.5 / resolution) * Point2{std::cos(turn), std::sin(turn)};
      const Point2 middle{50, 50};
      GreyImage thin = room(100);
      draw_wall(thin, middle - half, middle + half, 1.5);
      EXPECT_GE(count(grid_pixels(thin, {.resolution = resolution}), GridPixel::solid), 0.9 / resolution) << turn;
      GreyImage thick = room(100);
      draw_wall(thick, middle - half, middle + half, 5);
      EXPECT_GE(count(grid_pixels(thick, {.resolution = resolution}), GridPixel::core), 0.8 / resolution) << turn;
    }
  }
}

TEST(GridPixels, PiecesHangTogetherAcrossCorners) {
  const auto stairs = [](std::size_t steps) {
    GreyImage image = room(20);
    for (std::size_t i = 3; i < 3 + steps; ++i) { image.pixels[i * 20 + i] = occupied_shade; }
    return count(grid_pixels(image, {.resolution = 0.05}), GridPixel::solid);
  };
  EXPECT_EQ(stairs(9), 9U);
  EXPECT_EQ(stairs(8), 0U);  // 0.57 m across
}

TEST(GridPixels, WhatIsGreyConnectsButIsNotSolid) {
  GreyImage image{20, 1, std::vector<std::uint8_t>(20, 60)};
  image.pixels[4] = occupied_shade;
  image.pixels[15] = occupied_shade;
  EXPECT_EQ(rows_of(grid_pixels(image, {.resolution = 0.05})), (std::vector<std::string>{"++++#++++++++++#++++"}));
}

TEST(GridPixels, AThickWallHasAFrontThatBeamsPassAndACore) {
  EXPECT_EQ(parts({".......", "#######", "#######", "#######", "#######", "???????"}),
            (std::vector<std::string>{".......", "+++++++", "ccccccc", "???????", "???????", "???????"}));
  EXPECT_EQ(parts({".......", "#######", "#######", "#######", "......."}),
            (std::vector<std::string>{".......", "+++++++", "ccccccc", "+++++++", "......."}));
  EXPECT_EQ(parts({".......", "#######", "#######", "???????"}),
            (std::vector<std::string>{".......", "+++++++", "ccccccc", "???????"}));
}

TEST(GridPixels, ThinWallsAreSolid) {
  for (const std::vector<std::string>& rows :
       {std::vector<std::string>{".....", "#####", "#####", "....."},
        std::vector<std::string>{"#....", ".#...", "..#..", "...##"},
        std::vector<std::string>{"?????", "?###?", "?????"}, std::vector<std::string>{".....", "#####", "?????"}}) {
    EXPECT_EQ(parts(rows), rows);
  }
}

TEST(GridPixels, WhereUnseenIsEvenOddsWhatIsLessLikelyIsFree) {
  // A map of probabilities: hardly any of its free space is below the threshold of 0.196.
  const GreyImage probabilities{6, 1, {128, 128, 200, 140, 128, 100}};
  EXPECT_EQ(rows_of(grid_pixels(probabilities, {})), (std::vector<std::string>{"??..?+"}));
  // A map with a grey of its own for unseen space: other greys say nothing.
  const GreyImage shades{6, 1, {205, 205, 200, 140, 254, 100}};
  EXPECT_EQ(rows_of(grid_pixels(shades, {})), (std::vector<std::string>{"????.+"}));
}

}  // namespace
}  // namespace flirt
