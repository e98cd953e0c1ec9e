#include "flirt/eval/tracking.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/rng.hpp"
#include "flirt/eval/cpu_time.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flirt {
namespace {

/// The drive from `begin`, with what is within `around` m of travel removed; nothing where the log ends before.
std::optional<DrivePart> part_from(std::size_t begin, std::span<const double> lengths, double length, double around) {
  const auto first_beyond = [&](double way) {
    return static_cast<std::size_t>(std::ranges::upper_bound(lengths, way) - lengths.begin());
  };
  const std::size_t end = first_beyond(lengths[begin] + length);
  if (end == lengths.size()) { return std::nullopt; }
  const auto removed_begin =
      static_cast<std::size_t>(std::ranges::lower_bound(lengths, lengths[begin] - around) - lengths.begin());
  return DrivePart{{begin, end}, {removed_begin, first_beyond(lengths[end - 1] + around)}};
}

/// At most `count` of the parts in random order, none begun within half a drive of one taken before.
std::vector<DrivePart> spaced(std::vector<DrivePart> parts, std::span<const double> lengths, double spacing,
                              std::size_t count, Rng& rng) {
  for (std::size_t i = parts.size(); i > 1; --i) {
    std::swap(parts[i - 1], parts[rng.below(static_cast<std::uint32_t>(i))]);
  }
  std::vector<DrivePart> taken;
  for (const DrivePart& part : parts) {
    if (taken.size() == count) { break; }
    const bool is_near = std::ranges::any_of(taken, [&](const DrivePart& other) {
      return std::abs(lengths[part.scans.begin] - lengths[other.scans.begin]) < spacing;
    });
    if (!is_near) { taken.push_back(part); }
  }
  return taken;
}

void append(std::vector<TrackedDrive>& drives, DriveKind kind, std::span<const DrivePart> parts) {
  for (const DrivePart& part : parts) { drives.push_back({.kind = kind, .parts = {part}}); }
}

/// Each known drive followed by another one that begins elsewhere.
void append_kidnapped(std::vector<TrackedDrive>& drives, std::span<const DrivePart> known, const ScanLog& log) {
  for (std::size_t i = 0; i < known.size(); ++i) {
    const DrivePart& first = known[i];
    const DrivePart& second = known[(i + known.size() / 2) % known.size()];
    if (distance(log.map_from_robot[first.scans.end - 1], log.map_from_robot[second.scans.begin]) < 3) { continue; }
    drives.push_back({.kind = DriveKind::kidnapped, .parts = {first, second}});
  }
}

/// The least value that a share `q` of all `count` cases reaches, those without a value never; nothing when too few do.
std::optional<double> least_for(std::vector<double> values, std::size_t count, double q) {
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(count)));
  if (rank == 0 || rank > values.size()) { return std::nullopt; }
  std::ranges::sort(values);
  return values[rank - 1];
}

bool agrees(const TrackStep& step, const Pose2& truth, const TrackingBenchParams& params) {
  return !step.clusters.empty() && distance(step.map_from_robot, truth) <= params.correct_distance &&
         heading_difference(step.map_from_robot, truth) <= params.correct_heading;
}

DriveOutcome track_drive(const PlaceMap& map, const ScanLog& log, const TrackedDrive& drive,
                         const TrackingBenchParams& params) {
  DriveOutcome outcome{.drive = drive, .initialisation = params.tracker.initialisation};
  Tracker tracker(map, params.tracker);
  const bool is_foreign = drive.kind == DriveKind::foreign;
  double cpu_us = 0;
  std::size_t scans = 0;
  std::optional<Pose2> odom_before;
  for (const DrivePart& part : drive.parts) {
    const Pose2 odom_from_log =
        odom_before ? *odom_before * inverse(*log.scans[part.scans.begin].odom_from_robot) : Pose2{};
    outcome.answers.clear();
    double way = 0;
    for (std::size_t i = part.scans.begin; i < part.scans.end; ++i, ++scans) {
      if (i > part.scans.begin) { way += distance(log.map_from_robot[i - 1], log.map_from_robot[i]); }
      Scan scan = log.scans[i];
      odom_before = scan.odom_from_robot = odom_from_log * *scan.odom_from_robot;
      if (i == part.scans.begin) { tracker.prepare(part.removed); }
      const double before = thread_cpu_us();
      TrackStep step = tracker.add(scan, part.removed);
      cpu_us += thread_cpu_us() - before;
      const bool right = !is_foreign && agrees(step, log.map_from_robot[i], params);
      outcome.answers.push_back({.scan = i, .way = way, .step = std::move(step), .agrees = right});
    }
  }
  outcome.cpu_us = scans == 0 ? 0.0 : cpu_us / static_cast<double>(scans);
  return outcome;
}

}  // namespace

std::vector<TrackedDrive> drives_in_own_map(const ScanLog& log, const TrackingBenchParams& params, std::size_t threads,
                                            const Progress& progress) {
  FLIRT_ASSERT(log.map_from_robot.size() == log.scans.size());
  const std::vector<double> lengths = path_lengths(log);
  std::vector<std::size_t> all(log.scans.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  // Whatever drive a scan is in, no more than this leaves the map around it.
  RevisitParams around = params.revisit;
  around.travel += params.length;
  const std::vector<bool> can_answer = answerable(log, all, around, threads, progress);
  std::vector<DrivePart> known;
  std::vector<DrivePart> unmapped;
  for (const std::size_t begin : all) {
    const std::optional<DrivePart> part = part_from(begin, lengths, params.length, params.revisit.travel);
    if (!part) { break; }
    double answered = 0;
    for (std::size_t i = part->scans.begin; i < part->scans.end; ++i) { answered += can_answer[i] ? 1 : 0; }
    const double share = answered / static_cast<double>(part->scans.end - part->scans.begin);
    if (share >= params.covered) { known.push_back(*part); }
    if (share <= 1 - params.covered) { unmapped.push_back(*part); }
  }
  Rng rng(params.seed);
  known = spaced(std::move(known), lengths, params.length / 2, params.drives, rng);
  unmapped = spaced(std::move(unmapped), lengths, params.length / 2, params.drives, rng);
  std::vector<TrackedDrive> drives;
  append(drives, DriveKind::known, known);
  append(drives, DriveKind::unmapped, unmapped);
  append_kidnapped(drives, known, log);
  return drives;
}

std::vector<TrackedDrive> drives_in_other_map(const ScanLog& log, DriveKind kind, const TrackingBenchParams& params) {
  FLIRT_ASSERT(log.map_from_robot.size() == log.scans.size());
  const std::vector<double> lengths = path_lengths(log);
  std::vector<DrivePart> parts;
  for (std::size_t begin = 0; begin < log.scans.size(); ++begin) {
    std::optional<DrivePart> part = part_from(begin, lengths, params.length, 0);
    if (!part) { break; }
    part->removed = {};
    parts.push_back(*part);
  }
  Rng rng(params.seed);
  parts = spaced(std::move(parts), lengths, params.length / 2, params.drives, rng);
  std::vector<TrackedDrive> drives;
  append(drives, kind, parts);
  if (kind == DriveKind::known) { append_kidnapped(drives, parts, log); }
  return drives;
}

std::vector<DriveOutcome> track_drives(const PlaceMap& map, const ScanLog& log, std::span<const TrackedDrive> drives,
                                       TrackInitialisation initialisation, const TrackingBenchParams& params,
                                       std::size_t threads, const Progress& progress) {
  std::vector<DriveOutcome> outcomes(drives.size());
  parallel_for(
      drives.size(), threads,
      [&](std::size_t k, std::size_t /*thread*/) {
        TrackingBenchParams own = params;
        own.tracker.initialisation = initialisation;
        own.tracker.seed = Rng(params.seed, k).bits();
        outcomes[k] = track_drive(map, log, drives[k], own);
      },
      progress);
  return outcomes;
}

DriveResult judge_drive(const DriveOutcome& outcome, TrackCriterion criterion, const TrackingBenchParams& params) {
  DriveResult result;
  bool was_wrong = false;
  for (std::size_t i = 0; i < outcome.answers.size(); ++i) {
    const TrackedAnswer& answer = outcome.answers[i];
    const bool is_sure = criterion == TrackCriterion::verdict ? answer.step.verdict == Verdict::unique
                                                              : answer.step.share >= params.sure_share;
    const bool is_wrong = is_sure && !answer.agrees;
    result.sure += is_sure ? 1U : 0U;
    result.wrong += is_wrong ? 1U : 0U;
    result.convergences += is_wrong && !was_wrong ? 1U : 0U;
    was_wrong = is_wrong;
    if (is_sure && answer.agrees && !result.scans_until) {
      result.scans_until = i + 1;
      result.metres_until = answer.way;
    }
  }
  return result;
}

TrackingSummary summarise(std::span<const DriveOutcome> outcomes, DriveKind kind, TrackInitialisation initialisation,
                          TrackCriterion criterion, const TrackingBenchParams& params) {
  TrackingSummary summary{.kind = kind, .initialisation = initialisation, .criterion = criterion};
  std::vector<double> scans;  // of those that were localized
  std::vector<double> metres;
  std::vector<double> cpu;
  for (const DriveOutcome& outcome : outcomes) {
    if (outcome.drive.kind != kind || outcome.initialisation != initialisation) { continue; }
    const DriveResult result = judge_drive(outcome, criterion, params);
    ++summary.drives;
    if (result.scans_until) {
      scans.push_back(static_cast<double>(*result.scans_until));
      metres.push_back(result.metres_until);
    }
    cpu.push_back(outcome.cpu_us);
    summary.localized.hits += result.scans_until ? 1U : 0U;
    summary.wrong_drives.hits += result.wrong > 0 ? 1U : 0U;
    summary.convergences += result.convergences;
    summary.wrong_scans.hits += result.wrong;
    summary.wrong_scans.total += outcome.answers.size();
    summary.right_scans.hits += result.sure - result.wrong;
    summary.right_scans.total += outcome.answers.size();
  }
  summary.localized.total = summary.wrong_drives.total = summary.drives;
  summary.scans_median = least_for(scans, summary.drives, 0.5);
  summary.scans_95 = least_for(scans, summary.drives, 0.95);
  summary.metres_median = least_for(metres, summary.drives, 0.5);
  summary.metres_95 = least_for(metres, summary.drives, 0.95);
  summary.cpu_us_median = quantile(cpu, 0.5);
  return summary;
}

}  // namespace flirt
