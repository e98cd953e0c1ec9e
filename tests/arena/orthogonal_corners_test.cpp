#include "flirt/arena/orthogonal_corners.hpp"

#include "tests/arena/corners.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace flirt {
namespace {

using testing::IsEmpty;

struct Expected {
  std::uint32_t beam;
  Pose2 pose;  ///< theta in degrees
};

void expect_corners(const std::vector<Keypoint>& found, const std::vector<Expected>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Pose2 pose = found[i].sensor_from_keypoint;
    EXPECT_EQ(found[i].beam, expected[i].beam);
    EXPECT_NEAR(pose.x, expected[i].pose.x, 1e-4);
    EXPECT_NEAR(pose.y, expected[i].pose.y, 1e-4);
    EXPECT_NEAR(wrap_angle(pose.theta - radians_from_degrees(expected[i].pose.theta)), 0, 1e-6);
  }
}

TEST(OrthogonalCorners, FindAllCornersOfATurnedRoomAndTheirDirections) {
  const Scene room = moved(polygon(std::vector<Point2>{{-4.7, -2.9}, {3.3, -2.9}, {3.3, 2.1}, {-4.7, 2.1}}),
                           {0, 0, radians_from_degrees(20)});
  const Scan scan = scan_of(room, {}, half_degree_beams(-180), 720);
  EXPECT_NEAR(degrees_from_radians(main_direction(polar_scan(scan, {}), {})), 20, 1e-9);
  expect_corners(detect_orthogonal_corners(scan), {{104, {-3.4247, -4.3326, 65}},
                                                   {316, {4.0928, -1.5964, 155}},
                                                   {465, {2.3827, 3.1020, -115}},
                                                   {711, {-5.1348, 0.3659, -25}}});
}

TEST(OrthogonalCorners, ScoreByHowEvenBothWallsAre) {
  const std::vector<Keypoint> even = detect_orthogonal_corners(corner_scan(45));
  expect_corners(even, {{180, {3, 0, 180}}});
  EXPECT_NEAR(even[0].response, 240, 1e-3);
  EXPECT_NEAR(even[0].support_radius, 0.49347, 1e-5);
  const std::vector<Keypoint> uneven = detect_orthogonal_corners(corner_scan(45, -89.75, 360));
  ASSERT_EQ(uneven.size(), 1U);
  EXPECT_EQ(uneven[0].beam, 179U);
  EXPECT_NEAR(uneven[0].response, 25 / 1.1, 1e-3);
}

TEST(OrthogonalCorners, AreFourInASquareRoom) {
  const Scan scan = scan_of(box({}, 6, 6), {}, half_degree_beams(-180), 720);
  expect_corners(detect_orthogonal_corners(scan),
                 {{90, {-3, -3, 45}}, {270, {3, -3, 135}}, {450, {3, 3, -135}}, {630, {-3, 3, -45}}});
}

TEST(OrthogonalCorners, AreNotOnWallsOrBluntCornersOrFansWithoutReturns) {
  EXPECT_THAT(detect_orthogonal_corners(wall_scan()), IsEmpty());
  EXPECT_THAT(detect_orthogonal_corners(corner_scan(70)), IsEmpty());
  Scan scan = wall_scan();
  for (const double reading : {50.0, std::numeric_limits<double>::quiet_NaN(), 0.0}) {
    for (double& range : scan.ranges) { range = reading; }
    EXPECT_THAT(detect_orthogonal_corners(scan), IsEmpty());
  }
  EXPECT_THAT(detect_orthogonal_corners(Scan{}), IsEmpty());
  EXPECT_THAT(detect_orthogonal_corners(corner_scan(45, 0, 1)), IsEmpty());
}

}  // namespace
}  // namespace flirt
