// apps/flirt/localization_json.cpp: results of `flirt bench localization` for other programs.
#include "apps/flirt/localization_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

namespace flirt::app {
namespace {

nlohmann::ordered_json pair_of(Interval interval) {
  return {interval.low, interval.high};
}

/// Of a share whose count is known.
nlohmann::ordered_json wilson_of(double share, std::size_t total) {
  const auto hits = static_cast<std::size_t>(std::lround(share * static_cast<double>(total)));
  return pair_of(Rate{hits, total}.wilson());
}

nlohmann::ordered_json strategy_json(const StrategyCurve& curve) {
  nlohmann::ordered_json json{{"p_gl", curve.p_gl().value()},
                              {"p_gl_wilson", pair_of(curve.p_gl().wilson())},
                              {"p_gl_bootstrap", pair_of(curve.recall_bootstrap)},
                              {"p_gl_as_precision", curve.precision_at_least().value()},
                              {"p_gl_as_precision_wilson", pair_of(curve.precision_at_least().wilson())},
                              {"p_cl", curve.p_cl()},
                              {"p_cl_wilson", wilson_of(curve.p_cl(), curve.p_gl().total)},
                              {"n_min", curve.n_min}};
  for (std::size_t k = 0; k < curve.n_min.size(); ++k) {
    json["precision"].push_back(curve.precision[k].value());
    json["precision_wilson"].push_back(pair_of(curve.precision[k].wilson()));
    json["recall"].push_back(curve.recall[k].value());
    json["recall_wilson"].push_back(pair_of(curve.recall[k].wilson()));
  }
  return json;
}

nlohmann::ordered_json reliability_json(const RevisitSummary& summary) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const ReliabilityBin& bin : summary.reliability) {
    json.push_back({{"from", bin.low},
                    {"to", std::min(1.0, bin.high)},
                    {"mean_confidence", bin.mean_confidence},
                    {"answers", bin.right.total},
                    {"right", bin.right.value()},
                    {"right_wilson", pair_of(bin.right.wilson())}});
  }
  return json;
}

nlohmann::ordered_json nees_json(const Coverage& nees) {
  return {{"answers", nees.within_50.total},
          {"within_50", nees.within_50.value()},
          {"within_50_wilson", pair_of(nees.within_50.wilson())},
          {"within_90", nees.within_90.value()},
          {"within_90_wilson", pair_of(nees.within_90.wilson())},
          {"within_95", nees.within_95.value()},
          {"within_95_wilson", pair_of(nees.within_95.wilson())},
          {"median", nees.median}};
}

nlohmann::ordered_json distractors_json(const DistractorSummary& summary) {
  return {{"queries", summary.unique.total},
          {"unique", summary.unique.hits},
          {"rate", summary.unique.value()},
          {"wilson", pair_of(summary.unique.wilson())},
          {"confidence_tenths", summary.confidences}};
}

nlohmann::ordered_json ablation_json(std::span<const LocalizationVariantRow> rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const LocalizationVariantRow& row : rows) {
    json.push_back({{"name", row.name},
                    {"meaning", row.meaning},
                    {"queries", row.success.total},
                    {"success", row.success.value()},
                    {"success_wilson", pair_of(row.success.wilson())},
                    {"recall_at_99", row.recall_at_99},
                    {"unique_found", row.unique_found},
                    {"query_median_us", row.query_median_us},
                    {"only_full_right", row.from_full.only_first},
                    {"only_variant_right", row.from_full.only_second},
                    {"mcnemar_p", row.from_full.p_value()},
                    {"difference_bootstrap", pair_of(row.difference)}});
  }
  return json;
}

nlohmann::ordered_json revisit_json(const RevisitSummary& summary) {
  nlohmann::ordered_json json;
  for (const auto& [key, precision] :
       {std::pair{"recall_at_95", 0.95}, {"recall_at_99", 0.99}, {"recall_at_100", 1.0}}) {
    const double recall = recall_at_precision(summary.curve, precision);
    json[key] = recall;
    json[std::string(key) + "_wilson"] = wilson_of(recall, summary.success.total);
  }
  json.update({{"average_precision", average_precision(summary.curve)},
               {"unique_right", summary.unique_right.value()},
               {"unique_right_wilson", pair_of(summary.unique_right.wilson())},
               {"unique_found", summary.unique_found.value()},
               {"unique_found_wilson", pair_of(summary.unique_found.wilson())},
               {"reliability", reliability_json(summary)},
               {"success", summary.success.value()},
               {"success_wilson", pair_of(summary.success.wilson())},
               {"success_bootstrap", pair_of(summary.success_bootstrap)},
               {"success_025m_5deg", summary.precise_success.value()},
               {"success_025m_5deg_wilson", pair_of(summary.precise_success.wilson())},
               {"success_025m_5deg_bootstrap", pair_of(summary.precise_bootstrap)},
               {"nees", nees_json(summary.nees)}});
  return json;
}

void append_line(std::string& csv, const LocalizationAnswer& answer, std::string_view strategy) {
  csv += fmt::format("{},{},{},", answer.query, strategy, answer.answerable ? 1 : 0);
  if (answer.answered) {
    const Pose2& pose = answer.map_from_sensor;
    csv += fmt::format("{},{:.6f},{:.6f},{:.6f},{:.6g},{},{:.6g},", answer.reference, pose.x, pose.y, pose.theta,
                       answer.confidence, answer.inliers, answer.residual);
  } else {
    csv += ",,,,,,,";
  }
  csv += fmt::format("{},{}\n", answer.verdict, answer.correct ? 1 : 0);
}

}  // namespace

DistractorSummary all_distractors(const LocalizationRun& run) {
  std::vector<LocalizationAnswer> all;
  for (const DistractorRun& other : run.distractors) {
    all.insert(all.end(), other.answers.begin(), other.answers.end());
  }
  return summarise_distractors(all);
}

std::string with_interval(const Rate& rate) {
  const Interval interval = rate.wilson();
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", rate.value(), interval.low, interval.high);
}

std::string interval_text(Interval interval) {
  return fmt::format("[{:.3f}, {:.3f}]", interval.low, interval.high);
}

nlohmann::ordered_json localization_json(const LocalizationRun& run, const Session& session) {
  const LocalizationBench& bench = run.bench;
  nlohmann::ordered_json json{{"log", run.log},
                              {"protocol", run.protocol},
                              {"queries", bench.queries},
                              {"answerable", bench.answerable},
                              {"features_per_scan", bench.features_per_scan}};
  if (!run.poses.empty()) { json["poses"] = run.poses; }
  json["strategies"] = nlohmann::ordered_json::object();
  for (const StrategyCurve& curve : bench.strategies) {
    json["strategies"][std::string(to_string(curve.strategy))] = strategy_json(curve);
  }
  json["revisit"] = bench.revisit ? revisit_json(*bench.revisit) : nlohmann::ordered_json(nullptr);
  if (!run.distractors.empty()) {
    nlohmann::ordered_json& json_of = json["revisit"]["distractors"] = distractors_json(all_distractors(run));
    for (const DistractorRun& other : run.distractors) {
      nlohmann::ordered_json part = distractors_json(summarise_distractors(other.answers));
      part["log"] = other.log;
      json_of["logs"].push_back(part);
    }
  }
  if (!run.ablation.empty()) { json["ablation"] = ablation_json(run.ablation); }
  const LocalizationTimes& times = bench.times;
  json["time_us"] = {{"detect", stage_json(times.detect_median)},  {"describe", stage_json(times.describe_median)},
                     {"per_query_median", times.per_query_median}, {"per_query_p95", times.per_query_p95},
                     {"per_pair", stage_json(times.per_pair)},     {"search", stage_json(times.search_median)},
                     {"rank", stage_json(times.rank_median)},      {"refine", stage_json(times.refine_median)},
                     {"prepare", stage_json(times.prepare_median)}};
  json["map_scans"] = bench.map_scans;
  json["every"] = run.every;
  if (run.join > 1) { json["join"] = run.join; }
  json["method"] = bench.revisit ? run.method : "papers";
  json["feature_params"] = run.feature_params;
  json["params"] = run.params;
  json["seed"] = session.seed;
  json.update(provenance());
  return json;
}

namespace {

/// Calls visit(answer, strategy) for each answer, those to distractors last.
template <class Visit>
void for_each_answer(const LocalizationRun& run, const Visit& visit) {
  for (const LocalizationAnswer& answer : run.bench.answers) { visit(answer, answer.strategy); }
  for (std::size_t i = 0; i < run.distractors.size(); ++i) {
    const std::string strategy = fmt::format("distractor:{}", i + 1);
    for (const LocalizationAnswer& answer : run.distractors[i].answers) { visit(answer, strategy); }
  }
}

}  // namespace

std::string queries_csv(const LocalizationRun& run) {
  std::string csv = "query,strategy,answerable,reference,x,y,theta,confidence,inliers,residual,verdict,correct\n";
  for_each_answer(
      run, [&](const LocalizationAnswer& answer, std::string_view strategy) { append_line(csv, answer, strategy); });
  return csv;
}

std::string evidence_csv(const LocalizationRun& run) {
  std::string csv =
      "query,strategy,answerable,correct,precise,verdict,reason,confidence,points,margin,score,likelihood,free,unknown,"
      "through,near,residual,nees\n";
  for_each_answer(run, [&](const LocalizationAnswer& answer, std::string_view strategy) {
    const EvidenceScore& score = answer.evidence;
    csv += fmt::format(
        "{},{},{},{},{},{},{},{:.6g},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.5f},{:.4g}\n", answer.query,
        strategy, answer.answerable ? 1 : 0, answer.correct ? 1 : 0, answer.precise ? 1 : 0, answer.verdict,
        answer.reason, answer.confidence, answer.points, answer.margin, score.total, score.likelihood, score.free,
        score.unknown, score.through, score.near, score.residual, answer.nees);
  });
  return csv;
}

}  // namespace flirt::app
