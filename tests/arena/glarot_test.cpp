#include "flirt/arena/glarot.hpp"

#include "tests/arena/point_sets.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flirt {
namespace {

using testing::Each;

const std::vector<Point2> signed_points{{0, 0}, {4.03, 0.2}, {0.3, 3}, {5.5, 6.13}, {-2.3, 1.7}};
const GlarotParams any_count{.min_keypoints = 0};

GlarotDistance between(const std::vector<Point2>& a, const std::vector<Point2>& b) {
  return glarot_distance(glarot_signature(a), glarot_signature(b));
}

TEST(Glarot, SpreadsAPairOverItsBins) {
  const GlarotSignature signature = glarot_signature(std::vector<Point2>{{0, 0}, {1.03, 0.01}}, any_count);
  const auto bin = [&](std::size_t u, std::size_t v) { return signature.bins[u * 80 + v]; };
  EXPECT_FLOAT_EQ(bin(0, 10), 1);
  EXPECT_NEAR(bin(1, 10), 0.606531, 1e-6);
  EXPECT_NEAR(bin(7, 10), 0.606531, 1e-6);
  EXPECT_NEAR(bin(3, 10), 0.011109, 1e-6);
  EXPECT_NEAR(bin(5, 10), 0.011109, 1e-6);
  EXPECT_EQ(bin(4, 10), 0);
  EXPECT_NEAR(std::accumulate(signature.bins.begin(), signature.bins.end(), 0.0), 6.279785, 1e-5);
}

TEST(Glarot, LeavesOutPairsThatAreTooFarApart) {
  EXPECT_THAT(glarot_signature(std::vector<Point2>{{0, 0}, {8.1, 0}}, any_count).bins, Each(0.0F));
}

TEST(Glarot, TellsLengthsApart) {
  const auto one = glarot_signature(std::vector<Point2>{{0, 0}, {1.03, 0.01}}, any_count);
  const auto two = glarot_signature(std::vector<Point2>{{0, 0}, {2.03, 0.01}}, any_count);
  EXPECT_NEAR(glarot_distance(one, two).value, 12.559570, 1e-5);
}

TEST(Glarot, IsInvariantUnderTurnsByItsBinsAndShiftsAndOrder) {
  const GlarotDistance turned = between(signed_points, moved(signed_points, {7, -3, std::numbers::pi / 8}));
  EXPECT_NEAR(turned.value, 0, 1e-5);
  EXPECT_NEAR(turned.turn, std::numbers::pi / 8, 1e-12);
  const GlarotDistance half_turn = between(signed_points, moved(signed_points, {0, 0, std::numbers::pi}));
  EXPECT_NEAR(half_turn.value, 0, 1e-5);
  EXPECT_EQ(half_turn.turn, 0);
  std::vector<Point2> reversed = signed_points;
  std::ranges::reverse(reversed);
  EXPECT_NEAR(between(signed_points, reversed).value, 0, 1e-5);
}

TEST(Glarot, GrowsWithWhatIsDifferent) {
  const GlarotSignature signature = glarot_signature(signed_points);
  EXPECT_NEAR(std::accumulate(signature.bins.begin(), signature.bins.end(), 0.0), 41.4145, 1e-3);
  EXPECT_NEAR(between(signed_points, moved(signed_points, {0, 0, radians_from_degrees(10)})).value, 4.1316, 1e-3);
  std::vector<Point2> one_moved = signed_points;
  one_moved.back() = {-2.3, -1.7};
  EXPECT_NEAR(between(signed_points, one_moved).value, 21.5193, 1e-3);
  std::vector<Point2> mirrored = signed_points;
  for (Point2& point : mirrored) { point.y = -point.y; }
  EXPECT_NEAR(between(signed_points, mirrored).value, 22.6671, 1e-3);
  EXPECT_NEAR(between(signed_points, {{0, 0}, {1, 5}, {3, 3}, {-4, 2}, {2, -2}}).value, 59.8047, 1e-3);
}

TEST(Glarot, IsInfinitelyFarFromSetsThatAreTooSmall) {
  EXPECT_TRUE(std::isinf(between(signed_points, {}).value));
  EXPECT_TRUE(std::isinf(between({}, {}).value));
  EXPECT_TRUE(std::isinf(between({signed_points.begin(), signed_points.begin() + 4}, signed_points).value));
}

}  // namespace
}  // namespace flirt
