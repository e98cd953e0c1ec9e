// The benches of detectors, descriptors and single choices on a log of one room.
#include "flirt/eval/ablation.hpp"
#include "flirt/eval/descriptor_bench.hpp"
#include "flirt/eval/detector_bench.hpp"

#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace flirt {
namespace {

std::vector<ScanLog> room_logs() {
  ScanLog log;
  for (const Pose2& pose : poses_around(0.8, 5)) {
    log.scans.push_back(scan_of(furnished_room(), pose, turn_beams(), turn_beam_count));
    log.map_from_robot.push_back(pose);
  }
  return {log};
}

const std::vector<Location> locations{{0, 1}, {0, 3}};
const std::vector<Condition> conditions{{ScanTransform::noise, 0.0},
                                        {ScanTransform::noise, 0.3},
                                        {ScanTransform::subsampling, 2},
                                        {ScanTransform::oversampling, 2},
                                        {ScanTransform::viewpoint, 0.9}};

DetectorBenchParams detector_params() {
  DetectorBenchParams params;
  params.conditions = conditions;
  params.transforms.overlap_half_width = 0.4;
  return params;
}

TEST(DetectorBench, FindsEverythingAgainInAnUnchangedScan) {
  const auto logs = room_logs();
  const DetectorBench bench = bench_detectors(logs, locations, default_detectors(), detector_params(), 1);
  for (std::size_t v = 0; v < 4; ++v) {
    for (const double score : location_scores(bench, v, RegionRule::common, std::size_t{0})) { EXPECT_EQ(score, 1.0); }
  }
  const RepeatabilityCounts viewpoint = total(bench, 0, RegionRule::common, std::size_t{4});
  EXPECT_EQ(viewpoint.scans, 8U) << "two locations with four other scans each";
  EXPECT_GT(viewpoint.present, 0U);
}

TEST(DetectorBench, IsTheSameOnSeveralThreads) {
  const auto logs = room_logs();
  const DetectorBench one = bench_detectors(logs, locations, default_detectors(), detector_params(), 1);
  const DetectorBench three = bench_detectors(logs, locations, default_detectors(), detector_params(), 3);
  for (std::size_t v = 0; v < one.variants.size(); ++v) {
    for (std::size_t c = 0; c < conditions.size(); ++c) {
      const auto a = total(one, v, RegionRule::native, c);
      const auto b = total(three, v, RegionRule::native, c);
      EXPECT_EQ(a.present, b.present);
      EXPECT_EQ(a.corresponding, b.corresponding);
    }
  }
}

TEST(DetectorBench, TransformScoreIsTheMeanOfItsConditionsThatHaveOne) {
  DetectorBench bench{
      .locations = {{0, 0}},
      .conditions = {{ScanTransform::noise, 0.1}, {ScanTransform::noise, 0.2}, {ScanTransform::noise, 0.3}}};
  bench.variants = {{"one", std::nullopt}};
  bench.counts.resize(6);
  bench.counts[bench.index(0, RegionRule::native, 0, 0)] = {.keypoints = 4, .present = 4, .corresponding = 1};
  bench.counts[bench.index(0, RegionRule::native, 1, 0)] = {.keypoints = 4, .present = 2, .corresponding = 1};
  EXPECT_DOUBLE_EQ(location_scores(bench, 0, RegionRule::native, ScanTransform::noise).front(), 0.375);
  EXPECT_TRUE(std::isnan(location_scores(bench, 0, RegionRule::native, ScanTransform::viewpoint).front()));
  EXPECT_TRUE(std::isnan(location_scores(bench, 0, RegionRule::native, std::size_t{2}).front())) << "nothing present";
}

TEST(DescriptorBench, SeparatesPlacesInAnUnchangedScanBetterThanUnderNoise) {
  const auto logs = room_logs();
  const std::vector<Location> all{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}};
  DescriptorBenchParams params;
  const auto run = [&](double sigma) {
    params.conditions = {{ScanTransform::noise, sigma}};
    const auto bench = bench_descriptors(logs, all, paper_combinations(), params, 1);
    std::vector<double> scores;
    for (std::size_t e = 0; e < bench.entries.size(); ++e) {
      scores.push_back(
          average_precision(total(bench.at({e, RegionRule::common, PairRule::nearest, ScanTransform::noise}))));
    }
    return scores;
  };
  const auto clean = run(0.0);
  const auto noisy = run(0.3);
  ASSERT_EQ(clean.size(), 8U);
  for (std::size_t e = 0; e < clean.size(); ++e) {
    // Two places with the same histogram of few points are equally near: of two of these scans alone shape contexts
    // score from 0.83 to 1.
    EXPECT_GT(clean[e], e < 4 ? 0.99 : 0.85) << e << ": the nearest descriptor is its own";
    EXPECT_LT(noisy[e], clean[e]) << e;
  }
}

TEST(DescriptorVariants, EachNameAndDistanceIsThereOnce) {
  std::set<std::string> names;
  std::size_t entries = 0;
  for (const FeatureMethod& method : descriptor_variants()) {
    for (const Distance distance : method.distances) {
      names.insert(method.detector + method.descriptor + std::string(to_string(distance)));
      ++entries;
    }
  }
  EXPECT_EQ(names.size(), entries);
}

TEST(AveragePrecision, OfDrawsIsPairedWhenTheyAreTheSame) {
  std::vector<MatchingCounts> locations_a(3);
  for (std::size_t l = 0; l < 3; ++l) {
    locations_a[l].matches[l] = 4;
    locations_a[l].correct[l] = static_cast<std::uint32_t>(l + 1);
    locations_a[l].correspondences = 4;
  }
  const auto draws = bootstrap_draws(3, 50, 1);
  const AveragePrecision a = average_precision(locations_a, draws);
  EXPECT_EQ(a.draws.size(), 50U);
  for (const double zero : difference(a, a).draws) { EXPECT_EQ(zero, 0); }
  const AveragePrecision twice[]{a, a};
  EXPECT_DOUBLE_EQ(mean_of(twice).value, a.value);
}

TEST(Ablations, ChangeOneChoiceEachAndTheDefaultComesFirst) {
  const auto variants = paper_ablations();
  EXPECT_EQ(variants.front().choice, "default");
  std::set<std::string> names;
  for (const AblationVariant& variant : variants) { names.insert(variant.choice + variant.value); }
  EXPECT_EQ(names.size(), variants.size());
}

TEST(Ablation, WeighsTheVariancesOfBothSides) {
  const auto logs = room_logs();
  AblationVariant variant;
  variant.match.distance = Distance::variance_chi_square;
  variant.match.max_distance = 0.0004;  // some features are this near only because the map's variances count, too
  AblationParams params;
  params.detectors = detector_params();
  const auto answers_of = [&](MapVariances variances) {
    LocalizationBenchParams bench;
    bench.localize.papers.match = variant.match;
    const PlaceMap map = build_place_map(logs.front(), variant.features, 1, {}, variances).value();
    std::vector<double> answers;
    for (const LocalizationAnswer& answer : bench_localization(logs.front(), map, bench, 1).answers) {
      if (answer.strategy == "residual") { answers.push_back(answer.answered ? 1 : 0); }
    }
    return answers;
  };
  const auto results = bench_ablation(logs, locations, {&variant, 1}, params, 1);
  ASSERT_TRUE(results.has_value());
  EXPECT_EQ(results->front().answers, answers_of(MapVariances::keep));
  EXPECT_NE(results->front().answers, answers_of(MapVariances::leave_out));
}

TEST(Ablation, HasAValuePerLocationAndQuery) {
  const auto logs = room_logs();
  AblationParams params;
  params.detectors = detector_params();
  std::vector<AblationVariant> variants{paper_ablations()[0]};
  const auto results = bench_ablation(logs, locations, variants, params, 1);
  ASSERT_TRUE(results.has_value());
  const AblationResult& result = results->front();
  EXPECT_EQ(result.repeatability.size(), locations.size());
  EXPECT_EQ(result.localized, std::vector<double>(5, 1.0)) << "scans of one small room find each other";
  EXPECT_EQ(result.revisited.size(), 5U);
  EXPECT_EQ(query_blocks(logs, params.localization).size(), 5U);
  EXPECT_GT(result.keypoints_per_scan, 3);
}

}  // namespace
}  // namespace flirt
