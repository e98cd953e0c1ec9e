#include "flirt/registration/local_map.hpp"

#include "flirt/registration/surface_alignment.hpp"
#include "flirt/registration/window_search.hpp"

#include "tests/registration/rooms.hpp"

#include <Eigen/LU>
#include <gmock/gmock.h>

#include <numbers>

namespace flirt {
namespace {

struct Placed {
  SurfacePoints points;
  Pose2 pose;
};

std::vector<Placed> walked(const Pose2& map_from_room) {
  const auto walls = rooms::moved(rooms::asymmetric_room(), map_from_room);
  Rng rng(3);
  std::vector<Placed> placed;
  for (const Pose2& pose : rooms::walk(map_from_room)) {
    placed.push_back({surface_points(rooms::scan_of(walls, pose, 2 * std::numbers::pi, &rng, 0.01)), pose});
  }
  return placed;
}

LocalMap map_of(const std::vector<Placed>& scans) {
  LocalMap map;
  for (const Placed& scan : scans) { map.add(scan.points, scan.pose); }
  return map;
}

/// Number of cells of a box around the room in which the maps differ, in evidence, search values or lines.
int differences(const LocalMap& a, const LocalMap& b, const Pose2& map_from_room) {
  const Point2 middle = map_from_room * Point2{4, 3};
  int count = 0;
  for (std::int32_t v = -80; v <= 80; ++v) {
    for (std::int32_t u = -80; u <= 80; ++u) {
      const auto x = static_cast<std::int32_t>(middle.x / LocalMap::cell_size) + u;
      const auto y = static_cast<std::int32_t>(middle.y / LocalMap::cell_size) + v;
      const Point2 at{(x + 0.5) * LocalMap::cell_size, (y + 0.5) * LocalMap::cell_size};
      const LinePiece* line_a = a.line_at(at);
      const LinePiece* line_b = b.line_at(at);
      const bool same_line = (line_a == nullptr) == (line_b == nullptr) &&
                             (line_a == nullptr || (line_a->x == line_b->x && line_a->normal_y == line_b->normal_y));
      const bool same = a.surface({x, y}) == b.surface({x, y}) && *a.row({x, y}) == *b.row({x, y}) &&
                        a.passes({2 * x, 2 * y}) == b.passes({2 * x, 2 * y}) && same_line;
      count += same ? 0 : 1;
    }
  }
  return count;
}

TEST(LocalMap, AfterScansCameAndWentEqualsOneBuiltFromThoseThatStayed) {
  for (const Pose2& map_from_room : {Pose2{0, 0, 0}, Pose2{-731.3, 50.9, 2.1}, Pose2{102.4, -0.05, 0.4}}) {
    const std::vector<Placed> scans = walked(map_from_room);
    LocalMap map;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      map.add(scans[i].points, scans[i].pose);
      static_cast<void>(map.agreement(std::span(&scans[i].points, 1), scans[i].pose));  // lines are asked for meanwhile
      if (i >= 5) { map.remove(scans[i - 5].points, scans[i - 5].pose); }
    }
    const LocalMap rebuilt = map_of({scans.end() - 5, scans.end()});
    EXPECT_EQ(map.scans(), 5U);
    EXPECT_EQ(differences(map, rebuilt, map_from_room), 0);
    EXPECT_GT(differences(map, map_of(scans), map_from_room), 1000);
  }
}

TEST(LocalMap, DoesNotGrowWhileItsScansMoveOn) {
  const std::vector<Placed> scans = walked({});
  LocalMap map;
  std::size_t early = 0;
  for (int step = 0; step < 40; ++step) {
    const Pose2 there{25.0 * step, -9.0 * step, 0};
    for (const Placed& scan : scans) { map.add(scan.points, there * scan.pose); }
    for (const Placed& scan : scans) { map.remove(scan.points, there * scan.pose); }
    if (step == 4) { early = map.bytes(); }
  }
  EXPECT_LE(map.bytes(), early + early / 4);
}

TEST(LocalMap, SearchValuesFallWithTheDistanceToTheNearestPoint) {
  const std::vector<Placed> scans = walked({});
  const LocalMap map = map_of(scans);
  const std::array<std::uint8_t, 9> by_squared_distance{15, 12, 10, 0, 6, 5, 0, 0, 3};
  for (std::int32_t y = -5; y < 70; ++y) {
    for (std::int32_t x = -5; x < 85; ++x) {
      std::uint8_t expected = 0;
      for (std::int32_t dy = -2; dy <= 2; ++dy) {
        for (std::int32_t dx = -2; dx <= 2; ++dx) {
          if (map.surface({x + dx, y + dy}).count == 0) { continue; }
          expected = std::max(expected, by_squared_distance[static_cast<std::size_t>(dx * dx + dy * dy)]);
        }
      }
      ASSERT_EQ(*map.row({x, y}), expected) << x << " " << y;
    }
  }
}

TEST(LocalMap, IsFreeWhereBeamsPassedAndNothingWasHit) {
  const std::vector<Placed> scans = walked({});
  const LocalMap map = map_of(scans);
  const Placed& scan = scans.front();
  const Point2 robot = scan.pose.translation();
  const Point2 hit = scan.pose * Point2{scan.points.x.front(), scan.points.y.front()};
  EXPECT_TRUE(map.is_free(robot + 0.5 * (hit - robot)));
  EXPECT_FALSE(map.is_free(hit));
  EXPECT_FALSE(map.is_free({50, 50}));
}

TEST(LocalMap, TellsTheRightPoseFromOneThroughAWall) {
  const std::vector<Placed> scans = walked({});
  const LocalMap map = map_of(scans);
  const std::span<const SurfacePoints> scan(&scans[4].points, 1);
  const Agreed right = map.agreement(scan, scans[4].pose);
  const Agreed wrong = map.agreement(scan, Pose2{0, 3.5, 0} * scans[4].pose);
  EXPECT_GT(right.likelihood, 0.9);
  EXPECT_LT(right.through, 0.05);
  EXPECT_GT(wrong.through, 0.2);
  EXPECT_LT(wrong.likelihood, 0.6);
}

TEST(SearchWindow, BestValueIsThatOfTryingEachPlaceOneByOne) {
  const std::vector<Placed> scans = walked({});
  const LocalMap map = map_of(scans);
  const Placed& query = scans[9];
  const SearchWindow window{.map_from_robot = query.pose * Pose2{0.13, -0.21, 0.07},
                            .half_extent = 0.4,
                            .half_turn = 0.14,
                            .heading_step = 0.035,
                            .most_points = 10000};
  const auto found = search_window(map, std::span(&query.points, 1), window);
  ASSERT_FALSE(found.empty());
  double best = 0;
  for (int heading = -4; heading <= 4; ++heading) {
    for (int y = -4; y <= 4; ++y) {
      for (int x = -4; x <= 4; ++x) {
        Pose2 pose = window.map_from_robot;
        pose = {pose.x + 0.1 * x, pose.y + 0.1 * y, pose.theta + 0.035 * heading};
        double sum = 0;
        for (std::size_t i = 0; i < query.points.size(); ++i) {
          const Point2 at = pose * Point2{query.points.x[i], query.points.y[i]};
          sum += *map.row(
              {static_cast<std::int32_t>(std::floor(at.x / 0.1)), static_cast<std::int32_t>(std::floor(at.y / 0.1))});
        }
        best = std::max(best, sum / (15.0 * static_cast<double>(query.points.size())));
      }
    }
  }
  EXPECT_NEAR(found.front().value, best, 0.005);  // a point on the boundary of a cell may fall to either side
}

TEST(AlignToMap, ComesBackFromAShiftedPose) {
  const std::vector<Placed> scans = walked({});
  const LocalMap map = map_of(scans);
  const Placed& query = scans[7];
  const Pose2 start = query.pose * Pose2{0.08, -0.06, 0.03};
  const AlignedPose aligned =
      align_to_map(map, std::span(&query.points, 1), start, {start, Eigen::Matrix3d::Identity()});
  EXPECT_LT(distance(aligned.map_from_robot, query.pose), 0.01);
  EXPECT_LT(heading_difference(aligned.map_from_robot, query.pose), radians_from_degrees(0.3));
}

TEST(AlignmentTerms, OfTwoScansPointBackToTheirTrueMotion) {
  const std::vector<Placed> scans = walked({});
  const Placed& reference = scans[6];
  const Placed& query = scans[8];
  const Pose2 truth = inverse(reference.pose) * query.pose;
  Pose2 pose = truth * Pose2{0.03, -0.04, 0.02};
  for (int i = 0; i < 6; ++i) {
    const AlignmentTerms terms = alignment_terms(reference.points, query.points, pose, 0.1);
    ASSERT_GT(terms.pairs, 50U);
    pose = stepped(pose, -terms.information.inverse() * terms.gradient);
  }
  EXPECT_LT(distance(pose, truth), 0.01);
  EXPECT_LT(heading_difference(pose, truth), radians_from_degrees(0.3));
}

TEST(SurfacePoints, HaveNormalsTowardsTheSensorAndAscendingBearings) {
  Scan scan = rooms::scan_of(rooms::asymmetric_room(), {4, 3, 0.4}, 2 * std::numbers::pi);
  scan.robot_from_sensor = {0.3, 0.1, 1.2};
  const SurfacePoints points = surface_points(scan);
  ASSERT_GT(points.size(), 100U);
  std::size_t with_normal = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) { EXPECT_LE(points.bearing[i - 1], points.bearing[i]); }
    const Point2 ray = Point2{points.x[i], points.y[i]} - points.origin;
    const Point2 normal{points.normal_x[i], points.normal_y[i]};
    with_normal += normal == Point2{} ? 0 : 1;
    EXPECT_LE(dot(ray, normal), 0.0);
  }
  EXPECT_GT(with_normal, points.size() / 2);
}

/// Ranges of 180 beams, a degree apart, down a corridor of 2.4 m.
Scan down_a_corridor() {
  Scan scan;
  scan.beams = {radians_from_degrees(-90), radians_from_degrees(1), 0.05, 80};
  for (int degree = -90; degree < 90; ++degree) {
    const double across = std::abs(std::sin(radians_from_degrees(degree)));
    scan.ranges.push_back(across > 0.05 ? 1.2 / across : 100.0);
  }
  return scan;
}

TEST(SurfacePoints, OfAWallAtAGrazingAngleHaveItsNormal) {
  const SurfacePoints points = surface_points(down_a_corridor());
  std::size_t far = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points.x[i] > 6) { continue; }  // there the next point is more than a metre away
    EXPECT_GT(std::abs(points.normal_y[i]), 0.999) << points.x[i];
    far += points.x[i] > 4 ? 1 : 0;
  }
  EXPECT_GE(far, 6U);
}

TEST(SurfacePoints, LonePointsHaveNoNormal) {
  Scan scan = down_a_corridor();
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) { scan.ranges[i] = i % 2 == 0 ? 6 : 5.5; }
  const SurfacePoints points = surface_points(scan);
  ASSERT_GT(points.size(), 100U);
  for (std::size_t i = 0; i < points.size(); ++i) { EXPECT_EQ(points.normal_x[i], 0) << i; }
}

}  // namespace
}  // namespace flirt
