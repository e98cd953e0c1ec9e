#include "flirt/eval/localization.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/eval/bootstrap.hpp"
#include "flirt/registration/join_scans.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

namespace flirt {
namespace {

constexpr std::uint32_t n_min_last = 15;
constexpr std::size_t n_min_count = n_min_last - paper_n_min + 1;
constexpr std::array strategies{PickBy::closest, PickBy::corresp, PickBy::residual};

/// How far a pose is from the truth, in units of the tolerance: what `closest` minimises.
double error_in_tolerances(const Pose2& pose, const Pose2& truth, const LocalizationBenchParams& params) {
  return std::max(distance(pose, truth) / params.tolerance.correct_distance,
                  heading_difference(pose, truth) / params.tolerance.correct_heading);
}

bool better(const Hypothesis& a, const Hypothesis& b, PickBy pick, const Pose2& truth,
            const LocalizationBenchParams& params) {
  switch (pick) {
    case PickBy::closest:
      return error_in_tolerances(a.map_from_sensor, truth, params) <
             error_in_tolerances(b.map_from_sensor, truth, params);
    case PickBy::corresp:
      return a.inliers != b.inliers ? a.inliers > b.inliers : a.residual < b.residual;
    case PickBy::residual:
      return a.residual != b.residual ? a.residual < b.residual : a.inliers > b.inliers;
  }
  return false;
}

const Hypothesis* pick_best(std::span<const Hypothesis> solutions, std::uint32_t n_min, PickBy pick, const Pose2& truth,
                            const LocalizationBenchParams& params) {
  const Hypothesis* best = nullptr;
  for (const Hypothesis& candidate : solutions) {
    if (candidate.inliers < n_min) { continue; }
    if (best == nullptr || better(candidate, *best, pick, truth, params)) { best = &candidate; }
  }
  return best;
}

struct Pick {
  bool answered{false};
  bool correct{false};
};

/// All that is kept of one query, so that solution sets of thousands of hypotheses need not be.
struct Outcome {
  std::array<std::array<Pick, n_min_count>, strategies.size()> picks{};
  std::vector<LocalizationAnswer> answers;
  LocalizeTimes times;
};

LocalizationAnswer answer_from(const Hypothesis* best, std::size_t query, std::string_view strategy, const Pose2& truth,
                               const LocalizationResult& result, const LocalizationBenchParams& params) {
  LocalizationAnswer answer{.query = query, .strategy = strategy, .verdict = to_string(result.verdict)};
  if (best == nullptr) { return answer; }
  answer.answered = true;
  answer.reference = best->map_scan;
  answer.map_from_sensor = best->map_from_sensor;
  answer.inliers = best->inliers;
  answer.residual = best->residual;
  answer.correct =
      is_within(best->map_from_sensor, truth, params.tolerance.correct_distance, params.tolerance.correct_heading);
  answer.precise =
      is_within(best->map_from_sensor, truth, params.tolerance.precise_distance, params.tolerance.precise_heading);
  return answer;
}

void judge_solution_set(const LocalizationResult& result, std::size_t query, const Pose2& truth,
                        const LocalizationBenchParams& params, Outcome& outcome) {
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    for (std::size_t k = 0; k < n_min_count; ++k) {
      const auto n_min = static_cast<std::uint32_t>(paper_n_min + k);
      const Hypothesis* best = pick_best(result.solution_set->hypotheses, n_min, strategies[s], truth, params);
      const LocalizationAnswer answer = answer_from(best, query, to_string(strategies[s]), truth, result, params);
      outcome.picks[s][k] = {answer.answered, answer.correct};
      if (k == 0) {
        outcome.answers.push_back(answer);
        outcome.answers.back().confidence = static_cast<double>(answer.inliers);
      }
    }
  }
}

std::vector<std::uint32_t> bootstrap_blocks(const ScanLog& log, std::span<const std::size_t> queries, double length) {
  const std::vector<double> lengths = path_lengths(log);
  std::vector<std::uint32_t> blocks;
  blocks.reserve(queries.size());
  for (const std::size_t query : queries) { blocks.push_back(static_cast<std::uint32_t>(lengths[query] / length)); }
  return blocks;
}

/// Interval of the share of `hit` among `counted`, one entry per query.
template <class Counted, class Hit>
Interval bootstrap(std::span<const std::uint32_t> blocks, const Counted& counted, const Hit& hit, std::uint64_t seed) {
  std::vector<double> values;
  values.reserve(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    values.push_back(!counted(i) ? std::numeric_limits<double>::quiet_NaN() : hit(i) ? 1.0 : 0.0);
  }
  const Mean share = block_bootstrap_mean(blocks, values, seed);
  return share.cases == 0 ? Interval{0, 1} : share.interval;
}

StrategyCurve strategy_curve(std::span<const Outcome> outcomes, std::size_t s, std::span<const std::uint32_t> blocks,
                             std::uint64_t seed) {
  StrategyCurve curve{.strategy = strategies[s]};
  for (std::size_t k = 0; k < n_min_count; ++k) {
    std::size_t answered = 0;
    std::size_t correct = 0;
    for (const Outcome& outcome : outcomes) {
      answered += outcome.picks[s][k].answered ? 1 : 0;
      correct += outcome.picks[s][k].correct ? 1 : 0;
    }
    curve.n_min.push_back(static_cast<std::uint32_t>(paper_n_min + k));
    curve.precision.push_back({correct, answered});
    curve.recall.push_back({correct, outcomes.size()});
  }
  curve.recall_bootstrap = bootstrap(
      blocks, [](std::size_t) { return true; }, [&](std::size_t i) { return outcomes[i].picks[s][0].correct; }, seed);
  return curve;
}

RevisitSummary revisit_summary(std::span<const LocalizationAnswer> answers, std::span<const std::uint32_t> blocks,
                               std::uint64_t seed) {
  RevisitSummary summary;
  std::vector<ScoredAnswer> scored;
  std::vector<double> squared_errors;
  for (const LocalizationAnswer& answer : answers) {
    scored.push_back({answer.confidence, answer.answered, answer.correct, answer.answerable});
    const bool unique = answer.verdict == to_string(Verdict::unique);
    summary.unique_right.total += unique ? 1 : 0;
    summary.unique_right.hits += unique && answer.correct ? 1 : 0;
    if (answer.correct) { squared_errors.push_back(answer.nees); }
    if (!answer.answerable) { continue; }
    ++summary.unique_found.total;
    summary.unique_found.hits += unique && answer.correct ? 1 : 0;
    ++summary.success.total;
    ++summary.precise_success.total;
    summary.success.hits += answer.correct ? 1 : 0;
    summary.precise_success.hits += answer.precise ? 1 : 0;
  }
  const auto answerable = [&](std::size_t i) { return answers[i].answerable; };
  summary.success_bootstrap = bootstrap(blocks, answerable, [&](std::size_t i) { return answers[i].correct; }, seed);
  summary.precise_bootstrap = bootstrap(blocks, answerable, [&](std::size_t i) { return answers[i].precise; }, seed);
  summary.curve = precision_recall(scored);
  summary.nees = coverage(squared_errors);
  constexpr std::array edges{0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.01};
  summary.reliability = reliability(scored, edges);
  return summary;
}

LocalizationTimes summarise_times(std::span<const Outcome> outcomes, std::size_t pairs) {
  const auto over_queries = [outcomes](double q, const auto& time_of) {
    std::vector<double> times;
    times.reserve(outcomes.size());
    for (const Outcome& outcome : outcomes) { times.push_back(time_of(outcome.times)); }
    return quantile(std::move(times), q);
  };
  double match = 0;
  for (const Outcome& outcome : outcomes) { match += outcome.times.match_us; }
  const auto total = [](const LocalizeTimes& times) { return times.total_us(); };
  return {.detect_median = over_queries(0.5, [](const LocalizeTimes& times) { return times.detect_us; }),
          .describe_median = over_queries(0.5, [](const LocalizeTimes& times) { return times.describe_us; }),
          .per_query_median = over_queries(0.5, total),
          .per_query_p95 = over_queries(0.95, total),
          .per_pair = pairs == 0 ? 0.0 : match / static_cast<double>(pairs),
          .search_median = over_queries(0.5, [](const LocalizeTimes& times) { return times.search_us; }),
          .rank_median = over_queries(0.5, [](const LocalizeTimes& times) { return times.rank_us; }),
          .refine_median = over_queries(0.5, [](const LocalizeTimes& times) { return times.refine_us; }),
          .prepare_median = over_queries(0.5, [](const LocalizeTimes& times) { return times.prepare_us; })};
}

/// The query alone, or the last `params.join` scans as one; none before the log begins.
LocalizationResult answer_to(Localizer& localizer, const ScanLog& log, std::size_t query, ScanInterval excluded,
                             const LocalizationBenchParams& params, LocalizeTimes& times) {
  if (params.join == 1) { return localizer.localize(log.scans[query], excluded, &times); }
  const std::size_t count = std::min(params.join, query + 1);
  const ScanPoints joined =
      join_scans(std::span(log.scans).subspan(query + 1 - count, count), params.localize.search.points);
  return localizer.localize_points(log.scans[query], joined, excluded, &times);
}

}  // namespace

double StrategyCurve::p_cl() const {
  double best = 0;
  for (std::size_t k = 0; k < n_min.size(); ++k) {
    if (precision[k].value() >= 0.95) { best = std::max(best, recall[k].value()); }
  }
  return best;
}

LocalizationBench bench_localization(const ScanLog& log, const PlaceMap& map, const LocalizationBenchParams& params,
                                     std::size_t threads, const Progress& progress) {
  FLIRT_ASSERT(log.map_from_robot.size() == log.scans.size() && map.size() == log.scans.size() && params.every > 0);
  std::vector<std::size_t> queries;
  for (std::size_t i = 0; i < log.scans.size(); i += params.every) { queries.push_back(i); }

  const bool revisit = params.protocol == LocalizationProtocol::revisit;
  FLIRT_ASSERT(revisit || params.localize.papers.ransac.min_inliers <= paper_n_min);
  const std::vector<ScanInterval> removed = travel_neighbours(log, params.revisit.travel);
  const std::vector<bool> can_answer =
      revisit ? answerable(log, queries, params.revisit, threads) : std::vector<bool>(queries.size(), true);

  LocalizeParams localize_params = params.localize;
  if (!revisit) { localize_params.method = LocalizeMethod::papers; }
  std::vector<std::unique_ptr<Localizer>> localizers(thread_count(threads));
  std::vector<Outcome> outcomes(queries.size());
  parallel_for(
      queries.size(), threads,
      [&](std::size_t k, std::size_t thread) {
        if (!localizers[thread]) { localizers[thread] = std::make_unique<Localizer>(map, localize_params); }
        const std::size_t query = queries[k];
        const std::size_t first = query + 1 - std::min(params.join, query + 1);
        const ScanInterval excluded =
            revisit ? ScanInterval{removed[first].begin, removed[query].end} : ScanInterval{query, query + 1};
        const LocalizationResult result =
            answer_to(*localizers[thread], log, query, excluded, params, outcomes[k].times);
        const Pose2 truth = log.map_from_sensor(query);
        if (revisit) {
          outcomes[k].answers.push_back(answer_of(result, map, query, excluded));
          compare_with_truth(outcomes[k].answers.back(), result, truth, params.tolerance);
        } else {
          judge_solution_set(result, query, truth, params, outcomes[k]);
        }
      },
      progress);

  LocalizationBench bench{.queries = queries.size(), .map_scans = map.size()};
  bench.blocks = bootstrap_blocks(log, queries, params.block_length);
  std::size_t pairs = 0;
  for (std::size_t k = 0; k < queries.size(); ++k) {
    bench.answerable += can_answer[k] ? 1 : 0;
    const std::size_t gone = revisit ? removed[queries[k]].end - removed[queries[k]].begin : 1;
    pairs += map.size() - gone;
    for (LocalizationAnswer& answer : outcomes[k].answers) {
      answer.answerable = can_answer[k];
      bench.answers.push_back(answer);
    }
  }
  bench.features_per_scan =
      map.size() == 0 ? 0.0 : static_cast<double>(map.feature_count()) / static_cast<double>(map.size());
  bench.times = summarise_times(outcomes, pairs);
  if (revisit) {
    bench.revisit = revisit_summary(bench.answers, bench.blocks, params.seed);
  } else {
    for (std::size_t s = 0; s < strategies.size(); ++s) {
      bench.strategies.push_back(strategy_curve(outcomes, s, bench.blocks, params.seed));
    }
  }
  return bench;
}

}  // namespace flirt
