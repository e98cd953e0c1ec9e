#include "flirt/match/sketch.hpp"

#include "tests/match/random_features.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace flirt {
namespace {

double product(const std::vector<std::int16_t>& sketches, std::size_t i, std::size_t j) {
  double sum = 0.0;
  for (std::size_t k = 0; k < sketch_size; ++k) {
    sum += double{sketches[i * sketch_size + k] / double{sketch_scale}} *
           (sketches[j * sketch_size + k] / double{sketch_scale});
  }
  return sum;
}

// The inequality that the bound stands on; beyond w = 60 the left side is below 1e-12 and the right one at least 0.512.
TEST(Sketch, CosineBoundsTheHarmonicMeanForEveryRatio) {
  for (int i = 0; i <= 600'000; ++i) {
    const double w = 1e-4 * i;
    ASSERT_LE(1.0 / std::cosh(w / 2), 1.0 - 0.244 + 0.244 * std::cos(w) + 1e-12) << w;
  }
}

TEST(Sketch, ProductBoundsChiSquareFromBelow) {
  Rng rng(1);
  for (const std::size_t dimension : {3U, 16U, 48U, 60U}) {
    for (const double sparsity : {0.0, 0.5, 0.9}) {
      const Descriptors made_for = test::random_descriptors(rng, 40, dimension, sparsity);
      const Descriptors a = test::random_descriptors(rng, 120, dimension, sparsity);
      const SketchAxes axes = fit_sketch_axes(rows_of(made_for));
      const std::vector<std::int16_t> sketches = sketches_of(axes, rows_of(a));
      for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t j = 0; j < a.size(); ++j) {
          const double distance = descriptor_distance(Distance::chi_square, rows_of(a), i, rows_of(a), j);
          ASSERT_GE(distance, 1.0 - product(sketches, i, j) - double{sketch_slack}) << dimension << " bins";
        }
      }
    }
  }
}

TEST(Sketch, BoundsTighterThanRootsForTheDescriptorsItIsMadeFor) {
  Rng rng(2);
  const Descriptors a = test::random_descriptors(rng, 24, 48);
  const std::vector<std::int16_t> sketches = sketches_of(fit_sketch_axes(rows_of(a)), rows_of(a));
  double by_sketches = 0.0;
  double by_roots = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      by_sketches += 1.0 - product(sketches, i, j);
      const float hellinger = descriptor_distance(Distance::hellinger, rows_of(a), i, rows_of(a), j);
      by_roots += double{hellinger} * double{hellinger};
    }
  }
  EXPECT_GT(by_sketches, 1.1 * by_roots);
}

TEST(Sketch, ARowsSketchDoesNotDependOnItsNeighbours) {
  Rng rng(3);
  const Descriptors a = test::random_descriptors(rng, 30, 48);
  const SketchAxes axes = fit_sketch_axes(rows_of(a));
  const std::vector<std::int16_t> all = sketches_of(axes, rows_of(a));
  std::vector<std::int16_t> some(4 * sketch_size);
  sketch_rows(axes, rows_of(a), 7, 11, some);
  EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin() + 7 * sketch_size));
}

TEST(Sketch, OfNoDescriptorsThereAreNone) {
  Descriptors none;
  none.dimension = 48;
  none.stride = 48;
  EXPECT_TRUE(sketches_of(fit_sketch_axes(rows_of(none)), rows_of(none)).empty());
}

}  // namespace
}  // namespace flirt
