#include "flirt/eval/arena.hpp"

#include "tests/support/scenes.hpp"

#include <gmock/gmock.h>

#include <set>
#include <string>

namespace flirt {
namespace {

ScanLog room_log() {
  return log_of(furnished_room(), poses_around(0.6, 8));
}

std::string name_of(const Contender& contender) {
  return contender.detector.name + "+" + (contender.descriptor ? contender.descriptor->name : "none") + "+" +
         std::string(to_string(contender.matcher));
}

TEST(Contenders, BeginWithOurDefaultAndAreAllDifferent) {
  const std::vector<Contender> list = contenders({}, {}, {});
  EXPECT_EQ(name_of(list.front()), "curvature+beta-grid+ransac");
  std::set<std::string> names;
  for (const Contender& contender : list) { names.insert(name_of(contender)); }
  EXPECT_EQ(names.size(), list.size());
  EXPECT_EQ(list.size(), 8U * (4 * 3 + 2));
  EXPECT_EQ(names.count("falko+none+clique"), 1U);
  EXPECT_EQ(names.count("falko+none+ransac"), 0U);
}

TEST(Contenders, AreTheAskedOnesBesideOurDefault) {
  std::vector<std::string> names;
  for (const Contender& contender : contenders({"oc"}, {"bsc", "none"}, {"clique"})) {
    names.push_back(name_of(contender));
  }
  EXPECT_THAT(names, testing::ElementsAre("curvature+beta-grid+ransac", "oc+bsc+clique", "oc+none+clique"));
}

TEST(ContenderMatcher, CountsInliersAlikeForEveryMatcher) {
  const ScanLog log = room_log();
  AnyExtractor extractor({tuned_falko(), CghParams{}});
  const ArenaScan query = arena_scan(extractor.extract(log.scans[0]));
  const ArenaScan reference = arena_scan(extractor.extract(log.scans[1]));
  const Pose2 truth = inverse(log.map_from_sensor(1)) * log.map_from_sensor(0);
  ArenaMatcherParams params{.match = match_params_of(CghParams{})};
  for (const auto& [matcher, name] : enum_names(ArenaMatcher{})) {
    ContenderMatcher pair(matcher, CandidateSource::descriptors, params);
    pair.set_query(query);
    const auto found = pair.align(reference);
    ASSERT_TRUE(found) << name;
    EXPECT_LT(distance(found->reference_from_query, truth), 0.1) << name;
    EXPECT_LT(heading_difference(found->reference_from_query, truth), 0.05) << name;
    EXPECT_GE(found->inliers, 3U);
    EXPECT_LE(found->inliers, query.points.size());
    EXPECT_LT(found->residual, 5.99 * 0.01);
  }
}

TEST(ContenderMatcher, FindsNothingInAScanWithoutKeypoints) {
  AnyExtractor extractor({tuned_falko(), BscParams{}});
  const ArenaScan empty = arena_scan(extractor.extract(Scan{}));
  const ArenaScan full = arena_scan(extractor.extract(room_log().scans[0]));
  for (const auto& [matcher, name] : enum_names(ArenaMatcher{})) {
    ContenderMatcher pair(matcher, CandidateSource::descriptors, {.match = match_params_of(BscParams{})});
    pair.set_query(empty);
    EXPECT_FALSE(pair.align(full)) << name;
    pair.set_query(full);
    EXPECT_FALSE(pair.align(empty)) << name;
  }
}

TEST(Arena, FindsEveryScanOfAnExactRoomAndOnAnyNumberOfThreads) {
  const ScanLog log = room_log();
  const std::vector<Contender> list = contenders({"curvature", "falko"}, {"bsc", "none"}, {"ransac", "clique"});
  const auto one = bench_arena(log, list, {.every = 2}, 1);
  const auto three = bench_arena(log, list, {.every = 2}, 3);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->queries, 4U);
  ASSERT_EQ(one->contenders.size(), list.size() + 1);
  EXPECT_EQ(one->contenders.back().matcher, "beams");
  EXPECT_EQ(one->contenders[0].protocols[0].by_residual.hits, 4U);
  EXPECT_EQ(one->contenders.back().protocols[0].by_residual.hits, 4U);
  EXPECT_EQ(one->contenders[0].protocols[1].by_residual.total, 0U);  // all of it is within 10 m of travel
  ASSERT_EQ(one->shortlists.size(), 2U);
  for (std::size_t c = 0; c < one->contenders.size(); ++c) {
    const ContenderResult& a = one->contenders[c];
    const ContenderResult& b = three->contenders[c];
    EXPECT_EQ(a.average_precision, b.average_precision);
    EXPECT_EQ(a.repeatability.hits, b.repeatability.hits);
    for (std::size_t k = 0; k < a.protocols[0].answers.size(); ++k) {
      EXPECT_EQ(a.protocols[0].answers[k].inliers, b.protocols[0].answers[k].inliers);
      EXPECT_EQ(a.protocols[0].answers[k].right_by_residual, b.protocols[0].answers[k].right_by_residual);
    }
  }
}

TEST(Arena, RanksTheSamePlaceFirstWhateverTheHeading) {
  ScanLog log;
  const std::vector<Pose2> poses{{0, 0, 0}, {-3.5, 2, 1}, {3, -3, 2}, {0.01, 0, std::numbers::pi / 8}};
  log = log_of(furnished_room(), poses);
  const auto arena = bench_arena(log, contenders({"curvature"}, {"none"}, {"hough"}), {.every = 10}, 1);
  ASSERT_TRUE(arena);
  EXPECT_EQ(arena->shortlists[0].recall[0][0].hits, 1U);
  EXPECT_EQ(arena->shortlists[0].recall[0][0].total, 1U);
}

}  // namespace
}  // namespace flirt
