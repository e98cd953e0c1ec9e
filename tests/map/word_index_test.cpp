#include "flirt/map/word_index.hpp"

#include "flirt/features/extract.hpp"
#include "flirt/map/solution_set.hpp"

#include "tests/support/room_map.hpp"
#include "tests/support/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace flirt {
namespace {

using testing::Contains;
using testing::ElementsAreArray;
using testing::IsEmpty;
using testing::SizeIs;

constexpr WordParams few_words{.words = 32, .samples = 500, .rounds = 3, .query_words = 2, .candidates = 5};

Features features_of_map_scan(const PlaceMap& map, std::size_t i) {
  return extract(map.scan(i), map.feature_params());
}

/// The furnished room with eight scans (0 .. 7), and far from it a narrow hall with niches, with eight more.
struct TwoRooms {
  Scene scene{furnished_room()};
  std::vector<Pose2> poses{poses_around(1.2, 8)};
  Pose2 map_from_hall{100.0, 0.0, 0.0};

  TwoRooms() {
    Scene hall = box({0, 0, 0}, 14.0, 4.0);
    for (const double x : {-5.0, -3.0, 3.0, 5.0}) { hall = joined(hall, box({x, 1.7, 0}, 0.5, 0.3)); }
    scene = joined(scene, moved(hall, map_from_hall));
    for (const Pose2& hall_from_sensor : poses_around(1.2, 8)) { poses.push_back(map_from_hall * hall_from_sensor); }
  }
};

TEST(WordIndex, LeavesMapScansOfTheRoomThatIsAskedBeforeThoseOfAnother) {
  const TwoRooms rooms;
  const PlaceMap map = build_place_map(log_of(rooms.scene, rooms.poses)).value();
  const WordIndex index(map, {.words = 32, .samples = 500, .rounds = 3, .query_words = 2, .candidates = 8});
  const auto left_in_hall = [&](const Pose2& map_from_sensor) {
    const Scan scan = scan_of(rooms.scene, map_from_sensor, turn_beams(), turn_beam_count);
    return std::ranges::count_if(index.most_alike(extract(scan)), [](std::uint32_t i) { return i >= 8; });
  };
  EXPECT_LE(left_in_hall({0.4, 0.3, 0.7}), 1);
  EXPECT_GE(left_in_hall(rooms.map_from_hall * Pose2{0.4, 0.3, 0.7}), 7);
}

TEST(WordIndex, LeavesAsManyMapScansAsAskedInAscendingOrder) {
  const PlaceMap map = room_map();
  ASSERT_GT(map.size(), few_words.candidates);
  const std::vector<std::uint32_t> left = WordIndex(map, few_words).most_alike(features_of_map_scan(map, 0));
  EXPECT_THAT(left, SizeIs(few_words.candidates));
  EXPECT_TRUE(std::ranges::is_sorted(left));
  EXPECT_EQ(std::ranges::adjacent_find(left), left.end());
}

TEST(WordIndex, IsTheSameOnAnyNumberOfThreads) {
  const PlaceMap map = room_map();
  const WordIndex one(map, few_words, 1);
  const WordIndex three(map, few_words, 3);
  for (std::size_t scan = 0; scan < map.size(); ++scan) {
    const Features features = features_of_map_scan(map, scan);
    EXPECT_THAT(three.most_alike(features), ElementsAreArray(one.most_alike(features)));
  }
}

TEST(WordIndex, OfAnEmptyMapLeavesNothing) {
  const PlaceMap map = PlaceMapBuilder().build();
  EXPECT_THAT(WordIndex(map).most_alike(features_of_map_scan(room_map(), 0)), IsEmpty());
}

TEST(WordIndex, LeavesNothingForAScanWithoutKeypoints) {
  EXPECT_THAT(WordIndex(room_map(), few_words).most_alike({}), IsEmpty());
}

TEST(SolutionSet, AmongAllMapScansIsThatOfTheWholeMap) {
  const PlaceMap map = room_map();
  const Features features = features_of_map_scan(map, 1);
  std::vector<std::uint32_t> all(map.size());
  std::iota(all.begin(), all.end(), 0U);
  SolutionSetFinder finder(map);
  const SolutionSet whole = finder.find(features);
  const SolutionSet among = finder.find_among(features, all);
  ASSERT_EQ(among.hypotheses.size(), whole.hypotheses.size());
  ASSERT_FALSE(whole.hypotheses.empty());
  EXPECT_EQ(among.confidence, whole.confidence);
  EXPECT_EQ(among.best()->map_from_sensor, whole.best()->map_from_sensor);
  for (std::size_t i = 0; i < whole.hypotheses.size(); ++i) {
    EXPECT_EQ(among.hypotheses[i].map_scan, whole.hypotheses[i].map_scan);
    EXPECT_EQ(among.hypotheses[i].residual, whole.hypotheses[i].residual);
  }
}

TEST(SolutionSet, AmongSomeMapScansHasHypothesesOfThoseAlone) {
  const PlaceMap map = room_map();
  const std::vector<std::uint32_t> some{1, 2};
  const SolutionSet found = SolutionSetFinder(map).find_among(features_of_map_scan(map, 1), some);
  ASSERT_FALSE(found.hypotheses.empty());
  for (const Hypothesis& hypothesis : found.hypotheses) { EXPECT_THAT(some, Contains(hypothesis.map_scan)); }
}

}  // namespace
}  // namespace flirt
