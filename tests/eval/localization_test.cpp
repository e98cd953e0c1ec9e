// The papers' localization protocol against a plain loop over solution sets.
#include "flirt/eval/localization.hpp"

#include "flirt/features/extract.hpp"
#include "flirt/map/solution_set.hpp"

#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace flirt {
namespace {

/// Sixteen scans of a room, two of them with poses in the log that are wrong, and three of another room far away.
const ScanLog& two_rooms() {
  static const ScanLog log = [] {
    ScanLog rooms = log_of(furnished_room(), poses_around(1.2, 8));
    const auto add = [&rooms](const ScanLog& more, const Pose2& map_from_room) {
      for (std::size_t i = 0; i < more.scans.size(); ++i) {
        rooms.scans.push_back(more.scans[i]);
        rooms.map_from_robot.push_back(map_from_room * more.map_from_robot[i]);
      }
    };
    add(log_of(furnished_room(), poses_around(2.6, 8)), {});
    add(log_of(joined(box({0, 0, 0}, 7, 3), box({1, 0.6, 0.4}, 0.8, 0.5)), poses_around(0.9, 3)), {40, 0, 0});
    rooms.map_from_robot[2].x += 2.0;
    rooms.map_from_robot[11].theta += 0.3;
    return rooms;
  }();
  return log;
}

const PlaceMap& two_rooms_map() {
  static const PlaceMap map = build_place_map(two_rooms()).value();
  return map;
}

const LocalizationBench& two_rooms_bench() {
  static const LocalizationBench bench = bench_localization(two_rooms(), two_rooms_map(), {}, 2);
  return bench;
}

/// Both errors in units of what is allowed, the larger of them.
double error_of(const Hypothesis& hypothesis, const Pose2& truth) {
  return std::max(distance(hypothesis.map_from_sensor, truth) / 0.5,
                  heading_difference(hypothesis.map_from_sensor, truth) / radians_from_degrees(10));
}

/// The one of `hypotheses` (best residual first) that a strategy answers with; null when there is none.
const Hypothesis* choice(const std::vector<Hypothesis>& hypotheses, PickBy pick, const Pose2& truth) {
  if (hypotheses.empty()) { return nullptr; }
  auto best = hypotheses.begin();
  if (pick == PickBy::closest) {
    best = std::ranges::min_element(hypotheses, {}, [&](const Hypothesis& h) { return error_of(h, truth); });
  }
  if (pick == PickBy::corresp) { best = std::ranges::max_element(hypotheses, {}, &Hypothesis::inliers); }
  return &*best;
}

TEST(PaperProtocol, IsAPlainLoopOverTheSolutionSetsOfAllOtherScans) {
  const ScanLog& log = two_rooms();
  const LocalizationBench& bench = two_rooms_bench();
  ASSERT_EQ(bench.strategies.size(), 3U);
  ASSERT_EQ(bench.answers.size(), 3 * log.scans.size());
  SolutionSetFinder finder(two_rooms_map());
  std::vector<SolutionSet> sets;
  for (std::size_t q = 0; q < log.scans.size(); ++q) {
    sets.push_back(finder.find(extract(log.scans[q]), {q, q + 1}));
    EXPECT_TRUE(std::ranges::is_sorted(sets.back().hypotheses, {}, &Hypothesis::residual));
  }
  std::size_t different = 0;
  for (std::size_t s = 0; s < 3; ++s) {
    const StrategyCurve& curve = bench.strategies[s];
    ASSERT_EQ(curve.n_min.size(), 13U);
    for (std::uint32_t n = 3; n <= 15; ++n) {
      std::size_t answered = 0;
      std::size_t correct = 0;
      for (std::size_t q = 0; q < log.scans.size(); ++q) {
        std::vector<Hypothesis> enough;
        std::ranges::copy_if(sets[q].hypotheses, std::back_inserter(enough),
                             [n](const Hypothesis& hypothesis) { return hypothesis.inliers >= n; });
        const Hypothesis* best = choice(enough, curve.strategy, log.map_from_robot[q]);
        answered += best != nullptr ? 1 : 0;
        correct += best != nullptr && error_of(*best, log.map_from_robot[q]) <= 1 ? 1 : 0;
        if (n > 3) { continue; }
        const LocalizationAnswer& answer = bench.answers[3 * q + s];
        EXPECT_EQ(answer.query, q);
        EXPECT_EQ(answer.strategy, to_string(curve.strategy));
        ASSERT_EQ(answer.answered, best != nullptr);
        if (best == nullptr) { continue; }
        EXPECT_EQ(answer.reference, best->map_scan);
        EXPECT_EQ(answer.inliers, best->inliers);
        EXPECT_EQ(answer.residual, best->residual);
        different += best->map_scan != sets[q].hypotheses.front().map_scan ? 1 : 0;
      }
      EXPECT_EQ(curve.n_min[n - 3], n);
      EXPECT_EQ(curve.precision[n - 3].hits, correct);
      EXPECT_EQ(curve.precision[n - 3].total, answered);
      EXPECT_EQ(curve.recall[n - 3].hits, correct);
      EXPECT_EQ(curve.recall[n - 3].total, log.scans.size());
    }
    EXPECT_EQ(curve.p_gl().hits, curve.recall.front().hits);
    EXPECT_LT(curve.precision_at_least().value(), 1) << "no answer to a scan with a wrong pose is right";
    EXPECT_GT(curve.precision_at_least().value(), 0.5);
  }
  EXPECT_GT(different, 5U) << "the strategies answer with different scans";
}

TEST(PaperProtocol, TheQueryItselfNeverAnswers) {
  for (const LocalizationAnswer& answer : two_rooms_bench().answers) {
    if (answer.answered) { EXPECT_NE(answer.reference, answer.query); }
  }
  ScanLog single;
  single.scans = {two_rooms().scans.front()};
  single.map_from_robot = {two_rooms().map_from_robot.front()};
  const LocalizationBench alone = bench_localization(single, build_place_map(single).value(), {}, 1);
  for (const LocalizationAnswer& answer : alone.answers) { EXPECT_FALSE(answer.answered); }
  for (const StrategyCurve& curve : alone.strategies) {
    EXPECT_EQ(curve.recall.front().total, 1U);
    EXPECT_EQ(curve.precision.front().total, 0U);
  }
}

TEST(PaperProtocol, ClosestIsTheUpperBoundAndAsksForNothingMoreThanInliers) {
  const std::vector<StrategyCurve>& curves = two_rooms_bench().strategies;
  ASSERT_EQ(curves[0].strategy, PickBy::closest);
  for (std::size_t k = 0; k < curves[0].n_min.size(); ++k) {
    for (std::size_t s = 1; s < 3; ++s) {
      EXPECT_GE(curves[0].recall[k].hits, curves[s].recall[k].hits) << "n " << curves[s].n_min[k];
      EXPECT_EQ(curves[0].precision[k].total, curves[s].precision[k].total) << "all answer the same queries";
    }
  }
  EXPECT_GT(curves[0].recall.front().hits, curves[1].recall.front().hits);
  // Of `residual` alone recall could rise: with more inliers asked for, another match is the one of least residual.
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t k = 1; k < curves[s].n_min.size(); ++k) {
      EXPECT_LE(curves[s].recall[k].hits, curves[s].recall[k - 1].hits) << to_string(curves[s].strategy);
    }
    EXPECT_LT(curves[s].recall.back().hits, curves[s].recall.front().hits);
  }
}

TEST(StrategyCurve, PClIsTheLargestRecallOfPrecisionFrom95PercentOn) {
  StrategyCurve curve{.n_min = {3, 4, 5, 6},
                      .precision = {{20, 22}, {19, 20}, {12, 12}, {0, 0}},
                      .recall = {{20, 40}, {19, 40}, {12, 40}, {0, 40}}};
  EXPECT_EQ(curve.p_cl(), 19.0 / 40) << "19 of 20 is enough, 20 of 22 is not";
  curve.precision[1] = {94, 99};  // .9495
  EXPECT_EQ(curve.p_cl(), 12.0 / 40);
  const StrategyCurve silent{.n_min = {3}, .precision = {{0, 0}}, .recall = {{1, 40}}};
  EXPECT_EQ(silent.p_cl(), 0) << "without answers there is no precision";
}

}  // namespace
}  // namespace flirt
