#include "flirt/sim/lidar.hpp"

#include "flirt/sim/office.hpp"

#include "tests/support/numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

LidarParams perfect() {
  return {.noise = 0, .noise_per_metre = 0, .resolution = 0, .dropouts = 0, .mixed_pixels = 0};
}

FloorPlan wall_at(double x, Material material = Material::solid) {
  return {{{{x, -1000}, {x, 1000}, material}}, {}, {}};
}

std::vector<double> measure(const LidarParams& params, const FloorPlan& plan, const Pose2& map_from_sensor = {},
                            std::vector<PlanDisc> moving = {}, std::uint64_t seed = 1) {
  Rng rng(seed);
  return Lidar(params).measure(RayCaster(plan), moving, map_from_sensor, rng);
}

struct Statistics {
  double mean;
  double deviation;
};
Statistics statistics(const std::vector<double>& values) {
  double sum = 0;
  double squares = 0;
  for (const double value : values) { sum += value; }
  const double mean = sum / static_cast<double>(values.size());
  for (const double value : values) { squares += (value - mean) * (value - mean); }
  return {mean, std::sqrt(squares / static_cast<double>(values.size() - 1))};
}

TEST(Lidar, PerfectScannerMeasuresWhatTheCasterSees) {
  const FloorPlan plan = make_office({.area = 800, .glass_fronts = 0}).plan;
  const RayCaster caster(plan);
  const Pose2 map_from_sensor{9, 6, 2.5};
  for (const std::uint32_t beams : {1U, 2U, 180U, 361U, 1081U, 8000U}) {
    for (const double field_of_view : {0.5, pi, 2 * pi}) {
      for (const BeamOrder order : {BeamOrder::counter_clockwise, BeamOrder::clockwise}) {
        LidarParams params = perfect();
        params.beams = beams;
        params.field_of_view = field_of_view;
        params.beam_order = order;
        const Lidar lidar(params);
        const std::vector<double> ranges = measure(params, plan, map_from_sensor);
        const std::vector<double> expected = caster.cast(map_from_sensor, lidar.beams(), beams);
        ASSERT_EQ(ranges.size(), beams);
        EXPECT_EQ(lidar.beams().angle_step < 0, order == BeamOrder::clockwise);
        for (std::size_t i = 0; i < beams; ++i) { ASSERT_NEAR(ranges[i], expected[i], 1e-7) << beams << " " << i; }
      }
    }
  }
}

TEST(Lidar, FullTurnIsOne) {
  LidarParams params = perfect();
  params.beams = 720;
  params.field_of_view = 2 * pi;
  const Lidar lidar(params);
  Scan scan;
  scan.beams = lidar.beams();
  scan.ranges.resize(720);
  EXPECT_TRUE(is_full_turn(scan));
}

TEST(Lidar, DefaultBeamsAreThoseOfASickAtHalfADegree) {
  const Beams beams = Lidar(LidarParams{}).beams();
  EXPECT_NEAR(beams.angle(0), -pi / 2, 1e-12);
  EXPECT_NEAR(beams.angle(359), radians_from_degrees(89.5), 1e-12);
}

TEST(Lidar, NoiseGrowsWithDistance) {
  LidarParams params = perfect();
  params.beams = 20000;
  params.field_of_view = 1e-6;
  params.noise = 0.01;
  params.noise_per_metre = 0.002;
  for (const double distance : {1.0, 20.0}) {
    const Statistics found = statistics(measure(params, wall_at(distance)));
    const double deviation = 0.01 + 0.002 * distance;
    EXPECT_NEAR(found.mean, distance, 4 * deviation / std::sqrt(20000.0));
    EXPECT_NEAR(found.deviation, deviation, 0.03 * deviation);
  }
}

TEST(Lidar, DropoutsAreNoReturnsOfTheGivenShare) {
  LidarParams params = perfect();
  params.beams = 20000;
  params.field_of_view = 1.0;
  params.dropouts = 0.05;
  const std::vector<double> ranges = measure(params, wall_at(3));
  const auto lost = std::count(ranges.begin(), ranges.end(), params.range_max);
  EXPECT_NEAR(static_cast<double>(lost) / 20000, 0.05, 4 * std::sqrt(0.05 * 0.95 / 20000));
}

TEST(Lidar, ReadingsAreMultiplesOfTheResolution) {
  LidarParams params;
  params.resolution = 0.05;
  params.mixed_pixels = 0;
  for (const double range : measure(params, wall_at(3))) { EXPECT_NEAR(range, std::round(range / 0.05) * 0.05, 1e-12); }
}

TEST(Lidar, ReadingsBeyondTheLimitsSaySo) {
  LidarParams params = perfect();
  params.range_min = 0.5;
  params.range_max = 8;
  const Beams beams = Lidar(params).beams();
  for (const double range : measure(params, wall_at(9))) { EXPECT_EQ(classify(range, beams), Reading::no_return); }
  params.field_of_view = 0.1;
  for (const double range : measure(params, wall_at(0.3))) { EXPECT_EQ(classify(range, beams), Reading::invalid); }
  for (const double range : measure(params, wall_at(0.0))) { EXPECT_EQ(classify(range, beams), Reading::invalid); }
}

TEST(Lidar, MostBeamsPassGlassAndSomeReturn) {
  LidarParams params = perfect();
  params.beams = 20000;
  params.field_of_view = 1.0;
  params.glass_returns = 0.15;
  params.glass_glare = 0;
  FloorPlan plan = wall_at(3, Material::glass);
  plan.segments.push_back({{6, -1000}, {6, 1000}, Material::solid});
  const std::vector<double> ranges = measure(params, plan);
  const double first = Lidar(params).beams().angle_min;
  int from_glass = 0;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double depth = ranges[i] * std::cos(first + static_cast<double>(i) * 1.0 / 20000);
    const bool is_glass = std::abs(depth - 3) < 1e-6;
    EXPECT_TRUE(is_glass || std::abs(depth - 6) < 1e-6) << depth;
    from_glass += is_glass ? 1 : 0;
  }
  EXPECT_NEAR(from_glass / 20000.0, 0.15, 4 * std::sqrt(0.15 * 0.85 / 20000));
}

TEST(Lidar, GlassGlaresWhenHitSquarely) {
  LidarParams params = perfect();
  params.beams = 200;
  params.field_of_view = 0.15;
  params.glass_returns = 0;
  params.glass_glare = 0.09;
  for (const double range : measure(params, wall_at(3, Material::glass))) { EXPECT_NEAR(range, 3, 0.02); }
  for (const double range : measure(params, wall_at(3, Material::glass), {0, 0, 0.5})) { EXPECT_EQ(range, 30); }
}

TEST(Lidar, MovingDiscsHideWhatIsBehind) {
  for (const BeamOrder order : {BeamOrder::counter_clockwise, BeamOrder::clockwise}) {
    for (const double heading : {0.0, 1.0, 3.1, -2.0}) {
      LidarParams params = perfect();
      params.beams = 720;
      params.field_of_view = 2 * pi;
      params.beam_order = order;
      const Pose2 map_from_sensor{0.3, -0.2, heading};
      const FloorPlan walls{{{{5, -5}, {5, 5}}, {{-5, -5}, {-5, 5}}, {{-5, 5}, {5, 5}}, {{-5, -5}, {5, -5}}}, {}, {}};
      const std::vector<PlanDisc> moving{{{2, 0.13}, 0.3}, {{-3, 1}, 0.2}, {{9, 0}, 0.5}};
      FloorPlan all = walls;
      all.discs = moving;
      const std::vector<double> as_moving = measure(params, walls, map_from_sensor, moving);
      const std::vector<double> as_plan = measure(params, all, map_from_sensor);
      for (std::size_t i = 0; i < 720; ++i) { ASSERT_NEAR(as_moving[i], as_plan[i], 1e-9) << i << " " << heading; }
    }
  }
}

TEST(Lidar, ScannerWithinAMovingDiscReadsTooNear) {
  LidarParams params = perfect();
  const Beams beams = Lidar(params).beams();
  for (const double range : measure(params, wall_at(3), {}, {{{0.1, 0}, 0.2}})) {
    EXPECT_EQ(classify(range, beams), Reading::invalid);
  }
}

TEST(Lidar, MixedPixelsLieBetweenTheSurfacesAtAnEdge) {
  LidarParams params = perfect();
  params.mixed_pixels = 1;
  FloorPlan plan = wall_at(6);
  plan.segments.push_back({{2, -50}, {2, 0.001}, Material::solid});
  const std::vector<double> mixed = measure(params, plan);
  params.mixed_pixels = 0;
  const std::vector<double> clean = measure(params, plan);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < 360; ++i) {
    if (mixed[i] == clean[i]) { continue; }
    ++changed;
    EXPECT_TRUE(i == 180 || i == 181) << i;
    EXPECT_GT(mixed[i], 2.0);
    EXPECT_LT(mixed[i], 6.01);
  }
  EXPECT_EQ(changed, 1U);
}

TEST(Lidar, MixesEitherBeamBesideAnEdgeEquallyOften) {
  LidarParams params = perfect();
  params.mixed_pixels = 1;
  FloorPlan plan = wall_at(6);
  plan.segments.push_back({{2, -50}, {2, 0.001}, Material::solid});
  const double before = measure(perfect(), plan)[180];
  int first = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    first += measure(params, plan, {}, {}, seed)[180] != before ? 1 : 0;
  }
  EXPECT_NEAR(first, 100, 30);
}

TEST(Lidar, AWallAtAGrazingAngleIsNoEdge) {
  LidarParams params = perfect();
  const FloorPlan corridor{
      .segments = {{{-100, 1}, {100, 1}, Material::solid}, {{-100, -1}, {100, -1}, Material::solid}}};
  const std::vector<double> clean = measure(params, corridor);
  params.mixed_pixels = 1;
  EXPECT_EQ(measure(params, corridor), clean);
}

TEST(Lidar, EqualSeedsGiveEqualScansAndOthersDoNot) {
  const FloorPlan plan = make_office({.area = 800}).plan;
  EXPECT_EQ(measure({}, plan, {9, 6, 0}, {}, 5), measure({}, plan, {9, 6, 0}, {}, 5));
  EXPECT_NE(measure({}, plan, {9, 6, 0}, {}, 5), measure({}, plan, {9, 6, 0}, {}, 6));
}

TEST(Lidar, ParametersNameTheFieldThatIsOutOfRange) {
  EXPECT_EQ(out_of_range(LidarParams{}), "");
  EXPECT_THAT(out_of_range(LidarParams{.beams = 0}), testing::HasSubstr("beams"));
  EXPECT_THAT(out_of_range(LidarParams{.dropouts = 1.5}), testing::HasSubstr("dropouts"));
}

}  // namespace
}  // namespace flirt
