#include "flirt/eval/distractors.hpp"

#include "tests/support/room_map.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace flirt {
namespace {

TEST(Distractors, EveryKthScanIsAskedAndNoneIsAnswerable) {
  const std::array<Point2, 4> corners{Point2{-9, -2}, Point2{9, -2}, Point2{9, 2}, Point2{-9, 2}};
  const ScanLog other = log_of(polygon(corners), poses_around(1.0, 7));
  const std::vector<LocalizationAnswer> answers = ask_distractors(other, room_map(), 3, {}, 1);
  ASSERT_EQ(answers.size(), 3U);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    EXPECT_EQ(answers[i].query, 3 * i);
    EXPECT_EQ(answers[i].strategy, "distractor");
    EXPECT_FALSE(answers[i].answerable);
    EXPECT_FALSE(answers[i].correct);
    EXPECT_NE(answers[i].verdict, "unique");
  }
}

TEST(Distractors, AreTheSameOnAnyNumberOfThreads) {
  const ScanLog other = log_of(furnished_room(), poses_around(0.7, 5));
  const auto one = ask_distractors(other, room_map(), 1, {}, 1);
  const auto three = ask_distractors(other, room_map(), 1, {}, 3);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].map_from_sensor, three[i].map_from_sensor);
    EXPECT_EQ(one[i].confidence, three[i].confidence);
  }
}

TEST(Distractors, SummaryCountsTheUniqueAndSortsByConfidence) {
  std::vector<LocalizationAnswer> answers(4);
  answers[0] = {.confidence = 0.95, .verdict = "unique"};
  answers[1] = {.confidence = 0.1, .verdict = "ambiguous"};
  answers[2] = {.confidence = 1.0, .verdict = "ambiguous"};
  answers[3] = {.verdict = "lost"};
  const DistractorSummary summary = summarise_distractors(answers);
  EXPECT_EQ(summary.unique.hits, 1U);
  EXPECT_EQ(summary.unique.total, 4U);
  EXPECT_EQ(summary.confidences, (std::array<std::size_t, 10>{1, 1, 0, 0, 0, 0, 0, 0, 0, 2}));
}

}  // namespace
}  // namespace flirt
