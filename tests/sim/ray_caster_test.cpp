#include "flirt/sim/ray_caster.hpp"

#include "flirt/core/rng.hpp"
#include "flirt/sim/office.hpp"

#include "tests/support/numbers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

FloorPlan room(double width, double height) {
  return {{{{0, 0}, {width, 0}}, {{width, 0}, {width, height}}, {{width, height}, {0, height}}, {{0, height}, {0, 0}}},
          {},
          {}};
}

/// Independent of the caster: parameters of the crossing by Cramer's rule, every surface tried.
double brute_force(const FloorPlan& plan, Point2 origin, double angle, double max_range) {
  const Point2 d{std::cos(angle), std::sin(angle)};
  double nearest = max_range;
  for (const PlanSegment& s : plan.segments) {
    // origin + t d = begin + u (end - begin)
    const double a = d.x;
    const double b = s.begin.x - s.end.x;
    const double c = d.y;
    const double e = s.begin.y - s.end.y;
    const double det = a * e - b * c;
    if (det == 0) { continue; }
    const double rx = s.begin.x - origin.x;
    const double ry = s.begin.y - origin.y;
    const double t = (rx * e - b * ry) / det;
    const double u = (a * ry - c * rx) / det;
    if (t >= 0 && u >= 0 && u <= 1) { nearest = std::min(nearest, t); }
  }
  for (const PlanDisc& disc : plan.discs) {
    const Point2 f = origin - disc.center;
    const double half_b = f.x * d.x + f.y * d.y;
    const double c = f.x * f.x + f.y * f.y - disc.radius * disc.radius;
    if (c <= 0) { return 0; }
    if (half_b * half_b - c < 0) { continue; }
    const double t = -half_b - std::sqrt(half_b * half_b - c);
    if (t >= 0) { nearest = std::min(nearest, t); }
  }
  return nearest;
}

FloorPlan random_plan(Rng& rng, int segments, int discs) {
  FloorPlan plan;
  for (int i = 0; i < segments; ++i) {
    const Point2 begin{rng.uniform(-20, 20), rng.uniform(-20, 20)};
    const double length = rng.uniform() < 0.1 ? 30 : 3;
    plan.segments.push_back({begin, begin + Point2{rng.uniform(-length, length), rng.uniform(-length, length)}});
  }
  for (int i = 0; i < discs; ++i) {
    plan.discs.push_back({{rng.uniform(-20, 20), rng.uniform(-20, 20)}, rng.uniform(0.01, 1)});
  }
  return plan;
}

TEST(RayCaster, MeasuresARoomExactlyInAllDirections) {
  const RayCaster caster(room(6, 4));
  const Point2 origin{2, 1};
  for (int i = 0; i < 3600; ++i) {
    const double angle = i * pi / 1800;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const double to_x = c > 0 ? 4 / c : c < 0 ? -2 / c : infinity;
    const double to_y = s > 0 ? 3 / s : s < 0 ? -1 / s : infinity;
    EXPECT_NEAR(caster.cast(origin, angle, 100), std::min(to_x, to_y), 1e-9) << i;
  }
}

TEST(RayCaster, DoesNotLeakThroughCorners) {
  const RayCaster caster(room(6, 4));
  Rng rng(1);
  for (int i = 0; i < 2000; ++i) {
    const Point2 origin{rng.uniform(0.01, 5.99), rng.uniform(0.01, 3.99)};
    for (const Point2 corner : {Point2{0, 0}, Point2{6, 0}, Point2{6, 4}, Point2{0, 4}}) {
      const Point2 way = corner - origin;
      EXPECT_NEAR(caster.cast(origin, std::atan2(way.y, way.x), 100), norm(way), 1e-7);
    }
  }
}

TEST(RayCaster, MeasuresADiscExactly) {
  const RayCaster caster({{}, {{{3, 0}, 1}}, {}});
  EXPECT_NEAR(caster.cast({0, 0}, 0, 100), 2, 1e-12);
  EXPECT_NEAR(caster.cast({3, 5}, -pi / 2, 100), 4, 1e-12);
  const double angle = std::asin(0.5 / 3);  // passes the centre at half the radius
  EXPECT_NEAR(caster.cast({0, 0}, angle, 100), 3 * std::cos(angle) - std::sqrt(0.75), 1e-12);
  EXPECT_EQ(caster.cast({0, 0}, std::asin(1.001 / 3), 100), 100);
  EXPECT_EQ(caster.cast({0, 0}, pi, 100), 100) << "behind";
}

TEST(RayCaster, RayAlongAWallMeetsItsNearerEnd) {
  const RayCaster caster({{{{2, 0}, {5, 0}}, {{0, 7}, {0, 3}}, {{1, 1}, {3, 3}}}, {}, {}});
  EXPECT_NEAR(caster.cast({0, 0}, 0, 100), 2, 1e-12);
  EXPECT_NEAR(caster.cast({9, 0}, pi, 100), 4, 1e-12);
  EXPECT_NEAR(caster.cast({0, 0}, pi / 2, 100), 3, 1e-12);
  EXPECT_NEAR(caster.cast({0, 0}, pi / 4, 100), std::sqrt(2.0), 1e-9);
  EXPECT_EQ(caster.cast({0, 1e-6}, 0, 100), 100) << "beside the wall";
}

TEST(RayCaster, StartOnOrInsideSomethingSolidIsRangeZero) {
  FloorPlan plan = room(6, 4);
  plan.discs.push_back({{2, 2}, 0.5});
  const RayCaster caster(plan);
  for (int i = 0; i < 16; ++i) {
    EXPECT_EQ(caster.cast({2.2, 2.1}, i * pi / 8, 100), 0);
    EXPECT_NEAR(caster.cast({3, 0}, i * pi / 8, 100), 0, 1e-9);
  }
}

TEST(RayCaster, SeesNothingInAnEmptyPlanOrBeyondTheLimit) {
  EXPECT_EQ(RayCaster(FloorPlan{}).cast({0, 0}, 1, 12), 12);
  const RayCaster caster(room(6, 4));
  EXPECT_EQ(caster.cast({1, 1}, 0, 4.9), 4.9);
  EXPECT_NEAR(caster.cast({1, 1}, 0, 5.1), 5, 1e-12);
  EXPECT_EQ(caster.cast({-5, 1}, pi, 50), 50) << "away from the plan";
  EXPECT_NEAR(caster.cast({-5, 1}, 0, 50), 5, 1e-12) << "from outside of the plan";
}

TEST(RayCaster, EqualsTryingEverySurface) {
  Rng rng(7);
  for (const int segments : {1, 3, 30, 1000}) {
    const FloorPlan plan = random_plan(rng, segments, segments / 3);
    const RayCaster caster(plan);
    for (int i = 0; i < 5000; ++i) {
      const Point2 origin{rng.uniform(-25, 25), rng.uniform(-25, 25)};
      const double angle = rng.uniform(-pi, pi);
      ASSERT_NEAR(caster.cast(origin, angle, 60), brute_force(plan, origin, angle, 60), 1e-9) << segments << " " << i;
    }
  }
}

TEST(RayCaster, EqualsTryingEverySurfaceInAnOffice) {
  Rng rng(8);
  const FloorPlan plan = make_office({.area = 1500}).plan;
  const Rectangle box = bounds(plan);
  const RayCaster caster(plan);
  for (int i = 0; i < 4000; ++i) {
    const Point2 origin{rng.uniform(0, box.high.x), rng.uniform(0, box.high.y)};
    const double angle = i % 4 == 0 ? i / 4 % 8 * pi / 4 : rng.uniform(-pi, pi);
    ASSERT_NEAR(caster.cast(origin, angle, 60), brute_force(plan, origin, angle, 60), 1e-8) << i;
  }
}

TEST(RayCaster, TellsMaterialAndIncidence) {
  const RayCaster caster({{{{2, -5}, {2, 5}, Material::glass}, {{4, -5}, {4, 5}}}, {}, {}});
  const auto glass = caster.first_hit({0, 0}, {0.8, 0.6}, 0, 100);
  ASSERT_TRUE(glass);
  EXPECT_EQ(glass->material, Material::glass);
  EXPECT_NEAR(glass->range, 2.5, 1e-12);
  EXPECT_NEAR(glass->cosine, 0.8, 1e-12);
  const auto behind = caster.first_hit({0, 0}, {0.8, 0.6}, glass->range + 1e-6, 100);
  ASSERT_TRUE(behind);
  EXPECT_EQ(behind->material, Material::solid);
  EXPECT_NEAR(behind->range, 5, 1e-12);
}

/// A plan of squares for pixels must give the same ranges as the image.
TEST(RayCaster, ImageEqualsTheSidesOfItsPixels) {
  Rng rng(3);
  const PixelPlan image{{-1.5, 2.0, 0.4}, 0.25, 40, 30, [&] {
                          std::vector<CellState> pixels;
                          for (int i = 0; i < 1200; ++i) {
                            pixels.push_back(rng.uniform() < 0.06  ? CellState::occupied
                                             : rng.uniform() < 0.5 ? CellState::free
                                                                   : CellState::unknown);
                          }
                          return pixels;
                        }()};
  FloorPlan squares;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (image.pixels[i] != CellState::occupied) { continue; }
    const double x = static_cast<double>(i % 40) * 0.25;
    const double y = static_cast<double>(i / 40) * 0.25;
    const Point2 corners[4] = {{x, y}, {x + 0.25, y}, {x + 0.25, y + 0.25}, {x, y + 0.25}};
    for (int k = 0; k < 4; ++k) {
      squares.segments.push_back({image.map_from_image * corners[k], image.map_from_image * corners[(k + 1) % 4]});
    }
  }
  const RayCaster caster({{}, {}, image});
  int tested = 0;
  for (int i = 0; i < 20000; ++i) {
    const Point2 in_image{rng.uniform(-2, 12), rng.uniform(-2, 9)};
    const Point2 origin = image.map_from_image * in_image;
    const double angle = rng.uniform(-pi, pi);
    const double range = caster.cast(origin, angle, 30);
    if (range == 0) { continue; }  // within a pixel
    ++tested;
    ASSERT_NEAR(range, brute_force(squares, origin, angle, 30), 1e-9) << i;
  }
  EXPECT_GT(tested, 15000);
}

TEST(RayCaster, StartInAnOccupiedPixelIsRangeZero) {
  const PixelPlan image{{}, 1.0, 3, 1, {CellState::free, CellState::occupied, CellState::free}};
  const RayCaster caster({{}, {}, image});
  EXPECT_EQ(caster.cast({1.5, 0.5}, 1, 10), 0);
  EXPECT_NEAR(caster.cast({0.25, 0.5}, 0, 10), 0.75, 1e-12);
  EXPECT_NEAR(caster.cast({2.5, 0.5}, pi, 10), 0.5, 1e-12);
}

TEST(RayCaster, WholeScanIsItsBeams) {
  const FloorPlan plan = make_office({.area = 800}).plan;
  const RayCaster caster(plan);
  const Beams beams{-2, 0.01, 0.1, 30};
  const Pose2 map_from_sensor{7, 6.1, 0.7};
  const std::vector<double> ranges = caster.cast(map_from_sensor, beams, 400);
  ASSERT_EQ(ranges.size(), 400U);
  for (std::size_t i = 0; i < 400; ++i) { EXPECT_EQ(ranges[i], caster.cast({7, 6.1}, 0.7 + beams.angle(i), 30)); }
}

}  // namespace
}  // namespace flirt
