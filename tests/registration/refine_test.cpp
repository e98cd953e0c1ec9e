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

/// The spread of many noisy scans must be what the covariance says, within the sampling error of 300 draws and the
/// noise that the map itself has.
TEST(Refine, CovarianceIsTheSpreadOfNoisyScans) {
  const auto walls = rooms::asymmetric_room();
  const MapFields fields = map_fields(rooms::evidence_of(walls, rooms::walk({})));
  const Pose2 truth{3.1, 3.3, 0.4};
  Rng rng(4);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d stated = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> errors;
  constexpr int draws = 300;
  for (int i = 0; i < draws; ++i) {
    const RefinedPose refined = refine(fields, scan_points(rooms::scan_of(walls, truth, std::numbers::pi, &rng, 0.03)),
                                       truth, {.range_sigma = 0.03, .common_translation = 0, .common_rotation = 0});
    errors.emplace_back(refined.map_from_sensor.x - truth.x, refined.map_from_sensor.y - truth.y,
                        wrap_angle(refined.map_from_sensor.theta - truth.theta));
    mean += errors.back() / draws;
    stated += refined.covariance / draws;
  }
  for (const Eigen::Vector3d& error : errors) { spread += (error - mean) * (error - mean).transpose() / (draws - 1); }
  for (int i = 0; i < 3; ++i) {
    EXPECT_GT(spread(i, i), 0.4 * stated(i, i)) << i;
    EXPECT_LT(spread(i, i), 2.5 * stated(i, i)) << i;
  }
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
