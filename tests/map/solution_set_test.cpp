#include "flirt/map/solution_set.hpp"

#include "flirt/features/extract.hpp"

#include "tests/support/room_map.hpp"
#include "tests/support/scenes.hpp"

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace flirt {
namespace {

Features features_of_room(const Pose2& map_from_sensor) {
  return extract(room_scan(map_from_sensor));
}

SolutionSet find_in(const PlaceMap& map, const Scan& scan, const SolutionSetParams& params = {}) {
  return SolutionSetFinder(map, params).find(extract(scan));
}

void expect_equal(const SolutionSet& a, const SolutionSet& b) {
  EXPECT_EQ(a.verdict, b.verdict);
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.confidence, b.confidence);
  ASSERT_EQ(a.hypotheses.size(), b.hypotheses.size());
  for (std::size_t i = 0; i < a.hypotheses.size(); ++i) {
    EXPECT_EQ(a.hypotheses[i].map_from_sensor, b.hypotheses[i].map_from_sensor);
    EXPECT_EQ(a.hypotheses[i].covariance, b.hypotheses[i].covariance);
    EXPECT_EQ(a.hypotheses[i].map_scan, b.hypotheses[i].map_scan);
    EXPECT_EQ(a.hypotheses[i].inliers, b.hypotheses[i].inliers);
    EXPECT_EQ(a.hypotheses[i].residual, b.hypotheses[i].residual);
    EXPECT_EQ(a.hypotheses[i].weight, b.hypotheses[i].weight);
  }
  ASSERT_EQ(a.places.size(), b.places.size());
}

void expect_lost(const SolutionSet& result, Reason reason) {
  EXPECT_EQ(result.verdict, Verdict::lost);
  EXPECT_EQ(to_string(result.reason), to_string(reason));
  EXPECT_EQ(result.confidence, 0);
  EXPECT_EQ(result.best(), nullptr);
  EXPECT_TRUE(result.hypotheses.empty());
}

TEST(SolutionSet, FindsThePoseInARoomToCentimetres) {
  for (const Pose2& truth : {Pose2{0.3, 0.2, 1.0}, Pose2{-0.6, 0.9, -2.8}, Pose2{1.0, -1.2, 0.1}}) {
    const SolutionSet result = find_in(room_map(), room_scan(truth));
    EXPECT_EQ(result.verdict, Verdict::unique);
    EXPECT_EQ(result.reason, Reason::clear_winner);
    ASSERT_NE(result.best(), nullptr);
    EXPECT_LT(distance(result.best()->map_from_sensor, truth), 0.05);
    EXPECT_LT(heading_difference(result.best()->map_from_sensor, truth), 0.02);
  }
}

TEST(SolutionSet, AnswersInTheFrameOfTheMap) {
  const Pose2 far_from_room{576, -3000, 2.5};
  std::vector<Pose2> poses = poses_around(1.2, 8);
  for (Pose2& pose : poses) { pose = far_from_room * pose; }
  const PlaceMap map = build_place_map(log_of(moved(furnished_room(), far_from_room), poses)).value();
  const Pose2 room_from_sensor{0.3, 0.2, 1.0};
  const SolutionSet near = find_in(room_map(), room_scan(room_from_sensor));
  const SolutionSet far = find_in(map, room_scan(room_from_sensor));
  ASSERT_NE(near.best(), nullptr);
  ASSERT_NE(far.best(), nullptr);
  EXPECT_TRUE(is_near(far.best()->map_from_sensor, far_from_room * near.best()->map_from_sensor, 1e-3, 1e-3));
  // The covariance turns with the frame: same eigenvalues, rotated axes.
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(far_from_room.theta).toRotationMatrix();
  const Eigen::Matrix2d expected = rotation * near.best()->covariance.topLeftCorner<2, 2>() * rotation.transpose();
  const Eigen::Matrix2d found = far.best()->covariance.topLeftCorner<2, 2>();
  EXPECT_TRUE(found.isApprox(expected, 0.05)) << found << "\n" << expected;
}

TEST(SolutionSet, TwinRoomsAreAmbiguousAndBothAreNamed) {
  const Pose2 map_from_twin{30, 5, 1.2};
  std::vector<Pose2> poses = poses_around(1.2, 6);
  for (const Pose2& pose : poses_around(1.2, 6)) { poses.push_back(map_from_twin * pose); }
  const Scene scene = joined(furnished_room(), moved(furnished_room(), map_from_twin));
  const PlaceMap map = build_place_map(log_of(scene, poses)).value();
  const Pose2 truth{0.3, 0.2, 1.0};
  const SolutionSet result = find_in(map, room_scan(truth));
  EXPECT_EQ(result.verdict, Verdict::ambiguous);
  EXPECT_EQ(result.reason, Reason::second_place_too_close);
  ASSERT_GE(result.places.size(), 2U);
  const auto pose_of = [&result](std::size_t place) {
    return result.hypotheses[result.places[place].hypothesis].map_from_sensor;
  };
  EXPECT_TRUE(is_near(pose_of(0), truth, 0.1, 0.03) || is_near(pose_of(1), truth, 0.1, 0.03));
  EXPECT_TRUE(is_near(pose_of(0), map_from_twin * truth, 0.1, 0.03) ||
              is_near(pose_of(1), map_from_twin * truth, 0.1, 0.03));
  EXPECT_NEAR(result.places[0].weight, result.places[1].weight, 0.15);
  EXPECT_LT(result.confidence, find_in(room_map(), room_scan(truth)).confidence);
}

TEST(SolutionSet, WeightsSumToOne) {
  const SolutionSet result = find_in(room_map(), room_scan({0.3, 0.2, 1.0}));
  ASSERT_GE(result.hypotheses.size(), 4U);
  double of_hypotheses = 0;
  double of_places = 0;
  std::uint32_t support = 0;
  for (const Hypothesis& hypothesis : result.hypotheses) { of_hypotheses += hypothesis.weight; }
  for (const Place& place : result.places) {
    of_places += place.weight;
    support += place.support;
  }
  EXPECT_NEAR(of_hypotheses, 1, 1e-12);
  EXPECT_NEAR(of_places, 1, 1e-12);
  EXPECT_EQ(support, result.hypotheses.size());
}

TEST(SolutionSet, CovariancesArePositiveDefinite) {
  for (const Hypothesis& hypothesis : find_in(room_map(), room_scan({0.3, 0.2, 1.0})).hypotheses) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(hypothesis.covariance);
    EXPECT_GT(solver.eigenvalues().minCoeff(), 0);
    EXPECT_TRUE(hypothesis.covariance.isApprox(hypothesis.covariance.transpose()));
  }
}

TEST(SolutionSet, HypothesesComeInTheOrderAskedFor) {
  const Scan scan = room_scan({0.3, 0.2, 1.0});
  const SolutionSet by_residual = find_in(room_map(), scan, {.order = HypothesisOrder::residual});
  EXPECT_TRUE(std::is_sorted(by_residual.hypotheses.begin(), by_residual.hypotheses.end(),
                             [](const auto& a, const auto& b) { return a.residual < b.residual; }));
  const SolutionSet by_inliers = find_in(room_map(), scan, {.order = HypothesisOrder::corresp});
  EXPECT_TRUE(std::is_sorted(by_inliers.hypotheses.begin(), by_inliers.hypotheses.end(),
                             [](const auto& a, const auto& b) { return a.inliers > b.inliers; }));
  EXPECT_EQ(by_residual.hypotheses.size(), by_inliers.hypotheses.size());
}

TEST(SolutionSet, TheLeastNumberOfInliersCutsTheSolutionSet) {
  const Scan scan = room_scan({0.3, 0.2, 1.0});
  SolutionSetParams params;
  const std::vector<Hypothesis> all = find_in(room_map(), scan, params).hypotheses;
  params.ransac.min_inliers = 8;
  const std::vector<Hypothesis> strong = find_in(room_map(), scan, params).hypotheses;
  ASSERT_FALSE(strong.empty());
  EXPECT_LE(strong.size(), all.size());
  for (const Hypothesis& hypothesis : strong) { EXPECT_GE(hypothesis.inliers, 8U); }
}

TEST(SolutionSet, GivesTheSameOnAnyNumberOfThreads) {
  const Scan scan = room_scan({0.3, 0.2, 1.0});
  SolutionSetParams params;
  params.ransac.sampling = Sampling::random;
  const SolutionSet one = SolutionSetFinder(room_map(), params, 1).find(extract(scan));
  for (const std::size_t threads : {2U, 3U, 8U}) {
    SCOPED_TRACE(threads);
    expect_equal(SolutionSetFinder(room_map(), params, threads).find(extract(scan)), one);
  }
}

TEST(SolutionSet, SketchesOfDescriptorsChangeNoBitOfIt) {
  std::vector<std::uint32_t> all(room_map().size());
  std::iota(all.begin(), all.end(), 0U);
  SolutionSetFinder plain(room_map());  // only `find` makes sketches
  SolutionSetFinder sketching(room_map());
  for (const Pose2& pose : poses_around(0.9, 7)) {
    const Features features = features_of_room(pose);
    const SolutionSet expected = plain.find_among(features, all);
    EXPECT_FALSE(expected.hypotheses.empty());
    expect_equal(sketching.find(features), expected);
  }
}

TEST(SolutionSet, RemembersNothingFromOneQueryToTheNext) {
  SolutionSetFinder finder(room_map());
  const SolutionSet first = finder.find(features_of_room({0.3, 0.2, 1.0}));
  (void)finder.find(features_of_room({-0.6, 0.9, -2.8}));
  expect_equal(finder.find(features_of_room({0.3, 0.2, 1.0})), first);
}

TEST(SolutionSet, ExcludedScansNeverAnswerAndChangeNoOther) {
  SolutionSetFinder finder(room_map());
  const Scan scan = room_scan({0.3, 0.2, 1.0});
  const SolutionSet all = finder.find(extract(scan));
  const ScanInterval excluded{2, 5};
  const SolutionSet rest = finder.find(extract(scan), excluded);
  std::vector<std::pair<std::uint32_t, Pose2>> expected;
  std::vector<std::pair<std::uint32_t, Pose2>> found;
  for (const Hypothesis& hypothesis : all.hypotheses) {
    if (!excluded.contains(hypothesis.map_scan)) {
      expected.emplace_back(hypothesis.map_scan, hypothesis.map_from_sensor);
    }
  }
  for (const Hypothesis& hypothesis : rest.hypotheses) {
    found.emplace_back(hypothesis.map_scan, hypothesis.map_from_sensor);
  }
  EXPECT_EQ(found, expected);
  EXPECT_LT(expected.size(), all.hypotheses.size());
}

TEST(SolutionSet, IsLostInAnEmptyMap) {
  expect_lost(find_in(PlaceMapBuilder().build(), room_scan({})), Reason::empty_map);
  SolutionSetFinder finder(room_map());
  expect_lost(finder.find(features_of_room({}), {0, room_map().size()}), Reason::empty_map);
}

TEST(SolutionSet, AMapOfOneScanAnswers) {
  const std::vector<Pose2> pose{{0.2, 0.1, 0.4}};
  const PlaceMap map = build_place_map(log_of(furnished_room(), pose)).value();
  const Pose2 truth{0.3, 0.2, 1.0};
  const SolutionSet result = find_in(map, room_scan(truth));
  ASSERT_EQ(result.hypotheses.size(), 1U);
  EXPECT_DOUBLE_EQ(result.hypotheses[0].weight, 1);
  EXPECT_TRUE(is_near(result.best()->map_from_sensor, truth, 0.05, 0.02));
}

TEST(SolutionSet, ScansWithoutFeaturesAreLostWithAReason) {
  Scan scan = room_scan({});
  const auto filled_with = [&scan](double range) {
    Scan filled = scan;
    std::fill(filled.ranges.begin(), filled.ranges.end(), range);
    return filled;
  };
  expect_lost(find_in(room_map(), filled_with(std::nan(""))), Reason::no_keypoints);
  expect_lost(find_in(room_map(), filled_with(std::numeric_limits<double>::infinity())), Reason::no_keypoints);
  expect_lost(find_in(room_map(), filled_with(0)), Reason::no_keypoints);
  scan.ranges.clear();
  expect_lost(find_in(room_map(), scan), Reason::no_keypoints);
}

TEST(SolutionSet, SomeReadingsThatAreNotNumbersDoNoHarm) {
  const Pose2 truth{0.3, 0.2, 1.0};
  Scan scan = room_scan(truth);
  for (std::size_t i = 0; i < scan.ranges.size(); i += 40) { scan.ranges[i] = std::nan(""); }
  const SolutionSet result = find_in(room_map(), scan);
  ASSERT_NE(result.best(), nullptr);
  EXPECT_TRUE(is_near(result.best()->map_from_sensor, truth, 0.1, 0.03));
}

// By hand: features on a unit grid whose descriptors are bins of their own.

Features features_at(std::span<const Point2> points, std::size_t first_bin) {
  Features features;
  features.descriptors.dimension = 16;
  features.descriptors.stride = 16;
  for (std::size_t k = 0; k < points.size(); ++k) {
    features.keypoints.push_back({.sensor_from_keypoint = {points[k].x, points[k].y, 0}});
    std::vector<float> row(16, 0.0F);
    row[first_bin + k] = 1.0F;
    features.descriptors.rows.insert(features.descriptors.rows.end(), row.begin(), row.end());
    features.descriptors.roots.insert(features.descriptors.roots.end(), row.begin(), row.end());
  }
  return features;
}

const std::vector<Point2> corners{{1, 0}, {4, 1}, {2, 5}, {-3, 2}};

PlaceMap map_of_corners() {
  PlaceMapBuilder builder;
  builder.add({.ranges = {1.0}}, {10, 20, 0}, features_at(corners, 0));
  return std::move(builder).build();
}

TEST(SolutionSet, TellsWhyItIsLost) {
  SolutionSetFinder finder(map_of_corners());
  const std::span<const Point2> all(corners);
  expect_lost(finder.find(features_at({}, 0)), Reason::no_keypoints);
  expect_lost(finder.find(features_at(all.first(2), 0)), Reason::few_keypoints);
  expect_lost(finder.find(features_at(all, 8)), Reason::no_match);
  const std::vector<Point2> elsewhere{{0, 0}, {9, 1}, {-7, 30}, {50, 2}};
  expect_lost(finder.find(features_at(elsewhere, 0)), Reason::few_inliers);
}

TEST(SolutionSet, FewAgreeingMapScansAreLittleSupport) {
  const std::vector<Pose2> pose{{0.2, 0.1, 0.4}};
  const PlaceMap map = build_place_map(log_of(furnished_room(), pose)).value();
  const SolutionSet result = find_in(map, room_scan({0.3, 0.2, 1.0}), {.half_support = 4, .min_confidence = 0.5});
  EXPECT_DOUBLE_EQ(result.confidence, 0.2);  // nothing against it, but 1 / (1 + 4)
  EXPECT_EQ(result.verdict, Verdict::ambiguous);
  EXPECT_EQ(result.reason, Reason::little_support);
}

TEST(SolutionSet, ConfidenceRisesWithSupport) {
  double before = 0;
  for (const std::size_t count : {1U, 2U, 4U, 8U}) {
    PlaceMapBuilder builder;
    for (std::size_t i = 0; i < count; ++i) { builder.add({.ranges = {1.0}}, {10, 20, 0}, features_at(corners, 0)); }
    const SolutionSet result = SolutionSetFinder(std::move(builder).build()).find(features_at(corners, 0));
    EXPECT_GT(result.confidence, before);
    EXPECT_LT(result.confidence, 1);
    before = result.confidence;
  }
}

TEST(SolutionSet, ComposesTheMatchWithThePoseOfTheMapScan) {
  SolutionSetFinder finder(map_of_corners());
  const Pose2 reference_from_query{0.5, -0.25, 0.5};
  std::vector<Point2> seen;
  for (const Point2 corner : corners) { seen.push_back(inverse(reference_from_query) * corner); }
  const SolutionSet result = finder.find(features_at(seen, 0));
  ASSERT_NE(result.best(), nullptr);
  const Pose2 expected{10.5, 19.75, 0.5};
  EXPECT_TRUE(is_near(result.best()->map_from_sensor, expected, 1e-4, 1e-4));
  EXPECT_EQ(result.best()->inliers, 4U);
}

}  // namespace
}  // namespace flirt
