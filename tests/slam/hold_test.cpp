#include "flirt/slam/hold.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

namespace flirt {
namespace {

/// A plate across a part of the corridor: the chest of somebody, or the wall at its end.
struct Plate {
  double x{0};
  double half_width{0.25};
};

/// What a robot at (x, 0) sees of a corridor along x, 2 m wide, and of what stands in it.
SurfacePoints seen_from_corridor(double x, const std::vector<Plate>& plates) {
  Scan scan{.beams = {-std::numbers::pi, radians_from_degrees(0.5), 0.05, 12}};
  for (std::size_t i = 0; i < 720; ++i) {
    const double angle = scan.beams.angle(i);
    double range = 1 / std::max(1e-9, std::abs(std::sin(angle)));
    for (const Plate& plate : plates) {
      const double along = (plate.x - x) / std::cos(angle);
      if (along > 0 && std::abs(along * std::sin(angle)) < plate.half_width) { range = std::min(range, along); }
    }
    scan.ranges.push_back(range < 8 ? static_cast<float>(range) : std::numeric_limits<float>::infinity());
  }
  return surface_points(scan);
}

TEST(Hold, ABareCorridorHoldsAcrossAlone) {
  const Hold hold = hold_of(seen_from_corridor(0, {}));
  EXPECT_LT(hold.weakest, SlamParams{}.unobservable_share);
  EXPECT_NEAR(std::abs(hold.direction.x), 1, 1e-3);
}

TEST(Hold, TheEndOfACorridorHoldsAlongIt) {
  const std::vector<Plate> end{{3, 1}};
  LocalMap map;
  for (const double x : {0.0, 0.3, 0.6}) { map.add(seen_from_corridor(x, end), {x, 0, 0}); }
  const SurfacePoints points = seen_from_corridor(0.9, end);
  const Hold hold = hold_of(std::span(&points, 1), map, {0.9, 0, 0});
  EXPECT_GT(hold.weakest, SlamParams{}.unobservable_share);
  EXPECT_FALSE(hold.doubted);
  EXPECT_TRUE(holds(hold, {}));
}

TEST(Hold, WhoeverStandsHoldsButWhoeverWalksOnDoesNot) {
  LocalMap map;
  for (int i = 0; i < 4; ++i) {
    const double x = 0.3 * i;
    map.add(seen_from_corridor(x, {{3.5}}), {x, 0, 0});
  }
  const Pose2 here{1.2, 0, 0};
  const SurfacePoints stood = seen_from_corridor(here.x, {{3.5}});
  EXPECT_TRUE(holds(hold_of(std::span(&stood, 1), map, here), {}));
  const SurfacePoints came_near = seen_from_corridor(here.x, {{2.6}});
  EXPECT_TRUE(hold_of(std::span(&came_near, 1), map, here).doubted);
  EXPECT_FALSE(holds(hold_of(std::span(&came_near, 1), map, here), {}));
}

TEST(Hold, WithoutAnySurfaceNothingHolds) {
  EXPECT_EQ(hold_of(SurfacePoints{}).weakest, 0);
  EXPECT_EQ(hold_of(std::span<const SurfacePoints>{}, LocalMap{}, {}).weakest, 0);
}

TEST(Hold, LeadTellsABareCorridorFromOneWithAnEnd) {
  const Pose2 here{0.9, 0, 0};
  const auto lead_with = [&](const std::vector<Plate>& plates) {
    LocalMap map;
    for (const double x : {0.0, 0.3, 0.6}) { map.add(seen_from_corridor(x, plates), {x, 0, 0}); }
    const SurfacePoints points = seen_from_corridor(here.x, plates);
    return hold_of(std::span(&points, 1), map, here);
  };
  const Hold bare = lead_with({});
  const Hold ended = lead_with({{3, 1}});
  EXPECT_LT(bare.lead, SlamParams{}.loop_lead);
  EXPECT_GT(ended.lead, SlamParams{}.loop_lead);
  EXPECT_GT(inverse_deviation(ended, {}), inverse_deviation(bare, {}));
}

TEST(Hold, WhatIsKnownAlongADirectionIsTakenBack) {
  Eigen::Matrix3d known = Eigen::Vector3d(100, 400, 900).asDiagonal();
  EXPECT_FALSE(know_at_most(200, {1, 0}, known));
  EXPECT_EQ(known(0, 0), 100);
  EXPECT_TRUE(know_at_most(50, {0, 1}, known));
  EXPECT_TRUE(known.isApprox(Eigen::Matrix3d(Eigen::Vector3d(100, 50, 900).asDiagonal()), 1e-12));
}

}  // namespace
}  // namespace flirt
