#include "flirt/map/verdict.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace flirt {
namespace {

ScoredPose pose_of_score(double total) {
  ScoredPose pose;
  pose.score = {.total = total, .preference = total, .likelihood = total / 14.7};
  return pose;
}

TEST(Verdict, NoPoseIsLostWithoutConfidence) {
  const Judgement judgement = judge_answer({}, 100);
  EXPECT_EQ(judgement.verdict, Verdict::lost);
  EXPECT_EQ(judgement.confidence, 0);
}

TEST(Verdict, AClearLeadIsUniqueAndATwinIsNot) {
  const std::vector<ScoredPose> clear{pose_of_score(14), pose_of_score(6)};
  EXPECT_EQ(judge_answer(clear, 100).reason, Reason::clear_winner);
  const std::vector<ScoredPose> twin{pose_of_score(14), pose_of_score(13.5)};
  EXPECT_EQ(judge_answer(twin, 100).verdict, Verdict::ambiguous);
  EXPECT_EQ(judge_answer(twin, 100).reason, Reason::second_place_too_close);
}

TEST(Verdict, FewPointsAreLostHoweverWellTheyFit) {
  const std::vector<ScoredPose> alone{pose_of_score(14)};
  EXPECT_EQ(judge_answer(alone, 7).reason, Reason::few_points);
}

TEST(Verdict, ABadBestPlaceIsLostForANamedReason) {
  const auto reason_of = [](const EvidenceScore& score) {
    std::vector<ScoredPose> poses(1);
    poses[0].score = score;
    return judge_answer(poses, 100).reason;
  };
  EXPECT_EQ(reason_of({.total = 1, .likelihood = 0.3, .unknown = 0.7}), Reason::outside_map);
  EXPECT_EQ(reason_of({.total = 1, .likelihood = 0.4, .free = 0.5, .through = 0.1}),
            Reason::contradicted_by_free_space);
  EXPECT_EQ(reason_of({.total = 1, .likelihood = 0.3, .free = 0.1, .unknown = 0.1}), Reason::poor_fit);
}

TEST(Verdict, ConfidenceRisesWithMarginAndPointsAndFallsWithContradiction) {
  const auto confidence = [](double first, double second, std::size_t points, double through) {
    std::vector<ScoredPose> poses{pose_of_score(first), pose_of_score(second)};
    poses[0].score.through = through;
    return confidence_of(poses, points);
  };
  EXPECT_LT(confidence(12, 11, 80, 0), confidence(12, 9, 80, 0));
  EXPECT_LT(confidence(12, 11, 40, 0), confidence(12, 11, 120, 0));
  EXPECT_GT(confidence(12, 11, 80, 0), confidence(12, 11, 80, 0.2));
}

TEST(Verdict, PointsOfEarlierScansAreLessEvidence) {
  const ScanPoints points{.x = {1, 2, 3, 4, 5, 6}, .y = {0, 0, 0, 0, 0, 0}, .range = {1, 2, 0, 0, 0, 0}};
  EXPECT_EQ(points_of_evidence(points), 3U);
  EXPECT_EQ(points_of_evidence(points, {.joined_points = 1}), 6U);
  EXPECT_EQ(points_of_evidence(points, {.joined_points = 0}), 2U);
}

TEST(Verdict, WeightsAreThoseOfTheScores) {
  const std::vector<ScoredPose> poses{pose_of_score(12), pose_of_score(12), pose_of_score(2)};
  const std::vector<double> weights = weights_of(poses);
  EXPECT_NEAR(weights[0], 0.5, 1e-6);
  EXPECT_NEAR(weights[1], 0.5, 1e-6);
  EXPECT_LT(weights[2], 1e-6);
}

}  // namespace
}  // namespace flirt
