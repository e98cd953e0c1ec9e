#include "flirt/core/scan.hpp"

#include "tests/support/numbers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace flirt {
namespace {

TEST(Scan, TellsNoReturnFromInvalid) {
  const Beams beams{.angle_min = 0, .angle_step = 0.01, .range_min = 0.1, .range_max = 50};
  EXPECT_EQ(classify(1.0, beams), Reading::hit);
  EXPECT_EQ(classify(0.1, beams), Reading::hit);
  EXPECT_EQ(classify(50.0, beams), Reading::no_return);
  EXPECT_EQ(classify(81.83, beams), Reading::no_return);
  EXPECT_EQ(classify(infinity, beams), Reading::no_return);
  EXPECT_EQ(classify(0.0, beams), Reading::no_return);
  EXPECT_EQ(classify(0.05, beams), Reading::invalid);
  EXPECT_EQ(classify(-1.0, beams), Reading::invalid);
  EXPECT_EQ(classify(-infinity, beams), Reading::invalid);
  EXPECT_EQ(classify(std::nan(""), beams), Reading::invalid);
}

TEST(Scan, ClockwiseBeamsGiveTheSamePointsInTheSameOrder) {
  Scan counter_clockwise{.beams = {-1.0, 0.1, 0, 50}, .ranges = {1, 2, 3, infinity, 5}};
  Scan clockwise{.beams = {-0.6, -0.1, 0, 50}, .ranges = {5, infinity, 3, 2, 1}};
  const auto a = hit_points(counter_clockwise);
  const auto b = hit_points(clockwise);
  ASSERT_EQ(a.size(), 4U);
  ASSERT_EQ(b.size(), 4U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i].point.x, b[i].point.x, 1e-12);
    EXPECT_NEAR(a[i].point.y, b[i].point.y, 1e-12);
    EXPECT_EQ(a[i].beam, 4 - b[i].beam);
  }
}

TEST(Scan, KnowsAFullTurn) {
  Scan scan{.beams = {0, 2 * std::numbers::pi / 360, 0, 50}, .ranges = std::vector<double>(360, 1.0)};
  EXPECT_TRUE(is_full_turn(scan));
  scan.ranges.pop_back();
  EXPECT_FALSE(is_full_turn(scan));
  scan.beams.angle_step *= -1;
  scan.ranges.assign(360, 1.0);
  EXPECT_TRUE(is_full_turn(scan));
  EXPECT_FALSE(is_full_turn(Scan{}));
}

}  // namespace
}  // namespace flirt
