#include "flirt/match/ransac.hpp"

#include "tests/match/random_features.hpp"
#include "tests/support/print.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace flirt {
namespace {

void expect_near(const Pose2& found, const Pose2& expected, double tolerance) {
  EXPECT_LT(distance(found, expected), tolerance);
  EXPECT_LT(heading_difference(found, expected), tolerance);
}

/// Both ways of sampling and both rules of support.
class EachRansac : public testing::TestWithParam<std::tuple<Sampling, InlierRule>> {
 protected:
  static RansacParams params() {
    RansacParams params;
    std::tie(params.sampling, params.inlier_rule) = GetParam();
    return params;
  }
};
INSTANTIATE_TEST_SUITE_P(Ransac, EachRansac,
                         testing::Combine(testing::Values(Sampling::random, Sampling::exhaustive),
                                          testing::Values(InlierRule::nearest_point, InlierRule::one_to_one)),
                         [](const auto& instance) {
                           return std::string(to_string(std::get<0>(instance.param))) +
                                  (std::get<1>(instance.param) == InlierRule::one_to_one ? "_one_to_one"
                                                                                         : "_nearest_point");
                         });

TEST_P(EachRansac, FindsTheExactMotionAmongSeventyPercentOutliers) {
  RansacParams with = params();
  with.success_probability = 0.9999;
  Rng rng(1);
  for (int trial = 0; trial < 50; ++trial) {
    const test::Scene scene = test::random_scene(rng, {.right = 12, .wrong = 28, .extent = 30.0});
    const auto found = align(scene.query, scene.reference, scene.matches, with);
    ASSERT_TRUE(found);
    expect_near(found->reference_from_query, scene.reference_from_query, 0.02);
    std::size_t right = 0;
    for (const Match& match : found->inliers) { right += match.query < 12 && match.reference == match.query ? 1U : 0U; }
    EXPECT_EQ(right, 12U);
  }
}

TEST_P(EachRansac, IsExactWhenAllMatchesAreRight) {
  Rng rng(2);
  for (int trial = 0; trial < 50; ++trial) {
    const test::Scene scene = test::random_scene(rng, {.right = 10});
    const auto found = align(scene.query, scene.reference, scene.matches, params());
    ASSERT_TRUE(found);
    expect_near(found->reference_from_query, scene.reference_from_query, 1e-5);
    EXPECT_EQ(found->inliers.size(), 10U);
    EXPECT_LT(found->residual, 1e-10);
  }
}

TEST_P(EachRansac, ReturnsNothingWhenMatchesDisagree) {
  const std::vector<Point2> seen{{0, 0}, {1, 0}, {0, 2}, {4, 4}};
  const std::vector<Point2> elsewhere{{0, 0}, {10, 0}, {0, 20}, {40, 40}};  // ten times larger: no two lengths agree
  Features query;
  Features reference;
  std::vector<Match> matches;
  Rng rng(3);
  query.descriptors = reference.descriptors = test::random_descriptors(rng, 4, 48);
  for (std::uint32_t i = 0; i < 4; ++i) {
    query.keypoints.push_back({.sensor_from_keypoint = {seen[i].x, seen[i].y, 0}});
    reference.keypoints.push_back({.sensor_from_keypoint = {elsewhere[i].x, elsewhere[i].y, 0}});
    matches.push_back({i, i, 0.1F});
  }
  EXPECT_FALSE(align(query, reference, matches, params()));
}

TEST_P(EachRansac, ReturnsNothingForFewerThanTwoMatches) {
  Rng rng(4);
  const test::Scene scene = test::random_scene(rng, {.right = 5});
  EXPECT_FALSE(align(scene.query, scene.reference, {}, params()));
  EXPECT_FALSE(align(scene.query, scene.reference, std::span(scene.matches).first(1), params()));
  EXPECT_FALSE(align({}, {}, {}, params()));
}

TEST_P(EachRansac, ReturnsNothingForOneMatchRepeated) {
  Rng rng(5);
  const test::Scene scene = test::random_scene(rng, {.right = 5});
  const std::vector<Match> repeated(6, scene.matches[0]);
  EXPECT_FALSE(align(scene.query, scene.reference, repeated, params()));
}

TEST_P(EachRansac, ReturnsNothingForPointsThatCoincide) {
  Rng rng(6);
  test::Scene scene = test::random_scene(rng, {.right = 6});
  for (Keypoint& keypoint : scene.reference.keypoints) { keypoint.sensor_from_keypoint = {1, 1, 0}; }
  EXPECT_FALSE(align(scene.query, scene.reference, scene.matches, params()));
  for (Keypoint& keypoint : scene.query.keypoints) { keypoint.sensor_from_keypoint = {2, 2, 0}; }
  EXPECT_FALSE(align(scene.query, scene.reference, scene.matches, params()));
}

TEST_P(EachRansac, TwoMatchesSufficeWhenTwoInliersDo) {
  Rng rng(7);
  const test::Scene scene = test::random_scene(rng, {.right = 2, .extent = 8.0});
  RansacParams with = params();
  EXPECT_FALSE(align(scene.query, scene.reference, scene.matches, with)) << "three are asked for";
  with.min_inliers = 2;
  const auto found = align(scene.query, scene.reference, scene.matches, with);
  ASSERT_TRUE(found);
  expect_near(found->reference_from_query, scene.reference_from_query, 1e-5);
}

TEST_P(EachRansac, DoesNotDependOnTheOrderOfMatchesNorOnDuplicates) {
  Rng rng(8);
  test::Scene scene = test::random_scene(rng, {.right = 8, .wrong = 10, .noise = 0.03});
  const auto first = align(scene.query, scene.reference, scene.matches, params());
  ASSERT_TRUE(first);
  std::ranges::reverse(scene.matches);
  scene.matches.insert(scene.matches.end(), scene.matches.begin(), scene.matches.begin() + 5);
  const auto again = align(scene.query, scene.reference, scene.matches, params());
  ASSERT_TRUE(again);
  EXPECT_EQ(first->reference_from_query, again->reference_from_query);
  EXPECT_EQ(first->inliers, again->inliers);
  EXPECT_EQ(first->residual, again->residual);
  EXPECT_EQ(first->covariance, again->covariance);
}

TEST_P(EachRansac, IsDeterminedByItsSeed) {
  Rng rng(9);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const test::Scene scene = test::random_scene(rng, {.right = 5, .wrong = 25, .noise = 0.05});
    RansacParams with = params();
    with.seed = seed;
    const auto first = align(scene.query, scene.reference, scene.matches, with);
    const auto again = align(scene.query, scene.reference, scene.matches, with);
    ASSERT_EQ(first.has_value(), again.has_value());
    if (first) { EXPECT_EQ(first->reference_from_query, again->reference_from_query); }
  }
}

TEST_P(EachRansac, LeavesOutKeypointsThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  Rng rng(10);
  test::Scene scene = test::random_scene(rng, {.right = 12});
  scene.query.keypoints[0].sensor_from_keypoint = {nan, 1, 0};
  scene.query.keypoints[1].sensor_from_keypoint = {1, infinity, 0};
  scene.query.keypoints[2].sensor_from_keypoint.theta = nan;
  scene.reference.keypoints[0].sensor_from_keypoint = {nan, nan, nan};
  scene.reference.keypoints[3].sensor_from_keypoint = {1e300, 0, 0};
  scene.matches[4].distance = std::numeric_limits<float>::quiet_NaN();
  RansacParams with = params();
  with.success_probability = 0.999;
  const auto found = align(scene.query, scene.reference, scene.matches, with);
  ASSERT_TRUE(found);
  expect_near(found->reference_from_query, scene.reference_from_query, 1e-5);
  EXPECT_TRUE(found->covariance.allFinite());
  for (const Match& match : found->inliers) { EXPECT_GT(match.query, 3U); }
  EXPECT_EQ(found->inliers.size(), with.inlier_rule == InlierRule::one_to_one ? 7U : 8U);
  // The four that cannot take part count as missed.
  EXPECT_NEAR(found->residual, 0.0599 * (12.0 - static_cast<double>(found->inliers.size())) / 12.0, 1e-6);
}

TEST_P(EachRansac, ReturnsNothingWhenNoKeypointIsFinite) {
  Rng rng(11);
  test::Scene scene = test::random_scene(rng, {.right = 8});
  for (Keypoint& keypoint : scene.query.keypoints) { keypoint.sensor_from_keypoint.x = std::nan(""); }
  EXPECT_FALSE(align(scene.query, scene.reference, scene.matches, params()));
}

TEST_P(EachRansac, MovesWithTheReferenceFrame) {
  Rng rng(12);
  test::Scene scene = test::random_scene(rng, {.right = 10, .wrong = 10, .noise = 0.02});
  const auto before = align(scene.query, scene.reference, scene.matches, params());
  const Pose2 other_from_reference{4, -2, 1.9};
  for (Keypoint& keypoint : scene.reference.keypoints) {
    keypoint.sensor_from_keypoint = other_from_reference * keypoint.sensor_from_keypoint;
  }
  const auto after = align(scene.query, scene.reference, scene.matches, params());
  ASSERT_TRUE(before && after);
  expect_near(after->reference_from_query, other_from_reference * before->reference_from_query, 1e-4);
  EXPECT_EQ(before->inliers, after->inliers);
}

/// Residual and inliers by the definition, in double precision.
TEST(Ransac, ResidualIsTheMeanTruncatedSquaredDistanceOverAllQueryKeypoints) {
  Rng rng(13);
  for (int trial = 0; trial < 30; ++trial) {
    const test::Scene scene = test::random_scene(rng, {.right = 10, .wrong = 15, .noise = 0.05, .extent = 6.0});
    const auto found = align(scene.query, scene.reference, scene.matches);
    ASSERT_TRUE(found);
    double sum = 0.0;
    std::size_t inliers = 0;
    for (const Keypoint& q : scene.query.keypoints) {
      double squared = 0.0599;
      for (const Keypoint& r : scene.reference.keypoints) {
        const Point2 moved = found->reference_from_query * q.sensor_from_keypoint.translation();
        squared = std::min(squared, squared_norm(moved - r.sensor_from_keypoint.translation()));
      }
      sum += squared;
      inliers += squared < 0.0599 ? 1U : 0U;
    }
    EXPECT_NEAR(found->residual, sum / 25.0, 1e-6);
    EXPECT_EQ(found->inliers.size(), inliers);
  }
}

TEST(Ransac, OneToOneUsesNoKeypointTwice) {
  Rng rng(14);
  test::Scene scene = test::random_scene(rng, {.right = 10, .noise = 0.02});
  for (std::uint32_t i = 0; i < 5; ++i) {  // twins of five query keypoints, matched to the same references
    scene.query.keypoints.push_back(scene.query.keypoints[i]);
    scene.query.keypoints.back().sensor_from_keypoint.x += 0.01;
    scene.matches.push_back({10 + i, i, 0.3F});
  }
  scene.query.descriptors = test::random_descriptors(rng, 15, 48);
  const auto many = align(scene.query, scene.reference, scene.matches);
  const auto few = align(scene.query, scene.reference, scene.matches, {.inlier_rule = InlierRule::one_to_one});
  ASSERT_TRUE(many && few);
  EXPECT_EQ(many->inliers.size(), 15U);
  EXPECT_EQ(few->inliers.size(), 10U);
  std::vector<std::uint32_t> references;
  for (const Match& match : few->inliers) { references.push_back(match.reference); }
  std::ranges::sort(references);
  EXPECT_EQ(std::ranges::adjacent_find(references), references.end());
}

TEST(Ransac, ExhaustiveSamplingIsNeverWorseThanRandom) {
  Rng rng(15);
  for (int trial = 0; trial < 100; ++trial) {
    const test::Scene scene = test::random_scene(rng, {.right = 4, .wrong = 30, .noise = 0.03, .extent = 15.0});
    RansacParams params;
    params.max_turn_difference = std::numbers::pi;
    params.sampling = Sampling::random;
    const auto random = align(scene.query, scene.reference, scene.matches, params);
    params.sampling = Sampling::exhaustive;
    const auto all = align(scene.query, scene.reference, scene.matches, params);
    if (random) {
      ASSERT_TRUE(all);
      EXPECT_LE(all->residual, random->residual + 2e-3);  // refinement may swap two close ones
    }
  }
}

TEST(Ransac, MaxSamplesBoundsTheSearchToTheBestCandidates) {
  Rng rng(16);
  test::Scene scene = test::random_scene(rng, {.right = 6, .wrong = 6});
  for (Match& match : scene.matches) { match.distance = match.query < 6 ? 0.3F : 0.1F; }
  EXPECT_TRUE(align(scene.query, scene.reference, scene.matches, {.sampling = Sampling::exhaustive}));
  EXPECT_FALSE(align(scene.query, scene.reference, scene.matches,
                     {.sampling = Sampling::exhaustive, .max_samples = 15, .min_inliers = 6}))
      << "the 15 pairs of the six closest are all wrong";
}

TEST(Ransac, OfEquallyGoodMotionsTakesThatOfTheNearerDescriptorsInWhateverOrderTheyCome) {
  Features query;
  Features reference;
  for (const double x : {0.0, 1.0}) { query.keypoints.push_back({.sensor_from_keypoint = {x, 0, 0}}); }
  for (const double x : {0.0, 1.0, 16.0, 17.0}) { reference.keypoints.push_back({.sensor_from_keypoint = {x, 0, 0}}); }
  Rng rng(17);
  query.descriptors = test::random_descriptors(rng, 2, 48);
  reference.descriptors = test::random_descriptors(rng, 4, 48);
  for (const bool far_is_nearer : {false, true}) {  // far away, but of nearer descriptors
    const float far = far_is_nearer ? 0.1F : 0.3F;
    std::vector<Match> matches{{0, 0, 0.2F}, {0, 2, far}, {1, 1, 0.2F}, {1, 3, far}};
    for (const std::uint32_t samples : {1U, 5000U}) {  // with so few the order of descriptors is that of the search
      const auto found = align(query, reference, matches, {.max_samples = samples, .min_inliers = 2});
      ASSERT_TRUE(found);
      EXPECT_EQ(found->reference_from_query, (Pose2{far_is_nearer ? 16.0 : 0.0, 0.0, 0.0}));
    }
  }
}

TEST(Ransac, TurnCheckRejectsKeypointsThatPointElsewhere) {
  Rng rng(17);
  test::Scene scene = test::random_scene(rng, {.right = 8});
  RansacParams params{.max_turn_difference = 0.3};
  EXPECT_TRUE(align(scene.query, scene.reference, scene.matches, params));
  for (Keypoint& keypoint : scene.reference.keypoints) {
    keypoint.sensor_from_keypoint.theta = wrap_angle(keypoint.sensor_from_keypoint.theta + 0.5);
  }
  EXPECT_FALSE(align(scene.query, scene.reference, scene.matches, params));
  params.max_turn_difference = 0.6;
  EXPECT_TRUE(align(scene.query, scene.reference, scene.matches, params));
  params.sampling = Sampling::random;
  EXPECT_TRUE(align(scene.query, scene.reference, scene.matches, params));
  params.max_turn_difference = 0.3;
  EXPECT_FALSE(align(scene.query, scene.reference, scene.matches, params));
}

TEST(Ransac, CovarianceIsThatOfItsInliers) {
  Rng rng(18);
  const test::Scene scene = test::random_scene(rng, {.right = 9, .noise = 0.02});
  for (const double deviation : {0.05, 0.0}) {
    const auto found = align(scene.query, scene.reference, scene.matches, {.keypoint_deviation = deviation});
    ASSERT_TRUE(found);
    std::vector<PointPair> pairs;
    for (const Match& match : found->inliers) {
      pairs.push_back({scene.query.keypoints[match.query].sensor_from_keypoint.translation(),
                       scene.reference.keypoints[match.reference].sensor_from_keypoint.translation()});
    }
    const double used = deviation > 0.0 ? deviation : deviation_from_residuals(pairs, found->reference_from_query);
    EXPECT_TRUE(found->covariance.isApprox(rigid_covariance(pairs, used), 1e-3));
  }
}

TEST(Ransac, InliersThatWereNoCandidatesCarryTheDistanceOfTheirDescriptors) {
  Rng rng(19);
  test::Scene scene = test::random_scene(rng, {.right = 8});
  scene.reference.descriptors = test::random_descriptors(rng, 8, 48);
  scene.matches.resize(4);
  const auto found = align(scene.query, scene.reference, scene.matches);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->inliers.size(), 8U);
  EXPECT_EQ(found->inliers[2], scene.matches[2]);
  EXPECT_EQ(found->inliers[6].distance, descriptor_distance(Distance::chi_square, rows_of(scene.query.descriptors), 6,
                                                            rows_of(scene.reference.descriptors), 6));
}

TEST(IterationsNeeded, IsThePapersCount) {
  EXPECT_EQ(iterations_needed(0.3, 0.95), 32U);
  EXPECT_EQ(iterations_needed(0.4, 0.95), 18U);
  EXPECT_EQ(iterations_needed(0.5, 0.95), 11U);
  EXPECT_EQ(iterations_needed(1.0, 0.95), 1U);
}

TEST(RansacParams, DefaultsAreWithinTheirRanges) {
  EXPECT_EQ(out_of_range(RansacParams{}), "");
}

}  // namespace
}  // namespace flirt
