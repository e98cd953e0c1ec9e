#include "flirt/registration/scan_points.hpp"

#include "rooms.hpp"

#include <gtest/gtest.h>

#include <cstddef>

namespace flirt {
namespace {

TEST(ScanPoints, KeepTheirSpacingAcrossTheSeamOfAFullTurn) {
  const auto walls = rooms::asymmetric_room();
  for (const double heading : {0.0, 0.7, 1.9, 3.0}) {
    const ScanPoints points = scan_points(rooms::scan_of(walls, {3.1, 3.3, heading}, 2 * std::numbers::pi));
    ASSERT_GT(points.size(), 50U);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t next = (i + 1) % points.size();
      const Point2 step{points.x[next] - points.x[i], points.y[next] - points.y[i]};
      EXPECT_GE(norm(step), 0.0999) << heading << ", point " << i;
    }
  }
}

TEST(ScanPoints, OfHalfATurnMayEndWhereTheyBegan) {
  // The first and the last beam of half a turn are no neighbours, however near their ends are.
  Scan scan{.beams = {-1.5, 1.0, 0.05, 50}};
  scan.ranges = {0.06, 1.0, 1.0, 0.06};
  EXPECT_EQ(scan_points(scan).size(), 4U);
}

}  // namespace
}  // namespace flirt
