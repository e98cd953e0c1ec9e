#include "flirt/map/seen_motion.hpp"

#include "flirt/registration/scan_points.hpp"

#include "tests/registration/rooms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace flirt {
namespace {

using rooms::asymmetric_room;
using rooms::evidence_of;
using rooms::scan_of;
using rooms::walk;

const Pose2 robot_from_sensor{0.2, -0.1, 0.3};

ScanPoints seen_from(const Pose2& map_from_robot) {
  return scan_points(scan_of(asymmetric_room(), map_from_robot * robot_from_sensor, 2 * std::numbers::pi));
}

TEST(SeenMotion, IsTheMotionOfTheRobotBetweenTwoScans) {
  const MapFields fields = map_fields(evidence_of(asymmetric_room(), walk({})));
  const Pose2 before{3, 3, 0.4};
  for (const Pose2& motion : {Pose2{0, 0, 0}, Pose2{0.5, 0.1, 0.3}, Pose2{-0.3, 0.2, -0.5}, Pose2{0.6, 0.2, 0}}) {
    const auto seen = seen_motion(fields, seen_from(before * motion), before, robot_from_sensor, {});
    ASSERT_TRUE(seen.has_value());
    EXPECT_LT(distance(*seen, motion), 0.04);
    EXPECT_LT(heading_difference(*seen, motion), 0.02);
  }
}

TEST(SeenMotion, IsNeverBeyondReach) {
  const MapFields fields = map_fields(evidence_of(asymmetric_room(), walk({})));
  const Pose2 before{3, 3, 0.4};
  for (const Pose2& motion : {Pose2{2, 0.5, 0}, Pose2{0, 0, 1.5}, Pose2{1, -1, 3}}) {
    const auto seen = seen_motion(fields, seen_from(before * motion), before, {}, {.distance = 0.4, .turn = 0.3});
    if (!seen) { continue; }
    EXPECT_LE(norm(seen->translation()), 0.4 + 1e-6);
    EXPECT_LE(std::abs(seen->theta), 0.3 + 1e-6);
  }
}

TEST(SeenMotion, IsNothingWhereNoSensorCanHaveBeen) {
  const MapFields fields = map_fields(evidence_of(asymmetric_room(), walk({})));
  EXPECT_FALSE(seen_motion(fields, seen_from({3, 3, 0.4}), {100, 100, 0}, robot_from_sensor, {}).has_value());
}

}  // namespace
}  // namespace flirt
