#include "flirt/eval/arena.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/eval/arena_features.hpp"
#include "flirt/eval/arena_shortlist.hpp"
#include "flirt/eval/cpu_time.hpp"
#include "flirt/map/localize.hpp"

#include <algorithm>
#include <memory>
#include <span>

namespace flirt {
namespace {

constexpr std::uint32_t fewest_inliers = 3;
constexpr std::uint32_t most_inliers = 15;

ArenaQueries queries_of(const ScanLog& log, const ArenaParams& params, std::size_t threads) {
  ArenaQueries queries;
  for (std::size_t i = 0; i < log.scans.size(); i += params.every) { queries.scans.push_back(i); }
  queries.removed = travel_neighbours(log, params.revisit.travel);
  queries.answerable = answerable(log, queries.scans, params.revisit, threads);
  return queries;
}

/// A match with one map scan.
struct Found {
  Pose2 map_from_sensor{};
  std::uint32_t inliers{0};
  double residual{0};
};

/// Keeps what the answers of one query under one protocol are picked from.
struct BestFound {
  std::optional<Found> by_inliers{};
  std::optional<Found> by_residual{};

  void offer(const Found& found) {
    if (!by_inliers || found.inliers > by_inliers->inliers ||
        (found.inliers == by_inliers->inliers && found.residual < by_inliers->residual)) {
      by_inliers = found;
    }
    if (!by_residual || found.residual < by_residual->residual ||
        (found.residual == by_residual->residual && found.inliers > by_residual->inliers)) {
      by_residual = found;
    }
  }
  [[nodiscard]] ArenaAnswer answer(const Pose2& truth, const PoseTolerance& tolerance) const {
    const auto is_right = [&](const std::optional<Found>& found) {
      return found && is_within(found->map_from_sensor, truth, tolerance.correct_distance, tolerance.correct_heading);
    };
    return {by_inliers ? by_inliers->inliers : 0, is_right(by_inliers), is_right(by_residual)};
  }
};

/// The rates and the curve of the answers.
void summarise(ArenaProtocolResult& result) {
  for (std::uint32_t n = fewest_inliers; n <= most_inliers; ++n) { result.curve.push_back({.inliers = n}); }
  for (const ArenaAnswer& answer : result.answers) {
    if (!answer.counts) { continue; }
    ++result.by_inliers.total;
    ++result.by_residual.total;
    result.by_inliers.hits += answer.right_by_inliers ? 1 : 0;
    result.by_residual.hits += answer.right_by_residual ? 1 : 0;
    for (ArenaPoint& point : result.curve) {
      const bool is_accepted = answer.inliers >= point.inliers;
      const bool is_right = is_accepted && answer.right_by_inliers;
      point.precision.total += is_accepted ? 1 : 0;
      point.precision.hits += is_right ? 1 : 0;
      ++point.recall.total;
      point.recall.hits += is_right ? 1 : 0;
    }
  }
  for (const ArenaPoint& point : result.curve) {
    if (point.precision.value() >= 0.95) { result.recall_at_95 = std::max(result.recall_at_95, point.recall.value()); }
  }
}

void compare(const ArenaProtocolResult& ours, ArenaProtocolResult& other) {
  for (std::size_t k = 0; k < ours.answers.size(); ++k) {
    if (!ours.answers[k].counts) { continue; }
    const bool first = ours.answers[k].right_by_residual;
    const bool second = other.answers[k].right_by_residual;
    other.with_default.only_first += first && !second ? 1 : 0;
    other.with_default.only_second += second && !first ? 1 : 0;
  }
}

/// Room for the answers of all queries.
ContenderResult unanswered(const ArenaQueries& queries) {
  ContenderResult result;
  for (ArenaProtocolResult& protocol : result.protocols) { protocol.answers.resize(queries.scans.size()); }
  return result;
}

void match_all(const ScanLog& log, const DescribedLog& described, const Contender& contender,
               const ArenaQueries& queries, const ArenaParams& params, std::size_t threads, const Progress& progress,
               ContenderResult& result) {
  ArenaMatcherParams matcher_params = params.matchers;
  if (contender.descriptor) { matcher_params.match = match_params_of(contender.descriptor->params); }
  const CandidateSource source = contender.descriptor ? CandidateSource::descriptors : CandidateSource::all_pairs;
  std::vector<ContenderMatcher> matchers(thread_count(threads),
                                         ContenderMatcher(contender.matcher, source, matcher_params));
  std::vector<double> times(queries.scans.size());
  parallel_for(
      queries.scans.size(), threads,
      [&](std::size_t k, std::size_t thread) {
        const std::size_t query = queries.scans[k];
        std::array<BestFound, arena_protocols.size()> best;
        const double before = thread_cpu_us();
        matchers[thread].set_query(described.scans[query]);
        for (std::size_t i = 0; i < log.scans.size(); ++i) {
          if (i == query) { continue; }
          const std::optional<PairAlignment> aligned = matchers[thread].align(described.scans[i]);
          if (!aligned) { continue; }
          const Found found{log.map_from_sensor(i) * aligned->reference_from_query, aligned->inliers,
                            aligned->residual};
          for (const ArenaProtocol protocol : arena_protocols) {
            if (!queries.excluded(k, protocol).contains(i)) { best[static_cast<std::size_t>(protocol)].offer(found); }
          }
        }
        times[k] = (thread_cpu_us() - before) / static_cast<double>(std::max<std::size_t>(2, log.scans.size()) - 1);
        for (const ArenaProtocol protocol : arena_protocols) {
          const auto p = static_cast<std::size_t>(protocol);
          result.protocols[p].answers[k] = best[p].answer(log.map_from_sensor(query), params.tolerance);
          result.protocols[p].answers[k].counts = queries.counts(k, protocol);
        }
      },
      progress);
  result.times.match_us = mean_us(times);
}

/// Ours by the beams themselves: no keypoints, no single map scans.
Result<ContenderResult> localize_all(const ScanLog& log, const ArenaQueries& queries, const ArenaParams& params,
                                     std::size_t threads) {
  const Result<PlaceMap> map = build_place_map(log, {}, threads);
  if (!map) { return tl::unexpected(map.error()); }
  ContenderResult result = unanswered(queries);
  result.detector = result.descriptor = "none";
  result.matcher = "beams";
  for (const ArenaProtocol protocol : arena_protocols) {
    ArenaProtocolResult& own = result.protocols[static_cast<std::size_t>(protocol)];
    std::vector<std::unique_ptr<Localizer>> localizers(thread_count(threads));
    std::vector<double> times(queries.scans.size());
    std::vector<ScoredAnswer> scored(queries.scans.size());
    parallel_for(queries.scans.size(), threads, [&](std::size_t k, std::size_t thread) {
      if (!localizers[thread]) { localizers[thread] = std::make_unique<Localizer>(*map); }
      const std::size_t query = queries.scans[k];
      const ScanInterval excluded = queries.excluded(k, protocol);
      static_cast<void>(localizers[thread]->fields(excluded));  // a cost of evaluation, not of the query
      const double before = thread_cpu_us();
      const LocalizationResult found = localizers[thread]->localize(log.scans[query], excluded);
      times[k] = (thread_cpu_us() - before) / static_cast<double>(std::max<std::size_t>(2, log.scans.size()) - 1);
      const PoseHypothesis* best = found.best();
      const bool is_right =
          best != nullptr && is_within(best->map_from_sensor, log.map_from_sensor(query),
                                       params.tolerance.correct_distance, params.tolerance.correct_heading);
      own.answers[k] = {0, is_right, is_right, queries.counts(k, protocol)};
      scored[k] = {found.confidence, best != nullptr, is_right, own.answers[k].counts};
    });
    summarise(own);
    own.curve.clear();
    own.recall_at_95 = recall_at_precision(precision_recall(scored), 0.95);
    result.times.match_us = mean_us(times);
  }
  return result;
}

template <class Named>
bool is_asked(const std::vector<std::string>& names, const Named& name) {
  return names.empty() || std::ranges::find(names, name) != names.end();
}

}  // namespace

MatchParams match_params_of(const AnyDescriptorParams& descriptor) {
  MatchParams params;
  if (const auto* bits = std::get_if<BscParams>(&descriptor)) {
    params.strategy = MatchStrategy::top_k;
    params.k = 1;
    params.max_distance = 20.0 / (bits->rings * bits->sectors);
  } else if (std::holds_alternative<CghParams>(descriptor)) {
    params.max_distance = 0.5;
  }
  return params;
}

std::vector<Contender> contenders(const std::vector<std::string>& detectors,
                                  const std::vector<std::string>& descriptors,
                                  const std::vector<std::string>& matchers) {
  std::vector<Contender> list{{all_detectors().front(), all_descriptors().front(), ArenaMatcher::ransac}};
  for (const NamedDetector& detector : all_detectors()) {
    if (!is_asked(detectors, detector.name)) { continue; }
    const bool is_default = detector.name == list.front().detector.name;
    for (const NamedDescriptor& descriptor : all_descriptors()) {
      if (!is_asked(descriptors, descriptor.name)) { continue; }
      for (const auto& [matcher, name] : enum_names(ArenaMatcher{})) {
        const bool is_first =
            is_default && descriptor.name == list.front().descriptor->name && matcher == ArenaMatcher::ransac;
        if (is_asked(matchers, name) && !is_first) { list.push_back({detector, descriptor, matcher}); }
      }
    }
    for (const auto& [matcher, name] : enum_names(ArenaMatcher{})) {
      const bool needs_descriptors = matcher == ArenaMatcher::ransac;
      if (!needs_descriptors && is_asked(descriptors, std::string("none")) && is_asked(matchers, name)) {
        list.push_back({detector, std::nullopt, matcher});
      }
    }
  }
  return list;
}

Result<Arena> bench_arena(const ScanLog& log, const std::vector<Contender>& list, const ArenaParams& params,
                          std::size_t threads, const Progress& progress) {
  FLIRT_ASSERT(log.map_from_robot.size() == log.scans.size() && params.every > 0 && !list.empty());
  const ArenaQueries queries = queries_of(log, params, threads);
  Arena arena{.queries = queries.scans.size(), .scans = log.scans.size()};
  arena.answerable = static_cast<std::size_t>(std::ranges::count(queries.answerable, true));
  DetectedLog detected;
  DescribedLog described;
  for (std::size_t c = 0; c < list.size(); ++c) {
    const Contender& contender = list[c];
    ContenderResult result = unanswered(queries);
    result.detector = contender.detector.name;
    result.descriptor = contender.descriptor ? contender.descriptor->name : "none";
    result.matcher = to_string(contender.matcher);
    const bool same_detector = c > 0 && arena.contenders.back().detector == result.detector;
    if (!same_detector) {
      detected = detect_all(log, contender.detector, queries, params, threads);
      const auto is_known = [&](const ShortlistResult& known) { return known.detector == result.detector; };
      if (std::ranges::none_of(arena.shortlists, is_known)) {
        arena.shortlists.push_back(bench_shortlist(result.detector, log, detected.keypoints, queries, params, threads));
      }
    }
    if (!same_detector || arena.contenders.back().descriptor != result.descriptor) {
      described = describe_all(log, detected, contender.descriptor, queries, params, threads);
    }
    result.keypoints = detected.per_scan;
    result.repeatability = detected.repeatability;
    result.average_precision = described.average_precision;
    result.times = {detected.detect_us, described.describe_us, 0};
    const auto share = [&](double done) {
      if (progress) { progress((static_cast<double>(c) + done) / static_cast<double>(list.size())); }
    };
    match_all(log, described, contender, queries, params, threads, share, result);
    for (ArenaProtocolResult& protocol : result.protocols) { summarise(protocol); }
    arena.contenders.push_back(std::move(result));
  }
  Result<ContenderResult> beams = localize_all(log, queries, params, threads);
  if (!beams) { return tl::unexpected(beams.error()); }
  arena.contenders.push_back(std::move(*beams));
  for (ContenderResult& result : arena.contenders) {
    for (std::size_t p = 0; p < arena_protocols.size(); ++p) {
      compare(arena.contenders.front().protocols[p], result.protocols[p]);
    }
  }
  return arena;
}

}  // namespace flirt
