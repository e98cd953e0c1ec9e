#include "flirt/registration/evidence_score.hpp"

#include "rooms.hpp"

#include <gtest/gtest.h>

namespace flirt {
namespace {

using rooms::asymmetric_room;
using rooms::evidence_of;
using rooms::outline;
using rooms::scan_of;
using rooms::walk;

/// The room with a cabinet, 1.2 m wide, that is gone when the scan is taken.
class CarriedAway : public testing::Test {
 protected:
  CarriedAway() {
    auto walls = asymmetric_room();
    for (const auto& wall : outline({{6.4, 1.6}, {6.8, 1.6}, {6.8, 2.8}, {6.4, 2.8}})) { walls.push_back(wall); }
    fields_ = map_fields(evidence_of(walls, walk({})));
    points_ = scan_points(scan_of(asymmetric_room(), truth_, 2 * std::numbers::pi));
  }

  [[nodiscard]] EvidenceScore score(const Pose2& pose, const EvidenceScoreParams& params = {}) const {
    return EvidenceScorer(fields_, params).score(points_, pose);
  }

  Pose2 truth_{4.6, 2.4, 0.3};
  MapFields fields_;
  ScanPoints points_;
};

TEST_F(CarriedAway, BeamsThroughANarrowThingCountAsAFewAtMost) {
  const EvidenceScore score = this->score(truth_);
  EXPECT_GT(score.through, 0.06);  // a ninth of the view, and its back wall is far away
  EXPECT_LE(score.through_fixed, EvidenceScoreParams{}.moved_share + 1e-12);
  EXPECT_GT(score.through_fixed, 0);
  EXPECT_EQ(this->score(truth_, {.moved_share = 0}).through_fixed, 0);
}

TEST_F(CarriedAway, NothingIsNarrowerThanTheLeastWidth) {
  for (const double width : {0.0, 0.5}) {
    const EvidenceScore score = this->score(truth_, {.moved_width = width});
    EXPECT_DOUBLE_EQ(score.through_fixed, score.through) << width;
  }
}

TEST_F(CarriedAway, WallsCannotHaveBeenMoved) {
  const EvidenceScore score = this->score({4.6, 0.4, 0.3});  // as if the southern wall had been seen through
  EXPECT_GT(score.through, 0.1);
  EXPECT_GT(score.through_fixed, 0.8 * score.through);
}

TEST_F(CarriedAway, SumsFollowTheirTerms) {
  const EvidenceScoreParams params;
  const EvidenceScore score = this->score(truth_);
  const EvidenceScore moved = if_things_moved(score, params);
  EXPECT_EQ(moved.through, score.through_fixed);
  EXPECT_NEAR(moved.preference - score.preference, params.preference.through * (moved.through - score.through), 1e-12);
  EXPECT_NEAR(moved.total - score.total, params.fit.through * (moved.through - score.through), 1e-12);
  EXPECT_EQ(moved.likelihood, score.likelihood);
}

TEST_F(CarriedAway, ShareOfAllBeamsIsThatOfTheScore) {
  const EvidenceScorer scorer(fields_, {});
  const double through = score(truth_).through;
  EXPECT_DOUBLE_EQ(scorer.through(points_, truth_), through);
  EXPECT_NEAR(scorer.through(points_, truth_, 3), through, 0.05);
  EXPECT_EQ(scorer.through(points_, truth_, 1, 0.5 * through), 1);
  EXPECT_DOUBLE_EQ(scorer.through(points_, truth_, 1, through), through);
}

}  // namespace
}  // namespace flirt
