#include "flirt/match/distance.hpp"

#include "flirt/core/fields.hpp"

#include "tests/match/random_features.hpp"
#include "tests/support/print.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace flirt {
namespace {

/// The definitions as plain loops in double precision over the bins.
double slow_distance(Distance distance, const Descriptors& a, std::size_t i, const Descriptors& b, std::size_t j) {
  double sum = 0.0;
  double coefficient = 0.0;
  const auto bins = static_cast<double>(a.dimension);
  for (std::size_t k = 0; k < a.dimension; ++k) {
    const double p = a.rows[i * a.stride + k];
    const double q = b.rows[j * b.stride + k];
    coefficient += std::sqrt(p * q);
    const double square = (p - q) * (p - q);
    switch (distance) {
      case Distance::chi_square:
        sum += p + q > 0.0 ? 0.5 * square / (p + q) : 0.0;
        break;
      case Distance::variance_chi_square: {
        const double v = a.variances.empty() ? 0.0 : double{a.variances[i * a.stride + k]};
        const double w = b.variances.empty() ? 0.0 : double{b.variances[j * b.stride + k]};
        const double weight = p + q + std::sqrt(v + w);
        sum += weight > 0.0 ? 0.5 * square / weight : 0.0;
        break;
      }
      case Distance::euclidean:
        sum += square;
        break;
      case Distance::jensen_shannon:
        sum += p > 0.0 ? 0.5 * p * std::log2(2.0 * p / (p + q)) : 0.0;
        sum += q > 0.0 ? 0.5 * q * std::log2(2.0 * q / (p + q)) : 0.0;
        break;
      case Distance::kullback_leibler: {
        const double smooth_p = 0.99 * p + 0.01 / bins;
        const double smooth_q = 0.99 * q + 0.01 / bins;
        sum += smooth_p * std::log(smooth_p / smooth_q);
        break;
      }
      case Distance::hellinger:
      case Distance::bhattacharyya:
        break;
    }
  }
  switch (distance) {
    case Distance::euclidean:
      return std::sqrt(sum);
    case Distance::hellinger:
      return std::sqrt(std::max(0.0, 1.0 - coefficient));
    case Distance::bhattacharyya:
      return -std::log(coefficient);
    default:
      return sum;
  }
}

void add_variances(Descriptors& descriptors, Rng& rng) {
  descriptors.variances.assign(descriptors.rows.size(), 0.0F);
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    for (std::size_t k = 0; k < descriptors.dimension; ++k) {
      descriptors.variances[i * descriptors.stride + k] = static_cast<float>(rng.uniform(0.0, 1e-3));
    }
  }
}

std::string name_of(const testing::TestParamInfo<Distance>& info) {
  std::string name(flirt::to_string(info.param));
  std::ranges::replace(name, '-', '_');
  return name;
}

class EachDistance : public testing::TestWithParam<Distance> {};
INSTANTIATE_TEST_SUITE_P(Distances, EachDistance,
                         testing::Values(Distance::chi_square, Distance::variance_chi_square, Distance::euclidean,
                                         Distance::hellinger, Distance::bhattacharyya, Distance::jensen_shannon,
                                         Distance::kullback_leibler),
                         name_of);

TEST_P(EachDistance, AgreesWithPlainLoopsForAnyDimensionAndManyZeros) {
  Rng rng(1);
  for (const std::size_t dimension : {1U, 3U, 16U, 17U, 47U, 48U, 64U, 90U}) {
    for (const double zeros : {0.0, 0.5, 0.95}) {
      Descriptors a = test::random_descriptors(rng, 5, dimension, zeros);
      Descriptors b = test::random_descriptors(rng, 4, dimension, zeros);
      add_variances(a, rng);
      add_variances(b, rng);
      for (std::size_t i = 0; i < a.size(); ++i) {
        std::vector<float> all(b.size());
        descriptor_distances(GetParam(), rows_of(a), i, rows_of(b), all);
        for (std::size_t j = 0; j < b.size(); ++j) {
          const double expected = slow_distance(GetParam(), a, i, b, j);
          EXPECT_EQ(all[j], descriptor_distance(GetParam(), rows_of(a), i, rows_of(b), j));
          if (std::isinf(expected)) {
            EXPECT_EQ(all[j], std::numeric_limits<float>::infinity());
          } else if (GetParam() == Distance::hellinger) {
            EXPECT_NEAR(all[j] * all[j], expected * expected, 1e-6);  // a root magnifies rounding near 0
          } else {
            EXPECT_NEAR(all[j], expected, 2e-6) << "dimension " << dimension << " zeros " << zeros;
          }
        }
      }
    }
  }
}

TEST_P(EachDistance, IsNoughtBetweenEqualRows) {
  Rng rng(2);
  const Descriptors a = test::random_descriptors(rng, 6, 48);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(descriptor_distance(GetParam(), rows_of(a), i, rows_of(a), i), 0.0F, 1e-3F);
  }
}

TEST_P(EachDistance, SeparatesDisjointRowsMost) {
  Descriptors a;
  test::append_row(a, {1, 1, 0, 0});
  test::append_row(a, {0, 0, 1, 1});
  test::append_row(a, {1, 1, 1, 1});
  const float disjoint = descriptor_distance(GetParam(), rows_of(a), 0, rows_of(a), 1);
  const float overlapping = descriptor_distance(GetParam(), rows_of(a), 0, rows_of(a), 2);
  EXPECT_GT(disjoint, overlapping);
  EXPECT_GT(overlapping, 0.0F);
}

TEST(Distance, OfDisjointRowsHasItsKnownLargestValue) {
  Descriptors a;
  test::append_row(a, {1, 0});
  test::append_row(a, {0, 1});
  const DescriptorRows rows = rows_of(a);
  EXPECT_FLOAT_EQ(descriptor_distance(Distance::chi_square, rows, 0, rows, 1), 1.0F);
  EXPECT_FLOAT_EQ(descriptor_distance(Distance::euclidean, rows, 0, rows, 1), std::sqrt(2.0F));
  EXPECT_FLOAT_EQ(descriptor_distance(Distance::hellinger, rows, 0, rows, 1), 1.0F);
  EXPECT_EQ(descriptor_distance(Distance::bhattacharyya, rows, 0, rows, 1), std::numeric_limits<float>::infinity());
  EXPECT_FLOAT_EQ(descriptor_distance(Distance::jensen_shannon, rows, 0, rows, 1), 1.0F);
  EXPECT_NEAR(descriptor_distance(Distance::kullback_leibler, rows, 0, rows, 1), 0.99 * std::log(0.995 / 0.005), 1e-5);
}

TEST(Distance, OfVarianceWeightingIsPlainChiSquareWithoutVariancesAndNeverAboveIt) {
  Rng rng(3);
  Descriptors a = test::random_descriptors(rng, 8, 48);
  const DescriptorRows plain = rows_of(a);
  const float without = descriptor_distance(Distance::variance_chi_square, plain, 0, plain, 1);
  EXPECT_EQ(without, descriptor_distance(Distance::chi_square, plain, 0, plain, 1));
  add_variances(a, rng);
  for (std::size_t j = 1; j < a.size(); ++j) {
    EXPECT_LT(descriptor_distance(Distance::variance_chi_square, rows_of(a), 0, rows_of(a), j),
              descriptor_distance(Distance::chi_square, rows_of(a), 0, rows_of(a), j));
  }
}

}  // namespace
}  // namespace flirt
