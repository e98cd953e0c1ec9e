#include "flirt/match/pair_matcher.hpp"

#include "tests/match/random_features.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace flirt {
namespace {

/// Scans back to back, as a map holds them.
struct Columns {
  KeypointTable keypoints;
  Descriptors descriptors;
  std::vector<std::size_t> begin{0};

  void append(const Features& features) {
    const KeypointTable table = table_of(features.keypoints);
    const auto join = [](std::vector<float>& all, const std::vector<float>& more) {
      all.insert(all.end(), more.begin(), more.end());
    };
    join(keypoints.x, table.x);
    join(keypoints.y, table.y);
    join(keypoints.theta, table.theta);
    join(descriptors.rows, features.descriptors.rows);
    join(descriptors.roots, features.descriptors.roots);
    descriptors.dimension = features.descriptors.dimension;
    descriptors.stride = features.descriptors.stride;
    begin.push_back(keypoints.x.size());
  }
  [[nodiscard]] FeatureColumns scan(std::size_t i) const {
    const std::size_t count = begin[i + 1] - begin[i];
    const auto part = [&](const std::vector<float>& column) { return std::span(column).subspan(begin[i], count); };
    DescriptorRows rows = rows_of(descriptors);
    rows.rows += begin[i] * rows.stride;
    rows.roots += begin[i] * rows.stride;
    rows.count = static_cast<std::uint32_t>(count);
    return {{part(keypoints.x), part(keypoints.y), part(keypoints.theta)}, rows};
  }
};

TEST(PairMatcher, EqualsMatchAndAlignWhateverCameBefore) {
  Rng rng(1);
  std::vector<test::Scene> scenes;
  Columns queries;
  Columns references;
  for (int i = 0; i < 12; ++i) {
    scenes.push_back(test::random_scene(rng, {.right = 3 + rng.below(30), .wrong = rng.below(20), .noise = 0.03}));
    queries.append(scenes.back().query);
    references.append(scenes.back().reference);
  }
  for (const auto& [strategy, name] : enum_names(MatchStrategy{})) {
    const MatchParams match_params{.strategy = strategy};
    PairMatcher matcher(match_params);
    int found = 0;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      matcher.set_query(queries.scan(i));
      for (std::size_t j = 0; j < scenes.size(); ++j) {
        const auto pair = matcher.align(references.scan(j));
        const auto matches = match(scenes[i].query, scenes[j].reference, match_params);
        const auto candidates = matcher.candidates();
        ASSERT_EQ(std::vector<Match>(candidates.begin(), candidates.end()), matches) << name;
        const auto expected = align(scenes[i].query, scenes[j].reference, matches);
        ASSERT_EQ(pair.has_value(), expected.has_value());
        if (!pair) { continue; }
        ++found;
        const Alignment details = matcher.details(*pair);
        EXPECT_EQ(pair->reference_from_query, expected->reference_from_query);
        EXPECT_EQ(pair->residual, expected->residual);
        EXPECT_EQ(pair->inliers, expected->inliers.size());
        EXPECT_EQ(details.inliers, expected->inliers);
        EXPECT_EQ(details.covariance, expected->covariance);
      }
    }
    EXPECT_GE(found, 12) << name;
  }
}

TEST(PairMatcher, FindsNothingInEmptyScans) {
  Rng rng(2);
  const test::Scene scene = test::random_scene(rng, {.right = 10});
  Columns columns;
  columns.append(scene.query);
  columns.append({});
  columns.descriptors.dimension = scene.query.descriptors.dimension;
  columns.descriptors.stride = scene.query.descriptors.stride;
  PairMatcher matcher;
  matcher.set_query(columns.scan(1));
  EXPECT_FALSE(matcher.align(columns.scan(0)));
  matcher.set_query(columns.scan(0));
  EXPECT_FALSE(matcher.align(columns.scan(1)));
  EXPECT_TRUE(matcher.align(columns.scan(0)));
}

}  // namespace
}  // namespace flirt
