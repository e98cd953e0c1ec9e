#include "flirt/registration/dense_search.hpp"

#include "rooms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace flirt {
namespace {

/// Best mean value of each tile of 4 × 4 cells and `headings_per_tile` headings, by the plain loops.
std::vector<float> by_plain_loops(const MapFields& fields, const ScanPoints& points, const DenseSearchParams& params) {
  const CoarseField& coarse = *fields.coarse.at(0);
  const int headings = static_cast<int>(std::lround(2 * std::numbers::pi / params.heading_step));
  std::map<std::tuple<int, int, int>, int> best;
  for (int heading = 0; heading < headings; ++heading) {
    const double c = std::cos(heading * 2 * std::numbers::pi / headings) / coarse.cell_size;
    const double s = std::sin(heading * 2 * std::numbers::pi / headings) / coarse.cell_size;
    for (int y = 0; y < coarse.height; ++y) {
      for (int x = 0; x < coarse.width; ++x) {
        if (coarse.standable.at(x, y) == 0) { continue; }
        int sum = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
          const auto u = x + static_cast<int>(std::lround(c * points.x[i] - s * points.y[i]));
          const auto v = y + static_cast<int>(std::lround(s * points.x[i] + c * points.y[i]));
          sum += coarse.value(u, v);
        }
        int& tile = best[{heading / static_cast<int>(params.headings_per_tile), y / 4, x / 4}];
        tile = std::max(tile, sum);
      }
    }
  }
  std::vector<float> values;
  for (const auto& [tile, sum] : best) {
    values.push_back(static_cast<float>(sum * (1.0 / (static_cast<double>(points.size()) * coarse.largest))));
  }
  std::ranges::sort(values, std::greater{});
  return values;
}

TEST(DenseSearch, EqualsPlainLoops) {
  const auto walls = rooms::asymmetric_room();
  const MapFields fields = map_fields(rooms::evidence_of(walls, rooms::walk({})));
  ScanPoints points = scan_points(rooms::scan_of(walls, {3.1, 3.3, 0.4}, std::numbers::pi));
  // A point so far away that its shift leaves the map on every side.
  points.x.push_back(40);
  points.y.push_back(-3);
  points.range.push_back(40.1F);
  ASSERT_LE(points.size(), 250U);
  const DenseSearchParams params{.heading_step = radians_from_degrees(10), .largest_point_count = 250};
  const std::vector<CoarsePose> found = dense_search(fields, points, params);
  const std::vector<float> expected = by_plain_loops(fields, points, params);
  ASSERT_GT(found.size(), 100U);
  std::vector<float> values;
  for (const CoarsePose& pose : found) { values.push_back(pose.value); }
  ASSERT_LE(values.size(), expected.size());
  EXPECT_EQ(values,
            std::vector<float>(expected.begin(), expected.begin() + static_cast<std::ptrdiff_t>(values.size())));
}

TEST(DenseSearch, FindsTheSameWhereABlockOfALargeMapEnds) {
  // A room alone, and in a map that is cut in its middle. It is moved by whole tiles, and keeps off the box of its map.
  const auto walls = rooms::asymmetric_room();
  EvidenceGrid alone;
  EvidenceGrid large;
  large.count({0, 0}, {.hits = 1, .passes = 9});
  const double away = 126 * 3.2;
  for (const Pose2& pose : rooms::walk({1.63, 1.52, 0})) {
    const Scan scan = rooms::scan_of(rooms::moved(walls, {1.63, 1.52, 0}), pose, 6);
    alone.add(scan, pose);
    large.add(scan, {pose.x + away, pose.y, pose.theta});
  }
  const MapFields one = map_fields(alone);
  const MapFields several = map_fields(large);
  ASSERT_EQ(one.coarse.size(), 1U);
  ASSERT_EQ(several.coarse.size(), 2U);
  for (const auto& field : several.coarse) { EXPECT_GT(field->panels.size(), 1U); }
  const ScanPoints points = scan_points(rooms::scan_of(walls, {3.1, 3.3, 0.4}, std::numbers::pi));
  const std::vector<CoarsePose> expected = dense_search(one, points, {.candidates = 100});
  const std::vector<CoarsePose> found = dense_search(several, points, {.candidates = 100});
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].map_from_sensor.x, expected[i].map_from_sensor.x + away, 1e-9) << i;
    EXPECT_NEAR(found[i].map_from_sensor.y, expected[i].map_from_sensor.y, 1e-9) << i;
    EXPECT_EQ(found[i].map_from_sensor.theta, expected[i].map_from_sensor.theta) << i;
    EXPECT_EQ(found[i].value, expected[i].value) << i;
  }
}

TEST(DenseSearch, PutsATruePoseOnTheGridFirst) {
  const auto walls = rooms::asymmetric_room();
  const MapFields fields = map_fields(rooms::evidence_of(walls, rooms::walk({})));
  const double cell = fields.coarse.at(0)->cell_size;
  const Pose2 truth{fields.origin.x + 20.5 * cell, fields.origin.y + 18.5 * cell, radians_from_degrees(30)};
  const auto found = dense_search(fields, scan_points(rooms::scan_of(walls, truth, std::numbers::pi)));
  ASSERT_FALSE(found.empty());
  EXPECT_LE(distance(found[0].map_from_sensor, truth), 1.5 * cell);
  EXPECT_LE(heading_difference(found[0].map_from_sensor, truth), radians_from_degrees(3.01));
  EXPECT_TRUE(std::ranges::is_sorted(found, std::ranges::greater{}, [](const CoarsePose& pose) { return pose.value; }));
}

TEST(DenseSearchNear, FindsAroundAGivenPlaceWhatTheWholeSearchFinds) {
  const auto walls = rooms::asymmetric_room();
  const MapFields fields = map_fields(rooms::evidence_of(walls, rooms::walk({})));
  const Pose2 truth{3.1, 3.3, 0.4};
  const ScanPoints points = scan_points(rooms::scan_of(walls, truth, std::numbers::pi));
  const std::vector<CoarsePose> whole = dense_search(fields, points);
  const std::vector<Pose2> place{{truth.x + 0.3, truth.y - 0.3, truth.theta + 0.1}};
  const std::vector<CoarsePose> near = dense_search_near(fields, points, place);
  ASSERT_FALSE(near.empty());
  EXPECT_LT(near.size(), whole.size());
  EXPECT_EQ(near[0].map_from_sensor, whole[0].map_from_sensor);
  EXPECT_EQ(near[0].value, whole[0].value);
}

TEST(DenseSearchNear, PlacesOffTheMapAndNoPlacesFindNothing) {
  const auto walls = rooms::asymmetric_room();
  const MapFields fields = map_fields(rooms::evidence_of(walls, rooms::walk({})));
  const ScanPoints points = scan_points(rooms::scan_of(walls, {3, 3, 0}, std::numbers::pi));
  const std::vector<Pose2> far{{500, -300, 1}, {-80, 2, -3}};
  EXPECT_TRUE(dense_search_near(fields, points, far).empty());
  EXPECT_TRUE(dense_search_near(fields, points, {}).empty());
}

}  // namespace
}  // namespace flirt
