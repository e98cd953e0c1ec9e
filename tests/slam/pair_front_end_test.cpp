#include "flirt/slam/pair_front_end.hpp"

#include "tests/slam/matched_scans.hpp"

#include <gtest/gtest.h>

namespace flirt {
namespace {

SlamScan scan_in_room(const Pose2& map_from_robot) {
  const Scan scan = test::seen_in_room(map_from_robot);
  return {.points = surface_points(scan, {}), .scan = scan};
}

/// What the front end says of a step from the room's middle.
ScanMotion motion_of(FrontEndKind kind, const Pose2& step) {
  PairFrontEnd front_end(SlamParams{.front_end = kind});
  EXPECT_EQ(front_end.add(scan_in_room({})).source, MotionSource::first);
  return front_end.add(scan_in_room(step));
}

double pair_error_after(FrontEndKind kind, const Pose2& step) {
  return distance(motion_of(kind, step).relative.at(0).earlier_from_robot, step);
}

TEST(PairFrontEnd, BothFindAShortStep) {
  for (const FrontEndKind kind : {FrontEndKind::olson, FrontEndKind::icp}) {
    const ScanMotion motion = motion_of(kind, {0.1, -0.06, 0.05});
    EXPECT_EQ(motion.source, MotionSource::narrow);
    EXPECT_FALSE(motion.unobservable);
    EXPECT_LT(distance(motion.relative.at(0).earlier_from_robot, {0.1, -0.06, 0.05}), 0.01) << to_string(kind);
  }
}

TEST(PairFrontEnd, SearchFindsWhatAlignmentAloneDoesNot) {
  const Pose2 far{0.45, -0.4, 0.38};
  EXPECT_LT(pair_error_after(FrontEndKind::olson, far), 0.02);
  EXPECT_GT(pair_error_after(FrontEndKind::icp, far), 0.1);
}

TEST(PairFrontEnd, AScanWithoutPointsGoesOnAsTheOneBefore) {
  const Pose2 step{0.1, -0.06, 0.05};
  for (const FrontEndKind kind : {FrontEndKind::olson, FrontEndKind::icp}) {
    PairFrontEnd front_end(SlamParams{.front_end = kind});
    static_cast<void>(front_end.add(scan_in_room({})));
    const Pose2 found = front_end.add(scan_in_room(step)).relative.at(0).earlier_from_robot;
    const ScanMotion motion = front_end.add({});
    EXPECT_EQ(motion.source, MotionSource::prediction);
    EXPECT_TRUE(motion.unobservable);
    EXPECT_EQ(motion.relative.at(0).earlier_from_robot, found);
  }
}

}  // namespace
}  // namespace flirt
