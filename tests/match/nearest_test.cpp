#include "flirt/match/nearest.hpp"

#include "flirt/match/sketch.hpp"

#include "tests/match/random_features.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace flirt {
namespace {

std::vector<Nearest> brute_force(const Descriptors& query, const Descriptors& reference, float limit) {
  std::vector<Nearest> result(query.size());
  for (std::size_t i = 0; i < query.size(); ++i) {
    for (std::uint32_t j = 0; j < reference.size(); ++j) {
      const float distance = descriptor_distance(Distance::chi_square, rows_of(query), i, rows_of(reference), j);
      if (distance < limit && distance < result[i].distance) { result[i] = {j, distance}; }
    }
  }
  return result;
}

std::vector<Nearest> pruned(const Descriptors& query, const Descriptors& reference, float limit) {
  NearestRows search;
  search.set_query(rows_of(query));
  const auto found = search.search(rows_of(reference), limit);
  return {found.begin(), found.end()};
}

TEST(NearestRows, DotProductOfRootsBoundsChiSquareFromBelow) {
  Rng rng(1);
  const Descriptors a = test::random_descriptors(rng, 200, 48, 0.5);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < a.size(); ++j) {
      double dot = 0.0;
      for (std::size_t k = 0; k < a.stride; ++k) {
        dot += double{a.roots[i * a.stride + k]} * double{a.roots[j * a.stride + k]};
      }
      const double distance = descriptor_distance(Distance::chi_square, rows_of(a), i, rows_of(a), j);
      EXPECT_GE(distance, 1.0 - dot - 1e-6);
      EXPECT_LE(distance, 2.0 * (1.0 - dot) + 1e-6);  // so the bound is never off by more than a factor of two
    }
  }
}

TEST(NearestRows, EqualsBruteForceBitByBit) {
  Rng rng(2);
  for (const std::size_t dimension : {5U, 16U, 48U, 60U}) {
    for (const std::size_t queries : {1U, 15U, 16U, 17U, 40U}) {
      for (const std::size_t references : {1U, 2U, 3U, 4U, 5U, 27U}) {
        const Descriptors query = test::random_descriptors(rng, queries, dimension);
        const Descriptors reference = test::random_descriptors(rng, references, dimension);
        for (const float limit : {0.05F, 0.2F, 0.4F, 2.0F}) {
          EXPECT_EQ(pruned(query, reference, limit), brute_force(query, reference, limit));
        }
      }
    }
  }
}

/// `pruned` by sketches with axes made for the reference.
std::vector<Nearest> pruned_by_sketches(const Descriptors& query, const Descriptors& reference, float limit) {
  const SketchAxes axes = fit_sketch_axes(rows_of(reference));
  const std::vector<std::int16_t> of_query = sketches_of(axes, rows_of(query));
  const std::vector<std::int16_t> of_reference = sketches_of(axes, rows_of(reference));
  DescriptorRows queries = rows_of(query);
  DescriptorRows references = rows_of(reference);
  queries.sketches = of_query.data();
  references.sketches = of_reference.data();
  NearestRows search;
  search.set_query(queries);
  const auto found = search.search(references, limit);
  return {found.begin(), found.end()};
}

TEST(NearestRows, BySketchesEqualsBruteForceBitByBit) {
  Rng rng(6);
  for (const std::size_t dimension : {5U, 16U, 48U, 60U}) {
    for (const std::size_t queries : {1U, 15U, 16U, 17U, 40U}) {
      for (const std::size_t references : {1U, 4U, 5U, 27U, 100U}) {
        const Descriptors query = test::random_descriptors(rng, queries, dimension);
        const Descriptors reference = test::random_descriptors(rng, references, dimension);
        for (const float limit : {0.05F, 0.2F, 0.4F, 1e9F}) {
          EXPECT_EQ(pruned_by_sketches(query, reference, limit), brute_force(query, reference, limit));
        }
        EXPECT_EQ(pruned_by_sketches(reference, reference, 0.4F), brute_force(reference, reference, 0.4F));
      }
    }
  }
}

TEST(NearestRows, WithoutSketchesOnBothSidesGoesByRoots) {
  Rng rng(7);
  const Descriptors query = test::random_descriptors(rng, 20, 48);
  const Descriptors reference = test::random_descriptors(rng, 30, 48);
  const std::vector<std::int16_t> of_query = sketches_of(fit_sketch_axes(rows_of(reference)), rows_of(query));
  DescriptorRows queries = rows_of(query);
  queries.sketches = of_query.data();
  NearestRows search;
  search.set_query(queries);
  const auto found = search.search(rows_of(reference), 0.4F);
  EXPECT_EQ(std::vector<Nearest>(found.begin(), found.end()), brute_force(query, reference, 0.4F));
}

TEST(NearestRows, OfEqualReferencesTakesTheFirst) {
  Rng rng(3);
  const Descriptors one = test::random_descriptors(rng, 1, 48);
  Descriptors reference = test::random_descriptors(rng, 3, 48);
  for (int copy = 0; copy < 3; ++copy) {
    reference.rows.insert(reference.rows.end(), one.rows.begin(), one.rows.end());
    reference.roots.insert(reference.roots.end(), one.roots.begin(), one.roots.end());
  }
  EXPECT_EQ(pruned(one, reference, 0.4F), (std::vector<Nearest>{{3, 0.0F}}));
  EXPECT_EQ(pruned_by_sketches(one, reference, 0.4F), (std::vector<Nearest>{{3, 0.0F}}));
}

TEST(NearestRows, FindsNothingInAnEmptyReferenceOrBeyondTheLimit) {
  Rng rng(4);
  const Descriptors query = test::random_descriptors(rng, 20, 48);
  Descriptors none;
  none.dimension = 48;
  none.stride = 48;
  EXPECT_EQ(pruned(query, none, 0.4F), std::vector<Nearest>(20));
  EXPECT_EQ(pruned(query, query, 0.0F), std::vector<Nearest>(20));
  EXPECT_TRUE(pruned(none, query, 0.4F).empty());
}

TEST(NearestRows, ForgetsTheReferenceBefore) {
  Rng rng(5);
  const Descriptors query = test::random_descriptors(rng, 20, 48);
  const Descriptors large = test::random_descriptors(rng, 60, 48);
  const Descriptors small = test::random_descriptors(rng, 3, 48);
  NearestRows search;
  search.set_query(rows_of(query));
  static_cast<void>(search.search(rows_of(large), 1.0F));
  const auto found = search.search(rows_of(small), 1.0F);
  EXPECT_EQ(std::vector<Nearest>(found.begin(), found.end()), brute_force(query, small, 1.0F));
}

}  // namespace
}  // namespace flirt
