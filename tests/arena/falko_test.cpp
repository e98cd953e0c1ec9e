#include "flirt/arena/falko.hpp"

#include "tests/arena/corners.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <utility>

namespace flirt {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::uint32_t> beams_of(const std::vector<Keypoint>& keypoints) {
  std::vector<std::uint32_t> beams;
  for (const Keypoint& keypoint : keypoints) { beams.push_back(keypoint.beam); }
  return beams;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> raw_scores(const Scan& scan, const FalkoParams& params) {
  const PolarScan polar = polar_scan(scan, params.limits);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> scores;
  for (const FalkoCandidate& candidate : falko_candidates(polar, params)) {
    scores.emplace_back(polar.beams[candidate.element], candidate.raw);
  }
  return scores;
}

Scan turned(Scan scan) {
  scan.beams.angle_min += 1.3;
  return scan;
}

TEST(Falko, FindsACornerOnceAndDirectedIntoItsOpening) {
  const Scan scan = corner_scan(50);
  EXPECT_THAT(raw_scores(scan, {}), ElementsAre(std::pair(179, 10), std::pair(180, 0), std::pair(181, 10)));
  const std::vector<Keypoint> found = detect_falko(scan);
  ASSERT_THAT(beams_of(found), ElementsAre(180));
  EXPECT_NEAR(found[0].sensor_from_keypoint.x, 3, 1e-9);
  EXPECT_NEAR(found[0].sensor_from_keypoint.y, 0, 1e-9);
  EXPECT_NEAR(std::abs(found[0].sensor_from_keypoint.theta), std::numbers::pi, 1e-6);
  EXPECT_NEAR(found[0].support_radius, 0.123368, 1e-6);
}

TEST(Falko, FindsNothingOnAStraightWall) {
  for (const FalkoParams& params : {FalkoParams{}, tuned_falko(), sparse_falko()}) {
    EXPECT_THAT(raw_scores(wall_scan(), params), IsEmpty());
    EXPECT_THAT(detect_falko(wall_scan(), params), IsEmpty());
  }
}

TEST(Falko, SeesBluntCornersWhenTuned) {
  EXPECT_THAT(raw_scores(corner_scan(70), {}), IsEmpty());
  EXPECT_THAT(beams_of(detect_falko(corner_scan(70), tuned_falko())), ElementsAre(180));
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> scores = raw_scores(corner_scan(50), tuned_falko());
  const std::vector<std::uint32_t> expected{26, 28, 38, 38, 42, 29, 0, 29, 42, 38, 38, 28, 26};
  ASSERT_EQ(scores.size(), expected.size());
  for (std::uint32_t i = 0; i < expected.size(); ++i) { EXPECT_EQ(scores[i], std::pair(174 + i, expected[i])); }
}

TEST(Falko, IsTheSameWhicheverWayTheScanFaces) {
  for (const FalkoParams& params : {FalkoParams{}, tuned_falko()}) {
    EXPECT_EQ(raw_scores(turned(corner_scan(50)), params), raw_scores(corner_scan(50), params));
  }
  const std::vector<Keypoint> found = detect_falko(turned(corner_scan(50)));
  ASSERT_THAT(beams_of(found), ElementsAre(180));
  EXPECT_NEAR(wrap_angle(found[0].sensor_from_keypoint.theta - std::numbers::pi - 1.3), 0, 1e-6);
}

TEST(Falko, PlacesCornersBetweenBeams) {
  const Scan scan = corner_scan(50, -89.75, 360);
  EXPECT_THAT(raw_scores(scan, {}), ElementsAre(std::pair(179, 3), std::pair(180, 3)));
  EXPECT_THAT(detect_falko(scan), IsEmpty());
  const std::vector<Keypoint> found = detect_falko(scan, tuned_falko());
  ASSERT_THAT(beams_of(found), ElementsAre(173, 179, 185));
  const std::vector<Point2> expected{{2.90806, -0.10957}, {2.99586, -0.00494}, {2.92687, 0.08715}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found[i].sensor_from_keypoint.x, expected[i].x, 1e-4);
    EXPECT_NEAR(found[i].sensor_from_keypoint.y, expected[i].y, 1e-4);
  }
}

TEST(Falko, HasNoSeamInAFullTurn) {
  const Scan full = scan_of(corner({-3, 0}, 50), {}, half_degree_beams(-180), 720);
  const std::vector<Keypoint> found = detect_falko(full);
  ASSERT_THAT(beams_of(found), ElementsAre(0));
  EXPECT_NEAR(found[0].sensor_from_keypoint.theta, 0, 1e-6);
  Scan open = full;
  open.ranges.pop_back();
  EXPECT_THAT(detect_falko(open), IsEmpty());
}

TEST(Falko, FindsTheSamePointsWithAScannerThatTurnsClockwise) {
  Scan clockwise = corner_scan(50);
  clockwise.beams.angle_min = clockwise.beams.angle(360);
  clockwise.beams.angle_step = -clockwise.beams.angle_step;
  std::ranges::reverse(clockwise.ranges);
  const std::vector<Keypoint> found = detect_falko(clockwise);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(distance(found[0].sensor_from_keypoint, detect_falko(corner_scan(50))[0].sensor_from_keypoint), 0, 1e-9);
}

TEST(Falko, SkipsReadingsThatAreNoReturns) {
  for (const double reading :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 0.0}) {
    Scan scan = corner_scan(50);
    for (std::size_t i = 0; i <= 40; ++i) { scan.ranges[i] = reading; }
    EXPECT_EQ(detect_falko(scan), detect_falko(corner_scan(50)));
    for (double& range : scan.ranges) { range = reading; }
    EXPECT_THAT(detect_falko(scan), IsEmpty());
  }
  EXPECT_THAT(detect_falko(Scan{}), IsEmpty());
  EXPECT_THAT(detect_falko(corner_scan(50, 0, 1)), IsEmpty());
}

}  // namespace
}  // namespace flirt
