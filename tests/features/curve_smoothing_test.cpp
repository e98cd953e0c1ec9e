#include "flirt/features/curve_smoothing.hpp"

#include "flirt/core/pose2.hpp"
#include "flirt/core/rng.hpp"

#include "tests/support/numbers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace flirt {
namespace {

struct Curve {
  std::vector<double> x{};
  std::vector<double> y{};
  bool closed{false};

  void add(Point2 point) {
    x.push_back(point.x);
    y.push_back(point.y);
  }
  [[nodiscard]] Point2 at(std::size_t i) const { return {x[i], y[i]}; }
};

struct Smoothed {
  SmoothedCurve curve{};
  std::vector<double> response{};

  [[nodiscard]] Point2 at(std::size_t i) const { return {curve.x[i], curve.y[i]}; }
};

Smoothed smoothed(const Curve& curve, double t, double lost_mass = 1e-6) {
  Smoothed result;
  CurveSmoother smoother;
  AlignedVector<double> arc;
  const double length = arc_lengths(curve.x, curve.y, curve.closed, arc);
  smoother.set_curve(curve.x, curve.y, arc, curve.closed, length);
  smoother.smooth(t, gaussian_reach(lost_mass), result.curve);
  damped_displacement(curve.x, curve.y, result.curve, t, result.response);
  return result;
}

/// z of z e^−z on the rising branch, z ≤ 1.
double z_of(const Curve& curve, const Smoothed& result, std::size_t i, double t) {
  return 2.0 * norm(curve.at(i) - result.at(i)) / t;
}

/// A curve with uneven steps, about 0.02 to 0.2 m.
Curve wobbly(int count, std::uint64_t seed) {
  Rng rng(seed);
  Curve curve;
  double heading = 0.0;
  Point2 point{1.0, 2.0};
  for (int i = 0; i < count; ++i) {
    curve.add(point);
    heading += rng.normal(0.0, 0.5);
    point = point + rng.uniform(0.02, 0.2) * Point2{std::cos(heading), std::sin(heading)};
  }
  return curve;
}

/// The formulas of the papers, sum by sum: equations 2 to 6 of P1, 8 to 12 of P2.
Smoothed by_definition(const Curve& curve, double t, double reach) {
  const std::size_t n = curve.x.size();
  std::vector<double> arc(n, 0.0);
  for (std::size_t i = 1; i < n; ++i) { arc[i] = arc[i - 1] + norm(curve.at(i) - curve.at(i - 1)); }
  const double length = arc[n - 1] + norm(curve.at(0) - curve.at(n - 1));
  const auto kernel = [&](std::size_t i, std::size_t j) {
    double distance = std::abs(arc[i] - arc[j]);
    if (curve.closed) { distance = std::min(distance, length - distance); }
    return distance <= reach * t ? std::exp(-0.5 * distance * distance / (t * t)) : 0.0;
  };
  std::vector<double> density(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) { density[i] += kernel(i, j); }
  }
  Smoothed result;
  for (std::size_t i = 0; i < n; ++i) {
    Point2 sum{};
    double weight = 0.0;
    for (std::size_t j = 0; j < n; ++j) {
      const double normalised = kernel(i, j) / (density[i] * density[j]);
      sum = sum + normalised * curve.at(j);
      weight += normalised;
    }
    const Point2 mean = (1.0 / weight) * sum;
    result.curve.x.push_back(mean.x);
    result.curve.y.push_back(mean.y);
    const double z = 2.0 * norm(curve.at(i) - mean) / t;
    result.response.push_back(z * std::exp(-z));
  }
  return result;
}

// The smoother works in single precision, on offsets from point to point: two micrometres are far below a range's
// noise.
constexpr double rounded_point = 2e-6;     // m, for curves within some 30 m
constexpr double rounded_response = 2e-5;  // 1, at t = 0.05; at 0.2 a quarter of it

void expect_equal(const Smoothed& fast, const Smoothed& slow) {
  ASSERT_EQ(fast.curve.x.size(), slow.curve.x.size());
  for (std::size_t i = 0; i < slow.response.size(); ++i) {
    EXPECT_NEAR(fast.curve.x[i], slow.curve.x[i], rounded_point);
    EXPECT_NEAR(fast.curve.y[i], slow.curve.y[i], rounded_point);
    EXPECT_NEAR(fast.response[i], slow.response[i], rounded_response);
  }
}

TEST(GaussianReach, LeavesTheLostMassOutside) {
  EXPECT_NEAR(gaussian_reach(0.0026997960632601866), 3.0, 1e-9);
  EXPECT_NEAR(std::erfc(gaussian_reach(1e-6) / std::numbers::sqrt2), 1e-6, 1e-12);
  EXPECT_EQ(gaussian_reach(0.0), infinity);
}

TEST(CurveSmoother, EqualsTheDefinitionOnOpenCurves) {
  for (const int count :
       {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 100, 333}) {  // rows go by 4, points by 8
    const Curve curve = wobbly(count, 11);
    for (const double t : {0.05, 0.2, 0.768}) {
      for (const double lost_mass : {1e-6, 1e-2, 0.0}) {
        expect_equal(smoothed(curve, t, lost_mass), by_definition(curve, t, gaussian_reach(lost_mass)));
      }
    }
  }
}

TEST(CurveSmoother, EqualsTheDefinitionOnClosedCurves) {
  for (const int count : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 15, 100, 201}) {
    Curve curve = wobbly(count, 12);
    curve.closed = true;
    for (const double t : {0.05, 0.2, 0.768, 20.0}) {
      for (const double lost_mass : {1e-6, 0.0}) {
        expect_equal(smoothed(curve, t, lost_mass), by_definition(curve, t, gaussian_reach(lost_mass)));
      }
    }
  }
}

TEST(CurveSmoother, GivesTheSameOverListedGeodesicDistances) {
  const Curve curve = wobbly(150, 13);
  AlignedVector<double> arc;
  arc_lengths(curve.x, curve.y, false, arc);
  GeodesicNeighbours neighbours{{0}, {}, {}};
  for (std::size_t i = 0; i < 150; ++i) {
    for (std::uint32_t j = 0; j < 150; ++j) {
      neighbours.point.push_back(j);
      neighbours.distance.push_back(std::abs(arc[i] - arc[j]));
    }
    neighbours.first.push_back(neighbours.point.size());
  }
  Smoothed result;
  smooth_over(neighbours, curve.x, curve.y, 0.392, gaussian_reach(1e-6), result.curve);
  damped_displacement(curve.x, curve.y, result.curve, 0.392, result.response);
  expect_equal(smoothed(curve, 0.392), result);
}

TEST(CurveSmoother, IsAffineEquivariant) {
  const Curve curve = wobbly(200, 14);
  const auto map = [](Point2 p) { return Point2{3.0 + 0.5 * p.x - 1.2 * p.y, -1.0 + 0.7 * p.x + 0.9 * p.y}; };
  Curve mapped;
  for (std::size_t i = 0; i < curve.x.size(); ++i) { mapped.add(map(curve.at(i))); }
  AlignedVector<double> arc;  // the same geodesic coordinate for both
  const double length = arc_lengths(curve.x, curve.y, false, arc);
  CurveSmoother smoother;
  SmoothedCurve of_curve;
  SmoothedCurve of_mapped;
  smoother.set_curve(curve.x, curve.y, arc, false, length);
  smoother.smooth(0.3, 5.0, of_curve);
  smoother.set_curve(mapped.x, mapped.y, arc, false, length);
  smoother.smooth(0.3, 5.0, of_mapped);
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const Point2 expected = map({of_curve.x[i], of_curve.y[i]});
    EXPECT_NEAR(of_mapped.x[i], expected.x, rounded_point);
    EXPECT_NEAR(of_mapped.y[i], expected.y, rounded_point);
  }
}

TEST(CurveSmoother, LeavesAnEvenStraightLineWhereItIsButForItsEnds) {
  Curve curve;
  for (int i = 0; i <= 400; ++i) { curve.add({0.02 * i, 1.0 + 0.03 * i}); }
  const double t = 0.392;
  const Smoothed result = smoothed(curve, t);
  AlignedVector<double> arc;
  const double length = arc_lengths(curve.x, curve.y, false, arc);
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    // Twice the reach: at an end the density too is one-sided.
    if (arc[i] < 10.0 * t || length - arc[i] < 10.0 * t) { continue; }
    EXPECT_LT(norm(curve.at(i) - result.at(i)), rounded_point);
  }
  EXPECT_GT(norm(curve.at(0) - result.at(0)), 0.5 * t);
}

/// Two arms of length `arm` that meet at the origin under `angle`, sampled at steps from `steps`.
template <class Steps>
Curve wedge(double angle, double arm, Steps&& steps) {
  std::vector<double> positions;
  for (double s = 0.0; s < arm; s += steps(s)) { positions.push_back(s); }
  Curve curve;
  for (auto s = positions.rbegin(); s != positions.rend(); ++s) { curve.add({*s, 0.0}); }
  for (std::size_t i = 1; i < positions.size(); ++i) {
    curve.add({positions[i] * std::cos(angle), positions[i] * std::sin(angle)});
  }
  return curve;
}

TEST(Response, OfAWedgeFollowsItsAngleAtEveryScale) {
  for (const double degrees : {30.0, 60.0, 90.0, 120.0, 150.0}) {
    const double angle = radians_from_degrees(degrees);
    for (const double t : {0.2, 0.28, 0.392, 0.5488, 0.76832}) {
      const Curve curve = wedge(angle, 11.0 * t, [&](double) { return t / 50.0; });
      const Smoothed result = smoothed(curve, t);
      const std::size_t apex = curve.x.size() / 2;
      const double expected = 2.0 * std::sqrt(2.0 / pi) * std::cos(0.5 * angle);
      EXPECT_NEAR(z_of(curve, result, apex, t), expected, 1e-3 * expected);
      EXPECT_NEAR(result.response[apex], expected * std::exp(-expected), 1e-3);
    }
  }
  EXPECT_NEAR(2.0 * std::sqrt(2.0 / pi) * std::cos(pi / 4.0), 1.128, 1e-3);  // a right angle: F = .365 of at most .368
}

TEST(Response, OfASharpWedgeHasTwoPeaksBesideItsApex) {
  const double t = 0.392;
  const auto maxima = [&](double degrees) {
    const Curve curve = wedge(radians_from_degrees(degrees), 11.0 * t, [&](double) { return t / 50.0; });
    const std::vector<double> response = smoothed(curve, t).response;
    const std::size_t apex = curve.x.size() / 2;
    std::vector<std::size_t> peaks;
    for (std::size_t i = apex - 100; i <= apex + 100; ++i) {
      if (response[i] > response[i - 1] && response[i] > response[i + 1] && response[i] > 0.34) {
        peaks.push_back(i - apex + 1000);
      }
    }
    return peaks;
  };
  EXPECT_EQ(maxima(110.0), std::vector<std::size_t>{1000});
  const std::vector<std::size_t> sharp = maxima(30.0);
  ASSERT_EQ(sharp.size(), 2U);
  EXPECT_EQ(sharp[0] + sharp[1], 2000U);  // symmetric about the apex, which is a dip
  EXPECT_LT(sharp[0], 1000U);
}

/// z on a circle of radius 1: 2/t (1 − mean of cos u over N(u; t)), u the shorter way around.
double circle_z(double t) {
  double mass = 0.0;
  double cosines = 0.0;
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double u = pi * (i + 0.5) / steps;
    const double weight = std::exp(-0.5 * u * u / (t * t));
    mass += weight;
    cosines += weight * std::cos(u);
  }
  return 2.0 / t * (1.0 - cosines / mass);
}

TEST(Response, OfACircleIsExactAndLargestBeyondItsRadius) {
  const double radius = 1.7;
  Curve curve;
  curve.closed = true;
  for (int i = 0; i < 720; ++i) { curve.add(radius * Point2{std::cos(2 * pi * i / 720), std::sin(2 * pi * i / 720)}); }
  for (const double share : {0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.38, 1.6, 2.0, 2.5}) {
    const double z = circle_z(share);
    const Smoothed result = smoothed(curve, share * radius);
    for (const double response : result.response) { EXPECT_NEAR(response, z * std::exp(-z), 1e-5) << share; }
  }
  // To second order z = t/R, largest F at t = R. In full the mean of cos is e^(−t²/2R²) as long as a turn has no end,
  // and z falls short of 1: F is .358 at R and largest, .366, at 1.585 R; around a circle, .3632 at 1.38 R.
  const auto response = [&](double share) { return smoothed(curve, share * radius).response[0]; };
  EXPECT_NEAR(circle_z(0.1), 20.0 * (1.0 - std::exp(-0.005)), 1e-9);
  EXPECT_NEAR(response(1.0), 0.3577, 1e-4);
  EXPECT_NEAR(response(1.38), 0.3632, 1e-4);
  for (double share = 0.1; share < 1.3; share += 0.1) { EXPECT_LT(response(share), response(share + 0.1)); }
  for (double share = 1.5; share < 3.0; share += 0.1) { EXPECT_GT(response(share), response(share + 0.1)); }
}

TEST(Response, DoesNotDependOnHowTheCurveIsSampled) {
  const double t = 0.392;
  const double angle = radians_from_degrees(100.0);
  const Curve even = wedge(angle, 12.0 * t, [&](double) { return t / 60.0; });
  const Curve coarse = wedge(angle, 12.0 * t, [&](double) { return t / 15.0; });
  const Curve uneven = wedge(angle, 12.0 * t, [&](double s) { return t / 60.0 * (1.0 + 3.0 * s); });
  const auto apex = [&](const Curve& curve) { return smoothed(curve, t).response[curve.x.size() / 2]; };
  EXPECT_NEAR(apex(coarse), apex(even), 2e-3);
  EXPECT_NEAR(apex(uneven), apex(even), 5e-3);
}

TEST(CurveSmoother, CopesWithCoincidentPointsAndWithNone) {
  Curve curve;
  for (int i = 0; i < 20; ++i) { curve.add({1.0, 1.0}); }
  for (const bool closed : {false, true}) {
    curve.closed = closed;
    for (const double response : smoothed(curve, 0.2).response) { EXPECT_NEAR(response, 0.0, 1e-12); }
  }
  EXPECT_TRUE(smoothed({}, 0.2).response.empty());
}

TEST(CurveSmoother, KeepsNothingFromOneCurveToTheNext) {
  CurveSmoother used;
  SmoothedCurve out;
  AlignedVector<double> arc;
  const Curve large = wobbly(300, 1);
  const double length = arc_lengths(large.x, large.y, true, arc);
  used.set_curve(large.x, large.y, arc, true, length);
  used.smooth(0.7, 5.0, out);
  const Curve small = wobbly(37, 2);
  arc_lengths(small.x, small.y, false, arc);
  used.set_curve(small.x, small.y, arc, false, 0.0);
  used.smooth(0.2, gaussian_reach(1e-6), out);
  const Smoothed fresh = smoothed(small, 0.2);
  EXPECT_EQ(out.x, fresh.curve.x);
  EXPECT_EQ(out.y, fresh.curve.y);
}

}  // namespace
}  // namespace flirt
