#include "flirt/features/scale_space.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace flirt {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Pointwise;

SmoothingParams untruncated(SmoothingKernel kernel = SmoothingKernel::bessel) {
  return {.kernel = kernel, .lost_mass = 0.0};
}

double at(const std::vector<double>& half, int x) {
  const auto i = static_cast<std::size_t>(std::abs(x));
  return i < half.size() ? half[i] : 0.0;
}

double mass(const std::vector<double>& half) {
  double sum = half[0];
  for (std::size_t x = 1; x < half.size(); ++x) { sum += 2.0 * half[x]; }
  return sum;
}

double variance(const std::vector<double>& half) {
  double sum = 0.0;
  for (std::size_t x = 1; x < half.size(); ++x) { sum += 2.0 * half[x] * static_cast<double>(x * x); }
  return sum;
}

TEST(ScaleBank, FollowsThePapersProgression) {
  EXPECT_THAT(scale_bank({.count = 5, .base = 0.2, .step = 1.4}),
              Pointwise(DoubleNear(1e-12), {0.2, 0.28, 0.392, 0.5488, 0.76832}));
}

TEST(ScaleBank, IsBoundedAsAWhole) {
  EXPECT_EQ(too_coarse({}), "");
  EXPECT_EQ(too_coarse({.count = 5, .base = 2.0, .step = 10.0}), "") << "20000 is allowed";
  EXPECT_THAT(too_coarse({.count = 12, .base = 1.6, .step = 10.0}), testing::HasSubstr("found 160000000000."));
  EXPECT_NE(too_coarse({.count = 32, .base = 1000.0, .step = 10.0}), "");
  EXPECT_EQ(smoothing_kernel({.truncation = Truncation::half_width}, largest_scale).size(), 20001U);
}

TEST(BesselKernel, IsTheScaledModifiedBesselFunction) {
  for (const double t : {0.05, 0.5, 1.6, 6.147, 40.0}) {
    const std::vector<double> half = smoothing_kernel(untruncated(), t);
    for (int x = 0; x < 12; ++x) {
      EXPECT_NEAR(at(half, x), std::exp(-t) * std::cyl_bessel_i(x, t), 1e-14) << "t " << t << ", x " << x;
    }
  }
}

TEST(BesselKernel, HasMassOneAndVarianceT) {
  for (const double t : {0.001, 0.3, 1.6, 6.147, 100.0, 3000.0}) {
    const std::vector<double> half = smoothing_kernel(untruncated(), t);
    EXPECT_NEAR(mass(half), 1.0, 1e-12);
    EXPECT_NEAR(variance(half), t, 1e-9 * t);
  }
}

TEST(BesselKernel, IsASemigroup) {
  const std::vector<double> a = smoothing_kernel(untruncated(), 1.6);
  const std::vector<double> b = smoothing_kernel(untruncated(), 2.24);
  const std::vector<double> sum = smoothing_kernel(untruncated(), 3.84);
  for (int x = 0; x < 20; ++x) {
    double convolved = 0.0;
    for (int u = -60; u <= 60; ++u) { convolved += at(a, u) * at(b, x - u); }
    EXPECT_NEAR(convolved, at(sum, x), 1e-14);
  }
}

TEST(GaussianKernel, IsTheSampledGaussian) {
  const double t = 4.39;
  const std::vector<double> half = smoothing_kernel(untruncated(SmoothingKernel::gaussian), t);
  EXPECT_NEAR(mass(half), 1.0, 1e-12);
  for (int x = 1; x < 10; ++x) { EXPECT_NEAR(at(half, x) / at(half, 0), std::exp(-x * x / (2.0 * t)), 1e-14); }
}

TEST(SmoothingKernel, KeepsAllButTheLostMassAndNoMore) {
  const double t = 3.136;
  const std::vector<double> whole = smoothing_kernel(untruncated(), t);
  const std::vector<double> cut = smoothing_kernel({.lost_mass = 1e-6}, t);
  EXPECT_NEAR(mass(cut), 1.0, 1e-12);
  double outside = 0.0;
  for (std::size_t x = cut.size(); x < whole.size(); ++x) { outside += 2.0 * whole[x]; }
  EXPECT_LE(outside, 1e-6);
  EXPECT_GT(outside + 2.0 * whole[cut.size() - 1], 1e-6);
}

TEST(SmoothingKernel, CutAtTheHalfWidthKeepsTheRatiosAndMassOne) {
  const double t = 3.136;
  const std::vector<double> whole = smoothing_kernel(untruncated(), t);
  const std::vector<double> cut = smoothing_kernel({.truncation = Truncation::half_width}, t);
  ASSERT_EQ(cut.size(), 5U);  // ⌈3.136⌉ + 1
  EXPECT_NEAR(mass(cut), 1.0, 1e-12);
  EXPECT_NEAR(cut[4] / cut[0], whole[4] / whole[0], 1e-14);
}

TEST(Extend, MirrorsAboutTheSampleOrTheEdge) {
  const std::vector<double> signal{1, 2, 3};
  std::vector<double> extended;
  extend(signal, 4, {.border = Border::mirror_sample}, extended);
  EXPECT_THAT(extended, ElementsAre(1, 2, 3, 2, 1, 2, 3, 2, 1, 2, 3));
  extend(signal, 4, {.border = Border::mirror_edge}, extended);
  EXPECT_THAT(extended, ElementsAre(3, 3, 2, 1, 1, 2, 3, 3, 2, 1, 1));
}

TEST(Extend, GoesAroundAClosedSignalAddingTheTurn) {
  std::vector<double> extended;
  extend(std::vector<double>{1, 2, 3}, 4, {.closed = true, .turn_offset = 10.0}, extended);
  EXPECT_THAT(extended, ElementsAre(-17, -9, -8, -7, 1, 2, 3, 11, 12, 13, 21));
}

TEST(Extend, RepeatsASingleSample) {
  std::vector<double> extended;
  extend(std::vector<double>{7}, 2, {}, extended);
  EXPECT_THAT(extended, ElementsAre(7, 7, 7, 7, 7));
}

TEST(Convolve, EqualsTheDefinition) {
  std::vector<double> signal;
  for (int i = 0; i < 40; ++i) { signal.push_back(std::sin(0.37 * i * i)); }
  const std::vector<double> kernel = smoothing_kernel({}, 2.24);
  const int width = static_cast<int>(kernel.size()) - 1;
  std::vector<double> extended;
  std::vector<double> smoothed;
  extend(signal, kernel.size() - 1, {}, extended);
  convolve(extended, kernel, smoothed);
  ASSERT_EQ(smoothed.size(), signal.size());
  for (int i = 0; i < 40; ++i) {
    double expected = 0.0;
    for (int x = -width; x <= width; ++x) {
      expected += at(kernel, x) * extended[static_cast<std::size_t>(i + x + width)];
    }
    EXPECT_NEAR(smoothed[static_cast<std::size_t>(i)], expected, 1e-13);
  }
}

TEST(Differences, AreExactOnPolynomials) {
  std::vector<double> parabola;
  for (int i = -1; i <= 5; ++i) { parabola.push_back(3.0 * i * i + 2.0 * i); }
  std::vector<double> out;
  first_difference(parabola, 1.0, out);
  EXPECT_THAT(out, ElementsAre(2, 8, 14, 20, 26));
  second_difference(parabola, 0.5, out);
  EXPECT_THAT(out, ElementsAre(3, 3, 3, 3, 3));
}

}  // namespace
}  // namespace flirt
