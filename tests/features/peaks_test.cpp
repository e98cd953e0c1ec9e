#include "flirt/features/peaks.hpp"

#include "flirt/core/rng.hpp"

#include "tests/support/print.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace flirt {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr PeakParams neighbour_rule{.threshold = 0.3, .difference = 0.1, .rule = PeakRule::neighbours};
constexpr PeakParams prominence_rule{.threshold = 0.3, .difference = 0.1, .rule = PeakRule::prominence};

std::vector<std::uint32_t> peaks_of(const std::vector<double>& signal, const PeakParams& params,
                                    const PeakSearch& search = {}) {
  std::vector<std::uint32_t> peaks;
  find_peaks(signal, params, search, peaks);
  return peaks;
}

class BothRules : public testing::TestWithParam<PeakParams> {};
INSTANTIATE_TEST_SUITE_P(Peaks, BothRules, testing::Values(neighbour_rule, prominence_rule));

TEST_P(BothRules, FindWhatStandsOutAboveTheThreshold) {
  EXPECT_THAT(peaks_of({0, 1, 0, 0.2, 0, 0.5, 0.45, 0.5, 1}, GetParam()), ElementsAre(1));
}

TEST_P(BothRules, TakeTheMiddleOfAPlateau) {
  EXPECT_THAT(peaks_of({0, 1, 1, 1, 0, 1, 1, 0}, GetParam()), ElementsAre(2, 5));
  EXPECT_THAT(peaks_of({0, 1, 1 + 1e-13, 1, 0}, GetParam()), ElementsAre(2));
}

TEST_P(BothRules, IgnoreAPlateauThatGoesOnToTheBorder) {
  EXPECT_THAT(peaks_of({1, 1, 0, 0, 1, 1}, GetParam()), IsEmpty());
}

TEST_P(BothRules, FindMinimaOnRequest) {
  EXPECT_THAT(peaks_of({0, 1, 0, -1, 0}, GetParam()), ElementsAre(1));
  EXPECT_THAT(peaks_of({0, 1, 0, -1, 0}, GetParam(), {.extrema = Extrema::both}), ElementsAre(1, 3));
}

TEST_P(BothRules, KeepTheMarginOfAnOpenSignal) {
  const std::vector<double> signal{0, 1, 0, 1, 0, 1, 0, 1, 0};
  EXPECT_THAT(peaks_of(signal, GetParam()), ElementsAre(1, 3, 5, 7));
  EXPECT_THAT(peaks_of(signal, GetParam(), {.margin = 1}), ElementsAre(3, 5));
  EXPECT_THAT(peaks_of(signal, GetParam(), {.margin = 100}), IsEmpty());
}

TEST_P(BothRules, RotateWithAClosedSignal) {
  std::vector<double> signal{0, 1, 1, 0, 0.6, 0.2, 0.9, -0.4};
  const std::vector<std::uint32_t> expected{1, 4, 6};
  for (std::size_t shift = 0; shift < signal.size(); ++shift) {
    std::vector<std::uint32_t> moved;
    for (const std::uint32_t peak : expected) {
      moved.push_back(static_cast<std::uint32_t>((peak + signal.size() - shift) % signal.size()));
    }
    std::ranges::sort(moved);
    EXPECT_EQ(peaks_of(signal, GetParam(), {.margin = 3, .closed = true}), moved);
    std::ranges::rotate(signal, signal.begin() + 1);
  }
}

TEST_P(BothRules, FindNothingInShortFlatOrBrokenSignals) {
  for (const bool closed : {false, true}) {
    EXPECT_THAT(peaks_of({}, GetParam(), {.closed = closed}), IsEmpty());
    EXPECT_THAT(peaks_of({1}, GetParam(), {.closed = closed}), IsEmpty());
    EXPECT_THAT(peaks_of({1, 0}, GetParam(), {.closed = closed}), IsEmpty());
    EXPECT_THAT(peaks_of(std::vector<double>(50, 1.0), GetParam(), {.closed = closed}), IsEmpty());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(peaks_of({nan, nan, nan, nan}, GetParam(), {.extrema = Extrema::both, .closed = closed}), IsEmpty());
  }
}

TEST(PeakRules, DifferOnAPeakThatFallsInTwoSteps) {
  const std::vector<double> signal{0, 0.5, 0.45, 0};
  EXPECT_THAT(peaks_of(signal, neighbour_rule), IsEmpty());
  EXPECT_THAT(peaks_of(signal, prominence_rule), ElementsAre(1));
}

TEST(PeaksOverNeighbours, EqualThePlainRuleWithoutPlateaus) {
  Rng rng(5);
  std::vector<double> signal;
  for (int i = 0; i < 2000; ++i) { signal.push_back(rng.uniform(-1.0, 1.0)); }
  std::vector<std::uint32_t> expected;
  for (std::size_t i = 4; i + 4 < signal.size(); ++i) {
    const double value = signal[i];
    const double left = signal[i - 1];
    const double right = signal[i + 1];
    if ((value > 0.3 && value - left > 0.1 && value - right > 0.1) ||
        (value < -0.3 && left - value > 0.1 && right - value > 0.1)) {
      expected.push_back(static_cast<std::uint32_t>(i));
    }
  }
  EXPECT_EQ(peaks_of(signal, neighbour_rule, {.extrema = Extrema::both, .margin = 3}), expected);
}

TEST(ProminentPeaks, EqualTheirDefinitionSampleBySample) {
  Rng rng(6);
  std::vector<double> signal{0.0};
  for (int i = 0; i < 2000; ++i) { signal.push_back(0.9 * signal.back() + rng.normal(0.0, 0.1)); }
  const auto falls_before_rising = [&](std::size_t i, int step) {
    for (auto j = static_cast<std::ptrdiff_t>(i) + step; j >= 0 && j < std::ssize(signal); j += step) {
      const double value = signal[static_cast<std::size_t>(j)];
      if (value > signal[i]) { return false; }
      if (signal[i] - value > 0.1) { return true; }
    }
    return false;
  };
  std::vector<std::uint32_t> expected;
  for (std::size_t i = 1; i + 1 < signal.size(); ++i) {
    if (signal[i] > 0.3 && falls_before_rising(i, 1) && falls_before_rising(i, -1)) {
      expected.push_back(static_cast<std::uint32_t>(i));
    }
  }
  EXPECT_GT(expected.size(), 20U);
  EXPECT_EQ(peaks_of(signal, prominence_rule), expected);
}

TEST(ProminentPeaks, DoNotDependOnTheDensityOfTheSamples) {
  const auto bump = [](int samples) {
    std::vector<double> signal;
    for (int i = 0; i <= samples; ++i) {
      const double x = 8.0 * i / samples - 4.0;
      signal.push_back(std::exp(-x * x));
    }
    return signal;
  };
  EXPECT_THAT(peaks_of(bump(20), prominence_rule), ElementsAre(10));
  EXPECT_THAT(peaks_of(bump(2000), prominence_rule), ElementsAre(1000));
  EXPECT_THAT(peaks_of(bump(2000), neighbour_rule), IsEmpty());
}

}  // namespace
}  // namespace flirt
