#include "flirt/registration/refine.hpp"

#include "rooms.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace flirt {
namespace {

TEST(Refine, ReturnsToThePoseFromNearby) {
  const auto walls = rooms::asymmetric_room();
  const MapFields fields = map_fields(rooms::evidence_of(walls, rooms::walk({})));
  const Pose2 truth{3.1, 3.3, 0.4};
  const ScanPoints points = scan_points(rooms::scan_of(walls, truth, std::numbers::pi));
  Rng rng(2);
  for (int i = 0; i < 50; ++i) {
    const Pose2 start{truth.x + rng.uniform(-0.15, 0.15), truth.y + rng.uniform(-0.15, 0.15),
                      truth.theta + rng.uniform(-0.04, 0.04)};
    const RefinedPose refined = refine(fields, points, start);
    EXPECT_LT(distance(refined.map_from_sensor, truth), 0.02) << i;
    EXPECT_LT(heading_difference(refined.map_from_sensor, truth), 0.008) << i;
    EXPECT_GT(refined.support, 0.8);
  }
}

/// Scans of all parts of a clean room against a map that has noise of its own: the truth must lie in the stated region
/// at least as often as it promises, and the region must not be wide without need. (Constants were set on whole
/// buildings with people and furniture; a bare room is better than those.)
TEST(Refine, CovarianceHoldsTheTruthAndIsNotWideWithoutNeed) {
  const auto walls = rooms::asymmetric_room();
  const MapFields fields = map_fields(rooms::evidence_of(walls, rooms::walk({})));
  Rng rng(4);
  int within_95 = 0;
  Eigen::Vector3d squared_errors = Eigen::Vector3d::Zero();
  Eigen::Vector3d stated = Eigen::Vector3d::Zero();
  constexpr int draws = 300;
  for (int i = 0; i < draws; ++i) {
    const Pose2 truth{rng.uniform(3, 7), rng.uniform(2.2, 4.5), rng.uniform(-3, 3)};
    const ScanPoints points = scan_points(rooms::scan_of(walls, truth, std::numbers::pi, &rng, 0.03));
    const RefinedPose refined = refine(fields, points, truth);
    const Eigen::Vector3d error(refined.map_from_sensor.x - truth.x, refined.map_from_sensor.y - truth.y,
                                wrap_angle(refined.map_from_sensor.theta - truth.theta));
    within_95 += error.dot(refined.covariance.inverse() * error) < 7.815 ? 1 : 0;
    squared_errors += error.cwiseAbs2();
    stated += refined.covariance.diagonal();
  }
  EXPECT_GE(within_95, 0.95 * draws);
  for (int i = 0; i < 3; ++i) { EXPECT_LT(stated(i), 4 * 4 * squared_errors(i)) << i; }
}

TEST(Refine, IsLessSureTheLessTheMapExplains) {
  const auto walls = rooms::asymmetric_room();
  const MapFields fields = map_fields(rooms::evidence_of(walls, rooms::walk({})));
  const Pose2 truth{3.1, 3.3, 0.4};
  Scan scan = rooms::scan_of(walls, truth, std::numbers::pi);
  const RefinedPose all = refine(fields, scan_points(scan), truth);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (i / 20 % 2 == 0) { scan.ranges[i] *= 0.5; }  // wider than legs, which are left out
  }
  const RefinedPose half = refine(fields, scan_points(scan), truth);
  EXPECT_LT(half.support, 0.7);
  EXPECT_GT(half.covariance.determinant(), 8 * all.covariance.determinant());
}

/// A wall 0.2 m thick that the map only saw from one side, and a scan from the other: drawn onto the far side it would
/// be 0.2 m off.
TEST(Refine, IsNotDrawnOntoTheFarSideOfAWall) {
  const auto far_side = rooms::outline({{0, 0}, {8, 0}, {8, 5}, {0, 5}});
  const auto near_side = rooms::outline({{-6, -4}, {0, -4}, {14, -4}, {14, -0.2}, {-6, -0.2}});
  Rng rng(8);
  EvidenceGrid grid;
  for (int i = 0; i < 20; ++i) {
    const Pose2 pose{1 + 0.3 * i, 2.5, 0.37 * i};
    grid.add(rooms::scan_of(far_side, pose, 2 * std::numbers::pi, &rng, 0.01), pose);
  }
  const MapFields fields = map_fields(grid);
  const Pose2 truth{4, -2, 1.57};
  const ScanPoints points = scan_points(rooms::scan_of(near_side, truth, 2.0));
  EXPECT_NEAR(refine(fields, points, truth).map_from_sensor.y, -2, 0.02);
  EXPECT_GT(refine(fields, points, truth, {.before = 0}).map_from_sensor.y, -1.9);
}

TEST(Refine, KnowsThatACorridorHidesThePlaceAlongIt) {
  const std::vector<rooms::Wall> walls{{{-60, 0.01}, {60, 0.01}}, {{-60, 2.02}, {60, 2.02}}};
  Rng rng(6);
  EvidenceGrid grid;
  for (int i = 0; i < 40; ++i) {
    const Pose2 pose{0.25 * i, 1 + 0.01 * (i % 7), 0.37 * i};
    grid.add(rooms::scan_of(walls, pose, 2 * std::numbers::pi, &rng, 0.01), pose);
  }
  const Pose2 truth{5.1, 1, 0.02};
  const Scan scan = rooms::scan_of(walls, truth, std::numbers::pi, &rng, 0.01);
  const RefinedPose refined = refine(map_fields(grid), scan_points(scan), truth);
  EXPECT_GT(refined.covariance(0, 0), 6 * refined.covariance(1, 1));
  EXPECT_NEAR(refined.map_from_sensor.y, 1, 0.02);
  EXPECT_GT(refined.support, 0.5);
}

}  // namespace
}  // namespace flirt
