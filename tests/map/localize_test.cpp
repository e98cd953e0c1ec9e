#include "flirt/map/localize.hpp"

#include "tests/support/room_map.hpp"
#include "tests/support/scenes.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace flirt {
namespace {

void expect_equal(const LocalizationResult& a, const LocalizationResult& b) {
  EXPECT_EQ(a.verdict, b.verdict);
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.confidence, b.confidence);
  ASSERT_EQ(a.hypotheses.size(), b.hypotheses.size());
  for (std::size_t i = 0; i < a.hypotheses.size(); ++i) {
    EXPECT_EQ(a.hypotheses[i].map_from_sensor, b.hypotheses[i].map_from_sensor);
    EXPECT_EQ(a.hypotheses[i].score, b.hypotheses[i].score);
    EXPECT_EQ(a.hypotheses[i].weight, b.hypotheses[i].weight);
  }
}

class LocalizeByEachMethod : public testing::TestWithParam<LocalizeMethod> {};

TEST_P(LocalizeByEachMethod, FindsThePoseInARoomToCentimetres) {
  for (const Pose2& truth : {Pose2{0.3, 0.2, 1.0}, Pose2{-0.6, 0.9, -2.8}, Pose2{1.0, -1.2, 0.1}}) {
    const LocalizationResult result = localize(room_map(), room_scan(truth), {.method = GetParam()});
    EXPECT_EQ(result.verdict, Verdict::unique);
    EXPECT_EQ(result.reason, Reason::clear_winner);
    ASSERT_NE(result.best(), nullptr);
    EXPECT_TRUE(is_near(result.best()->map_from_sensor, truth, 0.05, 0.02));
  }
}

TEST_P(LocalizeByEachMethod, WeightsSumToOneAndFallFromTheFirst) {
  const LocalizationResult result = localize(room_map(), room_scan({0.3, 0.2, 1.0}), {.method = GetParam()});
  double sum = 0;
  for (const PoseHypothesis& hypothesis : result.hypotheses) {
    sum += hypothesis.weight;
    EXPECT_LE(hypothesis.weight, result.hypotheses[0].weight + 1e-12);
  }
  EXPECT_NEAR(sum, 1, 1e-9);
}

TEST_P(LocalizeByEachMethod, CovariancesArePositiveDefinite) {
  for (const PoseHypothesis& hypothesis :
       localize(room_map(), room_scan({0.3, 0.2, 1.0}), {.method = GetParam()}).hypotheses) {
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(hypothesis.covariance).eigenvalues().minCoeff(), 0);
    EXPECT_TRUE(hypothesis.covariance.isApprox(hypothesis.covariance.transpose()));
  }
}

TEST_P(LocalizeByEachMethod, RemembersNothingFromOneQueryToTheNext) {
  Localizer localizer(room_map(), {.method = GetParam()});
  const LocalizationResult first = localizer.localize(room_scan({0.3, 0.2, 1.0}));
  (void)localizer.localize(room_scan({-0.6, 0.9, -2.8}), {2, 5});
  expect_equal(localizer.localize(room_scan({0.3, 0.2, 1.0})), first);
}

TEST_P(LocalizeByEachMethod, ExcludedScansAreAsIfTheyHadNeverBeenThere) {
  std::vector<Pose2> some = poses_around(1.2, 8);
  some.erase(some.begin() + 2, some.begin() + 5);
  const PlaceMap without = build_place_map(log_of(furnished_room(), some)).value();
  Localizer localizer(room_map(), {.method = GetParam()});
  const Scan scan = room_scan({0.3, 0.2, 1.0});
  (void)localizer.localize(scan, {0, 3});
  expect_equal(localizer.localize(scan, {2, 5}), localize(without, scan, {.method = GetParam()}));
}

TEST_P(LocalizeByEachMethod, IsLostInAnEmptyMap) {
  const LocalizeParams params{.method = GetParam()};
  Localizer localizer(room_map(), params);
  for (const LocalizationResult& result : {localize(PlaceMapBuilder().build(), room_scan({}), params),
                                           localizer.localize(room_scan({}), {0, room_map().size()})}) {
    EXPECT_EQ(result.verdict, Verdict::lost);
    EXPECT_EQ(result.reason, Reason::empty_map);
    EXPECT_EQ(result.best(), nullptr);
    EXPECT_EQ(result.confidence, 0);
  }
}

TEST_P(LocalizeByEachMethod, ScansWithoutReadingsAreLostWithAReason) {
  Scan scan = room_scan({});
  for (const double range : {std::nan(""), std::numeric_limits<double>::infinity(), 0.0, -1.0}) {
    std::ranges::fill(scan.ranges, range);
    const LocalizationResult result = localize(room_map(), scan, {.method = GetParam()});
    EXPECT_EQ(result.verdict, Verdict::lost);
    EXPECT_EQ(result.best(), nullptr);
  }
  scan.ranges.clear();
  EXPECT_EQ(localize(room_map(), scan, {.method = GetParam()}).verdict, Verdict::lost);
}

TEST_P(LocalizeByEachMethod, TakesTheTimeOfItsStages) {
  LocalizeTimes times;
  (void)localize(room_map(), room_scan({}), {.method = GetParam()}, &times);
  EXPECT_GT(times.total_us(), 0);
  EXPECT_EQ(times.match_us > 0, GetParam() == LocalizeMethod::papers || GetParam() == LocalizeMethod::features);
  EXPECT_EQ(times.search_us > 0, GetParam() != LocalizeMethod::papers);
}

INSTANTIATE_TEST_SUITE_P(Methods, LocalizeByEachMethod,
                         testing::Values(LocalizeMethod::automatic, LocalizeMethod::dense, LocalizeMethod::features,
                                         LocalizeMethod::papers),
                         [](const auto& method) { return std::string(to_string(method.param)); });

TEST(Localize, AnswersInTheFrameOfTheMap) {
  const Pose2 far_from_room{576, -3000, 2.5};
  std::vector<Pose2> poses = poses_around(1.2, 8);
  for (Pose2& pose : poses) { pose = far_from_room * pose; }
  const PlaceMap map = build_place_map(log_of(moved(furnished_room(), far_from_room), poses)).value();
  const Pose2 truth = far_from_room * Pose2{0.3, 0.2, 1.0};
  const LocalizationResult found =
      localize(map, scan_of(moved(furnished_room(), far_from_room), truth, turn_beams(), turn_beam_count));
  EXPECT_EQ(found.verdict, Verdict::unique);
  ASSERT_NE(found.best(), nullptr);
  EXPECT_TRUE(is_near(found.best()->map_from_sensor, truth, 0.05, 0.02));
}

TEST(Localize, TwinRoomsAreAmbiguousAndBothAreNamed) {
  const Pose2 map_from_twin{30, 5, 1.2};
  std::vector<Pose2> poses = poses_around(1.2, 6);
  for (const Pose2& pose : poses_around(1.2, 6)) { poses.push_back(map_from_twin * pose); }
  const Scene scene = joined(furnished_room(), moved(furnished_room(), map_from_twin));
  const PlaceMap map = build_place_map(log_of(scene, poses)).value();
  const Pose2 truth{0.3, 0.2, 1.0};
  const LocalizationResult result = localize(map, room_scan(truth));
  EXPECT_EQ(result.verdict, Verdict::ambiguous);
  EXPECT_EQ(result.reason, Reason::second_place_too_close);
  ASSERT_GE(result.hypotheses.size(), 2U);
  const Pose2& first = result.hypotheses[0].map_from_sensor;
  const Pose2& second = result.hypotheses[1].map_from_sensor;
  EXPECT_TRUE(is_near(first, truth, 0.1, 0.03) || is_near(second, truth, 0.1, 0.03));
  EXPECT_TRUE(is_near(first, map_from_twin * truth, 0.1, 0.03) || is_near(second, map_from_twin * truth, 0.1, 0.03));
  EXPECT_GT(result.hypotheses[1].weight, 0.1);
}

/// Posts as thin as legs.
Scene posts(std::span<const Point2> places) {
  Scene scene;
  for (const Point2& place : places) { scene = joined(std::move(scene), box({place.x, place.y, 0.2}, 0.12, 0.12)); }
  return scene;
}

/// The furnished room with five posts, and its twin without them.
struct RoomsThatPostsTellApart {
  Scene posted =
      joined(furnished_room(), posts(std::vector<Point2>{{2, -1}, {-1.5, 2}, {-3, 0.2}, {0.4, -2.4}, {0.9, 2.6}}));
  PlaceMap map = build_place_map([this] {
                   const Pose2 map_from_twin{30, 5, 1.2};
                   std::vector<Pose2> poses = poses_around(1.2, 6);
                   for (const Pose2& pose : poses_around(1.2, 6)) { poses.push_back(map_from_twin * pose); }
                   return log_of(joined(posted, moved(furnished_room(), map_from_twin)), poses);
                 }())
                     .value();
};

TEST(Localize, AFewPostsTellTwinRoomsApart) {
  const RoomsThatPostsTellApart rooms;
  const Pose2 truth{0.3, 0.2, 1.0};
  const Scan scan = scan_of(rooms.posted, truth, turn_beams(), turn_beam_count);
  EXPECT_EQ(localize(rooms.map, scan, {.few_legs = 0}).verdict, Verdict::ambiguous);
  const LocalizationResult result = localize(rooms.map, scan);
  EXPECT_EQ(result.verdict, Verdict::unique);
  ASSERT_NE(result.best(), nullptr);
  EXPECT_TRUE(is_near(result.best()->map_from_sensor, truth, 0.05, 0.02));
}

TEST(Localize, ACrowdIsNotTakenForFurniture) {
  const RoomsThatPostsTellApart rooms;
  const Pose2 truth{0.3, 0.2, 1.0};
  std::vector<Point2> people;
  for (const Pose2& pose : poses_around(1.5, 12)) { people.push_back(pose.translation()); }
  const Scan scan = scan_of(joined(rooms.posted, posts(people)), truth, turn_beams(), turn_beam_count);
  expect_equal(localize(rooms.map, scan), localize(rooms.map, scan, {.few_legs = 0}));
  EXPECT_GT(localize(rooms.map, scan, {.few_legs = 1}).confidence, localize(rooms.map, scan).confidence);
}

TEST(Localize, ScansOfAnotherRoomAreNotUnique) {
  Scan scan = room_scan({0.3, 0.2, 1.0});
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    scan.ranges[i] = 2.0 + 1.5 * std::sin(0.05 * static_cast<double>(i));
  }
  const LocalizationResult result = localize(room_map(), scan);
  EXPECT_NE(result.verdict, Verdict::unique);
  EXPECT_LT(result.confidence, 0.5);
}

TEST(Localize, SomeReadingsThatAreNotNumbersDoNoHarm) {
  const Pose2 truth{0.3, 0.2, 1.0};
  Scan scan = room_scan(truth);
  for (std::size_t i = 0; i < scan.ranges.size(); i += 40) { scan.ranges[i] = std::nan(""); }
  const LocalizationResult result = localize(room_map(), scan);
  ASSERT_NE(result.best(), nullptr);
  EXPECT_TRUE(is_near(result.best()->map_from_sensor, truth, 0.1, 0.03));
}

}  // namespace
}  // namespace flirt
