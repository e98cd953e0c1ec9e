#include "flirt/eval/statistics.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace flirt {
namespace {

TEST(Rate, WilsonIntervalMatchesWorkedExamples) {
  // Newcombe 1998, table I: 81 of 263 and 15 of 148, and the edge 0 of 20.
  const Interval first = Rate{81, 263}.wilson();
  EXPECT_NEAR(first.low, 0.2553, 5e-5);
  EXPECT_NEAR(first.high, 0.3662, 5e-5);
  const Interval second = Rate{15, 148}.wilson();
  EXPECT_NEAR(second.low, 0.0624, 5e-5);
  EXPECT_NEAR(second.high, 0.1605, 5e-5);
  const Interval none = Rate{0, 20}.wilson();
  EXPECT_DOUBLE_EQ(none.low, 0);
  EXPECT_NEAR(none.high, 0.1611, 5e-5);
}

TEST(Rate, NothingOfNothingSaysNothing) {
  EXPECT_EQ(Rate{}.value(), 0);
  EXPECT_EQ(Rate{}.wilson().low, 0);
  EXPECT_EQ(Rate{}.wilson().high, 1);
}

TEST(McNemar, IsTheExactChanceOfAnUnevenCoin) {
  // Ten disagreements, two of them for the second: 2 · (1 + 10 + 45) / 1024.
  EXPECT_NEAR((Disagreements{8, 2}.p_value()), 112.0 / 1024, 1e-12);
  EXPECT_NEAR((Disagreements{2, 8}.p_value()), 112.0 / 1024, 1e-12);
  EXPECT_NEAR((Disagreements{5, 0}.p_value()), 2.0 / 32, 1e-12);
  EXPECT_NEAR((Disagreements{1, 6}.p_value()), 2.0 * (1 + 7) / 128, 1e-12);
}

TEST(McNemar, SaysNothingAgainstEqualMethods) {
  EXPECT_DOUBLE_EQ(Disagreements{}.p_value(), 1);
  EXPECT_DOUBLE_EQ((Disagreements{3, 3}.p_value()), 1);
  EXPECT_DOUBLE_EQ((Disagreements{1, 0}.p_value()), 1);
}

TEST(McNemar, HoldsForThousandsOfDisagreements) {
  // Normal approximation with the continuity correction: z = (2600 − 2400 − 1) / √5000 = 2.814.
  EXPECT_NEAR((Disagreements{2600, 2400}.p_value()), 0.00489, 2e-5);
  EXPECT_LT((Disagreements{5000, 0}.p_value()), 1e-300);
}

TEST(McNemar, CountsOnlyCasesThatCount) {
  constexpr double no_case = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> first{1, 1, 0, no_case, 1};
  const std::vector<double> second{1, 0, 1, no_case, 0};
  const Disagreements found = disagreements(first, second);
  EXPECT_EQ(found.only_first, 2U);
  EXPECT_EQ(found.only_second, 1U);
}

TEST(PrecisionRecall, SweepsFromTheMostConfidentAnswerDown) {
  const std::vector<ScoredAnswer> answers = {
      {.confidence = 0.9, .answered = true, .correct = true, .answerable = true},
      {.confidence = 0.8, .answered = true, .correct = false, .answerable = false},  // a distractor's false positive
      {.confidence = 0.7, .answered = true, .correct = true, .answerable = true},
      {.confidence = 0.7, .answered = true, .correct = true, .answerable = false},  // right, but not asked for
      {.confidence = 0.0, .answered = false, .correct = false, .answerable = true},
      {.confidence = 0.1, .answered = true, .correct = false, .answerable = true},
  };
  const auto curve = precision_recall(answers);
  ASSERT_EQ(curve.size(), 4U);
  EXPECT_DOUBLE_EQ(curve[0].precision, 1);
  EXPECT_DOUBLE_EQ(curve[0].recall, 0.25);
  EXPECT_DOUBLE_EQ(curve[1].precision, 0.5);
  EXPECT_DOUBLE_EQ(curve[2].precision, 0.75);
  EXPECT_DOUBLE_EQ(curve[2].recall, 0.5);
  EXPECT_DOUBLE_EQ(curve[3].precision, 0.6);
  EXPECT_DOUBLE_EQ(recall_at_precision(curve, 0.99), 0.25);
  EXPECT_DOUBLE_EQ(recall_at_precision(curve, 0.7), 0.5);
  EXPECT_DOUBLE_EQ(average_precision(curve), 0.25 * 1 + 0.25 * 0.75);
  EXPECT_DOUBLE_EQ(recall_at_precision({}, 0.9), 0);
}

TEST(Quantile, InterpolatesAndIgnoresOrder) {
  EXPECT_DOUBLE_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 2, 3}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({1, 2}, 1.0), 2);
  EXPECT_DOUBLE_EQ(quantile({}, 0.5), 0);
}

TEST(Reliability, CountsAnswersByTheirConfidence) {
  const std::vector<ScoredAnswer> answers{{.confidence = 0.2, .answered = true, .correct = false},
                                          {.confidence = 0.4, .answered = true, .correct = true},
                                          {.confidence = 0.9, .answered = true, .correct = true},
                                          {.confidence = 0.9, .answered = false, .correct = false}};
  const std::vector<double> edges{0.5, 1.01};
  const std::vector<ReliabilityBin> bins = reliability(answers, edges);
  ASSERT_EQ(bins.size(), 2U);
  EXPECT_EQ(bins[0].right.total, 2U);
  EXPECT_EQ(bins[0].right.hits, 1U);
  EXPECT_NEAR(bins[0].mean_confidence, 0.3, 1e-12);
  EXPECT_EQ(bins[1].right.total, 1U);
  EXPECT_EQ(bins[1].right.hits, 1U);
}

}  // namespace
}  // namespace flirt
