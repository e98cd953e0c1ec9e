// The detectors against the papers themselves: figure 2 of P2, and every equation written out a second time, slowly.
#include "flirt/core/rng.hpp"
#include "flirt/features/detect.hpp"

#include "tests/support/numbers.hpp"
#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <set>
#include <vector>

namespace flirt {
namespace {

/// Like the scene of figure 2: a background wall, in front of it a wall that begins in the open, turns away at a convex
/// corner and towards the sensor again at an obtuse concave one. 150 beams of 1°.
struct FigureTwo {
  Point2 edge{3.1, -1.5};
  Point2 convex{1.84, 1.14};
  Point2 concave{3.8, 3.42};
  Scene scene{{{13.5, -7.9}, {2.57, 0.85}}, {edge, convex}, {convex, concave}, {concave, {4.3, 7.4}}};

  [[nodiscard]] Scan scan() const {
    const Beams beams{
        .angle_min = radians_from_degrees(-75.0), .angle_step = radians_from_degrees(1.0), .range_max = 30};
    return scan_of(scene, {}, beams, 150);
  }
};

using Levels = std::multiset<int>;

TEST(FigureTwo, OfThePaperIsReproduced) {
  const FigureTwo figure;
  DetectorTrace trace;
  EXPECT_FALSE(detect(figure.scan(), CurvatureParams{}, &trace).empty());
  Levels background;
  Levels foreground;
  Levels convex;
  Levels concave;
  Levels elsewhere;
  for (int level = 0; level < 5; ++level) {
    const ScaleTrace& scale = trace.scales[static_cast<std::size_t>(level)];
    for (const std::uint32_t peak : scale.peaks) {
      const Point2 point = trace.points[peak];
      const auto near = [&](Point2 place, double radius) { return norm(point - place) < radius; };
      if (near(figure.edge, 0.05 + 0.5 * scale.t)) {
        foreground.insert(level);
      } else if (near(figure.convex, 0.1)) {
        convex.insert(level);
      } else if (near(figure.concave, 0.1)) {
        concave.insert(level);
      } else if (trace.beams[peak] == 48 || trace.beams[peak] == 49) {  // the last two before the foreground
        background.insert(level);
      } else {
        elsewhere.insert(level);
      }
    }
  }
  EXPECT_EQ(background, (Levels{4})) << "only on the largest scale";
  EXPECT_EQ(foreground, (Levels{0, 1, 2, 3, 4}));
  EXPECT_EQ(convex, (Levels{0, 1, 2, 3, 4}));
  EXPECT_EQ(concave, (Levels{0, 1})) << "on scale 1 and 2";
  EXPECT_EQ(elsewhere, Levels{});
}

/// A wobbly scan with a few beams that have no return.
Scan wobbly_scan(bool full_turn) {
  Rng rng(9);
  const std::size_t count = full_turn ? 360 : 300;
  Scan scan{.beams = {.angle_min = -2.5, .angle_step = 2.0 * pi / 360, .range_max = 30}};
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = scan.beams.angle(i);
    const double range =
        4.0 + std::sin(3.0 * angle) + (std::sin(7.0 * angle) > 0.0 ? 1.5 : 0.0) + rng.normal(0.0, 0.02);
    scan.ranges.push_back(i % 37 == 5 ? 0.0 : range);
  }
  return scan;
}

/// Sample i of a signal that goes around, adding `turn` each time, or is mirrored about its outermost samples.
double sample(const std::vector<double>& signal, std::ptrdiff_t i, bool closed, double turn) {
  const std::ptrdiff_t n = std::ssize(signal);
  double offset = 0.0;
  while (i < 0 || i >= n) {
    if (closed) {
      offset += i < 0 ? -turn : turn;
      i += i < 0 ? n : -n;
    } else {
      i = i < 0 ? -i : 2 * (n - 1) - i;
    }
  }
  return signal[static_cast<std::size_t>(i)] + offset;
}

/// S(x; t) = Σ_u e^−t I_u(t) s(x − u) (P2 eq. 1 and 2).
std::vector<double> smoothed(const std::vector<double>& signal, double t, bool closed, double turn) {
  std::vector<double> result;
  for (std::ptrdiff_t x = 0; x < std::ssize(signal); ++x) {
    double sum = 0.0;
    for (int u = -60; u <= 60; ++u) {
      sum += std::exp(-t) * std::cyl_bessel_i(std::abs(u), t) * sample(signal, x - u, closed, turn);
    }
    result.push_back(sum);
  }
  return result;
}

/// Direction of least spread of three points, found by trying all directions, then refined by Newton's method.
double fitted_normal(Point2 a, Point2 b, Point2 c) {
  const Point2 mean = (1.0 / 3.0) * (a + b + c);
  const auto spread = [&](double angle) {
    const Point2 normal{std::cos(angle), std::sin(angle)};
    double sum = 0.0;
    for (const Point2 point : {a, b, c}) { sum += dot(normal, point - mean) * dot(normal, point - mean); }
    return sum;
  };
  double best = 0.0;
  for (int k = 0; k < 1800; ++k) {
    if (spread(k * pi / 1800) < spread(best)) { best = k * pi / 1800; }
  }
  // spread = A + B cos 2(angle − best'): its derivatives at two points give the minimum exactly.
  const double quarter = pi / 4;
  const double cosine = spread(best) - spread(best + 2 * quarter);
  const double sine = spread(best + quarter) - spread(best - quarter);
  best += 0.5 * std::atan2(-sine, -cosine);
  const double rho = dot(mean, {std::cos(best), std::sin(best)});
  return wrap_angle(rho < 0.0 ? best + pi : best);
}

struct Signals {
  std::vector<double> ranges{};
  std::vector<double> normals{};
  double turn{0};
};

/// Ranges, and normals over ranges smoothed at the finest scale, unwrapped.
Signals signals_of(const Scan& scan, bool closed) {
  Signals signals;
  std::vector<double> angles;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (scan.ranges[i] == 0.0) { continue; }
    signals.ranges.push_back(scan.ranges[i]);
    angles.push_back(scan.beams.angle(i));
  }
  const std::vector<double> ranges = smoothed(signals.ranges, 1.6, closed, 0.0);
  const std::ptrdiff_t n = std::ssize(ranges);
  const auto point = [&](std::ptrdiff_t i) {
    const auto k = static_cast<std::size_t>((i + n) % n);
    return ranges[k] * Point2{std::cos(angles[k]), std::sin(angles[k])};
  };
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t centre = closed ? i : std::clamp<std::ptrdiff_t>(i, 1, n - 2);
    const double normal = fitted_normal(point(centre - 1), point(centre), point(centre + 1));
    const double before = signals.normals.empty() ? normal : signals.normals.back();
    signals.normals.push_back(before + wrap_angle(normal - before));
  }
  const double around = signals.normals.back() + wrap_angle(signals.normals.front() - signals.normals.back());
  signals.turn = closed ? around - signals.normals.front() : 0.0;
  return signals;
}

/// Which derivative of which signal a detector responds to.
enum class Derivative { first, second };

template <class Params>
void expect_equations(Derivative derivative, bool closed) {
  const Scan scan = wobbly_scan(closed);
  ASSERT_EQ(is_full_turn(scan), closed);
  Params params;
  params.smoothing.lost_mass = 0.0;
  DetectorTrace trace;
  EXPECT_FALSE(detect(scan, params, &trace).empty());
  const Signals signals = signals_of(scan, closed);
  const bool over_ranges = std::is_same_v<Params, RangeParams>;
  const std::vector<double>& signal = over_ranges ? signals.ranges : signals.normals;
  const double turn = over_ranges ? 0.0 : signals.turn;
  ASSERT_EQ(trace.signal.size(), signal.size());
  for (std::size_t i = 0; i < signal.size(); ++i) { EXPECT_NEAR(trace.signal[i], signal[i], 1e-9); }
  ASSERT_EQ(trace.scales.size(), 5U);
  for (std::size_t level = 0; level < 5; ++level) {
    const ScaleTrace& scale = trace.scales[level];
    EXPECT_NEAR(scale.t, 1.6 * std::pow(1.4, static_cast<double>(level)), 1e-12);
    const std::vector<double> smooth = smoothed(signal, scale.t, closed, turn);
    for (std::ptrdiff_t x = 0; x < std::ssize(signal); ++x) {
      const auto i = static_cast<std::size_t>(x);
      const double left = sample(smooth, x - 1, closed, turn);
      const double right = sample(smooth, x + 1, closed, turn);
      EXPECT_NEAR(scale.smoothed_signal[i], smooth[i], 1e-9);
      const double expected = derivative == Derivative::first ? std::sqrt(scale.t) * 0.5 * (right - left)    // eq. 6
                                                              : scale.t * (left - 2.0 * smooth[i] + right);  // eq. 4
      EXPECT_NEAR(scale.response[i], expected, 1e-8);
    }
  }
}

TEST(PaperEquations, HoldForTheRangeDetector) {
  for (const bool closed : {false, true}) { expect_equations<RangeParams>(Derivative::second, closed); }
}
TEST(PaperEquations, HoldForTheNormalEdgeDetector) {
  for (const bool closed : {false, true}) { expect_equations<NormalEdgeParams>(Derivative::first, closed); }
}
TEST(PaperEquations, HoldForTheNormalBlobDetector) {
  for (const bool closed : {false, true}) { expect_equations<NormalBlobParams>(Derivative::second, closed); }
}

TEST(PaperEquations, HoldForTheCurvatureDetector) {
  for (const bool closed : {false, true}) {
    const Scan scan = wobbly_scan(closed);
    CurvatureParams params;
    params.lost_mass = 0.0;
    DetectorTrace trace;
    EXPECT_FALSE(detect(scan, params, &trace).empty());
    const std::vector<Point2>& points = trace.points;
    const std::size_t n = points.size();
    std::vector<double> s{0.0};
    for (std::size_t i = 1; i < n; ++i) { s.push_back(s.back() + norm(points[i] - points[i - 1])); }
    const double length = s.back() + norm(points.front() - points.back());
    for (const ScaleTrace& scale : trace.scales) {
      const auto k = [&](std::size_t i, std::size_t j) {  // eq. 8
        const double u = std::abs(s[i] - s[j]);
        const double distance = closed ? std::min(u, length - u) : u;
        return std::exp(-0.5 * distance * distance / (scale.t * scale.t));
      };
      std::vector<double> p(n, 0.0);  // eq. 10
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) { p[i] += k(i, j); }
      }
      for (std::size_t i = 0; i < n; ++i) {
        Point2 sum{};
        double mass = 0.0;
        for (std::size_t j = 0; j < n; ++j) {
          const double weight = k(i, j) / (p[i] * p[j]);  // eq. 9
          sum = sum + weight * points[j];                 // eq. 11
          mass += weight;
        }
        const double z = 2.0 * norm(points[i] - (1.0 / mass) * sum) / scale.t;
        EXPECT_NEAR(scale.response[i], z * std::exp(-z), 5e-6);  // eq. 12; floats are summed
      }
    }
  }
}

}  // namespace
}  // namespace flirt
