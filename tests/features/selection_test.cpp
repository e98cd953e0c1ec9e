#include "flirt/features/selection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <numbers>
#include <vector>

namespace flirt {
namespace {

using ::testing::ElementsAre;

/// A curve over the given ranges; beam i at i half degrees from −90°, 0 = no return.
struct Example {
  ScanCurveReader reader{};
  ScanCurve curve{};

  explicit Example(const std::vector<double>& ranges, double step = std::numbers::pi / 360) {
    const Scan scan{.beams = {.angle_min = -std::numbers::pi / 2, .angle_step = step, .range_max = 30},
                    .ranges = ranges};
    curve = reader.read(scan, NoReturn::drop);
  }
};

std::vector<std::uint32_t> points_of(const std::vector<Candidate>& candidates) {
  std::vector<std::uint32_t> points;
  for (const Candidate& candidate : candidates) { points.push_back(candidate.point); }
  return points;
}

std::vector<std::uint32_t> kept(const ScanCurve& curve, const SelectionParams& params,
                                std::vector<Candidate> candidates) {
  DuplicateWork work;
  drop_duplicates(curve, params, work, candidates);
  return points_of(candidates);
}

TEST(ForegroundPoint, IsTheNearerNeighbourAcrossAJump) {
  const Example example({5, 5, 2, 2, 5, 4.9});
  EXPECT_EQ(foreground_point(example.curve, 1, 0.5), 2U);
  EXPECT_EQ(foreground_point(example.curve, 4, 0.5), 3U);
  EXPECT_EQ(foreground_point(example.curve, 2, 0.5), 2U) << "already in the foreground";
  EXPECT_EQ(foreground_point(example.curve, 0, 0.5), 0U);
}

TEST(ForegroundPoint, NeedsAJumpAboveTheThreshold) {
  const Example example({5, 5, 4.8, 5});
  EXPECT_EQ(foreground_point(example.curve, 1, 0.5), 1U);
  EXPECT_EQ(foreground_point(example.curve, 1, 0.1), 2U);
}

TEST(ForegroundPoint, IsTheNearestOfBothNeighboursAndTheLaterWhenEqual) {
  EXPECT_EQ(foreground_point(Example({2, 5, 3}).curve, 1, 0.5), 0U);
  EXPECT_EQ(foreground_point(Example({3, 5, 2}).curve, 1, 0.5), 2U);
  EXPECT_EQ(foreground_point(Example({2, 5, 2}).curve, 1, 0.5), 2U);
}

TEST(ForegroundPoint, DoesNotReachAcrossABeamWithoutReturn) {
  EXPECT_EQ(foreground_point(Example({2, 0, 5, 5}).curve, 1, 0.5), 1U);
}

TEST(ForegroundPoint, GoesAroundAFullTurn) {
  const double step = std::numbers::pi / 2;
  EXPECT_EQ(foreground_point(Example({5, 5, 5, 2}, step).curve, 0, 0.5), 3U);
  EXPECT_EQ(foreground_point(Example({2, 5, 5, 5}, step).curve, 3, 0.5), 0U);
  EXPECT_EQ(foreground_point(Example({2, 5, 5, 5}).curve, 3, 0.5), 3U) << "an open scan has ends";
}

TEST(DropDuplicates, KeepsTheFinerScale) {
  const Example example(std::vector<double>(100, 2.0));  // points 17 mm apart
  const std::vector<Candidate> candidates{{10, 10, 0.35, 0}, {14, 14, 0.36, 1}, {50, 50, 0.36, 1}};
  EXPECT_THAT(kept(example.curve, {}, candidates), ElementsAre(10, 50));
  EXPECT_THAT(kept(example.curve, {.duplicate_radius = 0.05}, candidates), ElementsAre(10, 14, 50));
}

TEST(DropDuplicates, KeepsTheStrongerOfOneScaleOrTheEarlier) {
  const Example example(std::vector<double>(100, 2.0));
  const std::vector<Candidate> candidates{{10, 10, 0.35, 0}, {14, 14, -0.36, 0}, {24, 24, 0.34, 0}};
  EXPECT_THAT(kept(example.curve, {.precedence = Precedence::response}, candidates), ElementsAre(14));
  EXPECT_THAT(kept(example.curve, {.precedence = Precedence::angle}, candidates), ElementsAre(10, 24));
}

TEST(DropDuplicates, WithRadiusZeroKeepsAllButTwoMovedToOnePoint) {
  const Example example(std::vector<double>(100, 2.0));
  const std::vector<Candidate> candidates{{10, 11, 0.35, 0}, {12, 11, 0.36, 0}, {12, 11, 0.36, 1}, {13, 13, 0.3, 1}};
  EXPECT_THAT(kept(example.curve, {.duplicate_radius = 0.0}, candidates), ElementsAre(11, 11, 13));
}

TEST(DropDuplicates, KeepsTheOrderOfScaleAndAngle) {
  const Example example(std::vector<double>(100, 2.0));
  const std::vector<Candidate> candidates{{10, 10, 0.34, 0}, {40, 40, 0.36, 0}, {70, 70, 0.35, 0}, {90, 90, 0.36, 1}};
  EXPECT_THAT(kept(example.curve, {}, candidates), ElementsAre(10, 40, 70, 90));
}

}  // namespace
}  // namespace flirt
