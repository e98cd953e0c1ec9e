// What the papers (P1, P2) or, where they are silent, the authors' own program set. A change of one of these changes
// what is compared with the papers' tables.
#include "flirt/eval/detector_bench.hpp"
#include "flirt/eval/localization.hpp"
#include "flirt/features/extract.hpp"
#include "flirt/match/match.hpp"
#include "flirt/match/ransac.hpp"

#include <gtest/gtest.h>

#include <variant>

namespace flirt {
namespace {

TEST(PaperDefaults, OfTheDetectors) {
  ASSERT_TRUE(std::holds_alternative<CurvatureParams>(FeatureParams{}.detector));
  const CurvatureParams curvature;
  EXPECT_EQ(curvature.scales.count, 5);  // P2 §IV-B, as the next two
  EXPECT_EQ(curvature.scales.base, 0.2);
  EXPECT_EQ(curvature.scales.step, 1.4);
  EXPECT_EQ(curvature.peaks.threshold, 0.34);  // the authors' program, as all that follow
  EXPECT_EQ(curvature.peaks.difference, 0.001);
  EXPECT_EQ(curvature.spanning_trees, 3);
  EXPECT_EQ(curvature.end_margin, 2.0);
  EXPECT_EQ(curvature.support_factor, 2.0);
  EXPECT_EQ(curvature.selection.duplicate_radius, 0.2);
  for (const ScaleParams& scales : {RangeParams{}.scales, NormalEdgeParams{}.scales, NormalBlobParams{}.scales}) {
    EXPECT_EQ(scales.count, 5);
    EXPECT_EQ(scales.base, 1.6);  // P2 §IV-B
    EXPECT_EQ(scales.step, 1.4);
  }
  EXPECT_EQ(NormalParams{}.window, 3);
}

TEST(PaperDefaults, OfTheDescriptor) {
  ASSERT_TRUE(std::holds_alternative<BetaGridParams>(FeatureParams{}.descriptor));
  const BetaGridParams grid;
  EXPECT_EQ(grid.angular_bins, 12U);  // P2 §IV-C, as the next two
  EXPECT_EQ(grid.radial_bins, 4U);
  EXPECT_EQ(grid.radius, 0.5);
  EXPECT_EQ(grid.estimate, OccupancyEstimate::posterior);  // P1 eq. 9, uniform prior as in eq. 8
  EXPECT_EQ(grid.prior_hits, 1.0);
  EXPECT_EQ(grid.prior_misses, 1.0);
}

TEST(PaperDefaults, OfMatching) {
  EXPECT_EQ(MatchParams{}.distance, Distance::chi_square);
  EXPECT_EQ(MatchParams{}.strategy, MatchStrategy::nearest);
  EXPECT_EQ(MatchParams{}.max_distance, 0.4);         // P1 §3.1
  EXPECT_EQ(RansacParams{}.inlier_probability, 0.3);  // P1 §3.1
  EXPECT_EQ(RansacParams{}.min_inliers, 3U);          // P1 §4.1
  EXPECT_EQ(RansacParams{}.success_probability, 0.95);
  EXPECT_EQ(RansacParams{}.inlier_distance, 0.1);
}

TEST(PaperDefaults, OfTheBenches) {
  const DetectorBenchParams detectors;
  EXPECT_EQ(detectors.repeatability.overlap_error, 0.6);  // P2 §IV-B, as the next
  EXPECT_EQ(detectors.repeatability.presence, 0.1);
  EXPECT_EQ(detectors.common_radius, 0.5);  // support regions are "typically" that large (P2 §I)
  const LocalizationBenchParams localization;
  EXPECT_EQ(localization.tolerance.correct_distance, 0.5);  // P1 §4.1, as the next
  EXPECT_EQ(localization.tolerance.correct_heading, radians_from_degrees(10));
  EXPECT_EQ(paper_n_min, 3U);
}

}  // namespace
}  // namespace flirt
