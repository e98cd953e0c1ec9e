#include "flirt/map/track_belief.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace flirt {
namespace {

constexpr Pose2 step_ahead{1, 0, 0};  // an independent look

EvidenceScore good() {
  return {.total = 14, .likelihood = 0.95};
}
EvidenceScore bad() {
  return {.total = -5, .likelihood = 0.3, .free = 0.4, .through = 0.3};
}

TEST(TrackBelief, ASearchAloneIsNeverSure) {
  TrackBelief belief;
  EXPECT_EQ(belief.probability(), 0);
  belief.start(1);
  EXPECT_LE(belief.probability(), BeliefParams{}.largest_start);
  belief.start(0.2);
  EXPECT_EQ(belief.probability(), 0.2);
}

TEST(TrackBelief, SustainedAgreementMakesSureAndDisagreementUndoesIt) {
  TrackBelief belief;
  belief.start(0.5);
  for (int i = 0; i < 5; ++i) { belief.look(good(), 100, step_ahead); }
  EXPECT_GT(belief.probability(), 0.95);
  for (int i = 0; i < 4; ++i) { belief.look(bad(), 100, step_ahead); }
  EXPECT_LT(belief.probability(), 0.3);
}

TEST(TrackBelief, StandingStillTeachesNothing) {
  TrackBelief belief;
  belief.start(0.5);
  for (int i = 0; i < 1000; ++i) { belief.look(good(), 100, {}); }
  EXPECT_EQ(belief.probability(), 0.5);
}

TEST(TrackBelief, ManyShortStepsSayAsMuchAsOneLongOne) {
  const BeliefParams still{.leave = 0, .arrive = 0};
  TrackBelief once(still);
  TrackBelief often(still);
  once.start(0.3);
  often.start(0.3);
  once.look(good(), 100, {0.4, 0, 0});
  for (int i = 0; i < 8; ++i) { often.look(good(), 100, {0.05, 0, 0}); }
  EXPECT_NEAR(once.probability(), often.probability(), 1e-9);
}

TEST(TrackBelief, AScanWithoutPointsOnlyAges) {
  TrackBelief belief;
  belief.start(0.8);
  belief.look(bad(), 0, step_ahead);
  EXPECT_LT(belief.probability(), 0.8);
  EXPECT_GT(belief.probability(), 0.75);
}

TEST(TrackBelief, IsBayesRule) {
  const BeliefParams params;
  TrackBelief belief(params);
  belief.start(0.4);
  belief.look(good(), 80, step_ahead);
  const double prior = 0.4 * (1 - params.leave) + 0.6 * params.arrive;
  const double odds = prior / (1 - prior) * std::exp(log_odds_of_look(good(), 80, params));
  EXPECT_NEAR(belief.probability(), odds / (1 + odds), 1e-12);
}

TEST(TrackBelief, OneLookIsBounded) {
  const BeliefParams params;
  EXPECT_EQ(log_odds_of_look({.total = -100, .through = 1}, 200, params), -params.largest_look);
  EXPECT_EQ(log_odds_of_look({.total = 100}, 2000, params), params.largest_look);
}

}  // namespace
}  // namespace flirt
