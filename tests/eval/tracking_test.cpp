#include "flirt/eval/tracking.hpp"

#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

/// Two rounds through one room; the second sees what the first saw.
ScanLog two_rounds() {
  std::vector<Pose2> poses;
  for (int i = 0; i < 120; ++i) {
    const double angle = i * 0.105;  // 60 scans a round of 2 π · 1.5 m
    poses.push_back({1.5 * std::cos(angle), 1.5 * std::sin(angle), wrap_angle(angle + 1.57)});
  }
  ScanLog log = log_of(furnished_room(), poses);
  for (std::size_t i = 0; i < poses.size(); ++i) { log.scans[i].odom_from_robot = poses[i]; }
  return log;
}

TrackingBenchParams short_drives() {
  TrackingBenchParams params{.drives = 3, .length = 2};
  params.revisit.travel = 1;
  params.tracker.uniform.particles = 2000;
  return params;
}

TrackedAnswer answer(Verdict verdict, double share, bool agrees, double way) {
  TrackedAnswer answer{.way = way, .agrees = agrees};
  answer.step.verdict = verdict;
  answer.step.share = share;
  return answer;
}

TEST(TrackingBench, DrivesKeepTheirSurroundingsOutOfTheMap) {
  const ScanLog log = two_rounds();
  const TrackingBenchParams params = short_drives();
  const std::vector<double> lengths = path_lengths(log);
  const std::vector<TrackedDrive> drives = drives_in_own_map(log, params, 1);
  std::size_t known = 0;
  for (const TrackedDrive& drive : drives) {
    known += drive.kind == DriveKind::known ? 1U : 0U;
    EXPECT_EQ(drive.parts.size(), drive.kind == DriveKind::kidnapped ? 2U : 1U);
    for (const DrivePart& part : drive.parts) {
      EXPECT_LE(lengths[part.scans.end - 1] - lengths[part.scans.begin], params.length);
      for (std::size_t i = 0; i < log.scans.size(); ++i) {
        const bool near = lengths[i] >= lengths[part.scans.begin] - 1 && lengths[i] <= lengths[part.scans.end - 1] + 1;
        EXPECT_EQ(part.removed.contains(i), near) << i;
      }
    }
  }
  EXPECT_EQ(known, 3U);
}

TEST(TrackingBench, ResultsAreTheSameOnAnyNumberOfThreadsAndKnownDrivesAreFound) {
  const ScanLog log = two_rounds();
  const PlaceMap map = build_place_map(log).value();
  const TrackingBenchParams params = short_drives();
  const std::vector<TrackedDrive> drives = drives_in_own_map(log, params, 1);
  const auto one = track_drives(map, log, drives, TrackInitialisation::hypotheses, params, 1);
  const auto three = track_drives(map, log, drives, TrackInitialisation::hypotheses, params, 3);
  for (std::size_t k = 0; k < drives.size(); ++k) {
    for (std::size_t i = 0; i < one[k].answers.size(); ++i) {
      EXPECT_EQ(one[k].answers[i].step.map_from_robot, three[k].answers[i].step.map_from_robot);
    }
  }
  const TrackingSummary summary =
      summarise(one, DriveKind::known, TrackInitialisation::hypotheses, TrackCriterion::verdict, params);
  EXPECT_EQ(summary.localized.hits, 3U);
  EXPECT_EQ(summary.wrong_scans.hits, 0U);
  EXPECT_GT(summary.cpu_us_median, 0);
}

TEST(TrackingBench, CountsScansUntilSureAndWrongConvergences) {
  DriveOutcome outcome;
  outcome.answers = {answer(Verdict::lost, 0.95, false, 0),   answer(Verdict::unique, 0.99, false, 1),
                     answer(Verdict::unique, 0.99, false, 2), answer(Verdict::ambiguous, 0.95, true, 3),
                     answer(Verdict::unique, 0.99, true, 4),  answer(Verdict::unique, 0.99, false, 5)};
  const DriveResult verdict = judge_drive(outcome, TrackCriterion::verdict, {});
  EXPECT_EQ(verdict.scans_until, 5U);
  EXPECT_EQ(verdict.metres_until, 4);
  EXPECT_EQ(verdict.sure, 4U);
  EXPECT_EQ(verdict.wrong, 3U);
  EXPECT_EQ(verdict.convergences, 2U);
  const DriveResult spread = judge_drive(outcome, TrackCriterion::spread, {});
  EXPECT_EQ(spread.scans_until, 4U);
  EXPECT_EQ(spread.wrong, 4U);
}

TEST(TrackingBench, DrivesNeverLocalizedCountAsInfinite) {
  std::vector<DriveOutcome> outcomes(3);
  outcomes[0].answers = {answer(Verdict::unique, 1, true, 0)};
  outcomes[1].answers = {answer(Verdict::lost, 1, true, 0), answer(Verdict::unique, 1, true, 2)};
  outcomes[2].answers = {answer(Verdict::lost, 1, false, 0)};
  const TrackingSummary summary =
      summarise(outcomes, DriveKind::known, TrackInitialisation::hypotheses, TrackCriterion::verdict, {});
  EXPECT_EQ(summary.localized.hits, 2U);
  EXPECT_EQ(summary.scans_median, 2.0);
  EXPECT_EQ(summary.scans_95, std::nullopt);
}

}  // namespace
}  // namespace flirt
