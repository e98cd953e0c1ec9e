// apps/flirt/speed_stages.cpp: what each stage takes for one scan: detect, describe, a pair alone, a pair within a
// query.
#include "flirt/eval/cpu_time.hpp"
#include "flirt/eval/statistics.hpp"
#include "flirt/features/extract.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/map/solution_set.hpp"
#include "flirt/match/feature_table.hpp"
#include "flirt/match/pair_matcher.hpp"

#include "apps/flirt/speed_log.hpp"
#include "apps/flirt/speed_section.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace flirt::app {
namespace {

constexpr std::size_t passes = 9;
constexpr std::size_t scans_in_a_pass = 64;

struct Times {
  double least{0};
  double median{0};
  double p95{0};

  [[nodiscard]] Times operator*(double factor) const { return {factor * least, factor * median, factor * p95}; }
};

/// CPU time of one of the `count` things that `pass` does, µs: other work on the machine adds to it, never takes away.
template <class Pass>
Times timed(std::size_t count, const Pass& pass) {
  pass();  // allocates
  std::vector<double> times;
  for (std::size_t i = 0; i < passes; ++i) {
    const double start = process_cpu_us();
    pass();
    times.push_back((process_cpu_us() - start) / static_cast<double>(count));
  }
  return {std::ranges::min(times), quantile(times, 0.5), quantile(times, 0.95)};
}

/// A scan with its features.
struct Sample {
  const Scan* scan;
  FeatureTable table;
};

std::vector<Sample> samples_of(const ScanLog& log) {
  FeatureExtractor extractor;
  std::vector<Sample> samples;
  for (const std::size_t i : spread_evenly(log.scans.size(), scans_in_a_pass)) {
    samples.push_back({&log.scans[i], feature_table(extractor.extract(log.scans[i]))});
  }
  return samples;
}

/// Rows of one log.
class StageTable {
 public:
  StageTable(const SpeedLog& log, nlohmann::ordered_json& rows)
      : name_(log.name), beams_(log.log.scans.front().ranges.size()), rows_(rows) {}

  [[nodiscard]] std::size_t beams() const { return beams_; }

  void add(const std::string& stage, const std::string& unit, const Times& times, std::optional<double> target) {
    nlohmann::ordered_json row{
        {"log", name_},         {"beams", beams_},
        {"stage", stage},       {"unit", unit},
        {"least", times.least}, {"median", times.median},
        {"p95", times.p95},     {"target", target ? nlohmann::ordered_json(*target) : nlohmann::ordered_json()}};
    rows_.push_back(std::move(row));
  }

 private:
  std::string name_;
  std::size_t beams_;
  nlohmann::ordered_json& rows_;
};

std::optional<double> detect_target(std::size_t beams) {
  if (beams <= 181) { return 30.0; }
  return beams <= 361 ? std::optional(60.0) : std::nullopt;
}

void add_features(const std::vector<Sample>& samples, StageTable& table) {
  Detector detector{DetectorParams{}};
  const auto detect_all = [&] {
    for (const Sample& sample : samples) { (void)detector.detect(*sample.scan); }
  };
  table.add("detect", "us", timed(samples.size(), detect_all), detect_target(table.beams()));

  Describer describer{DescriptorParams{}};
  std::size_t keypoints = 0;
  for (const Sample& sample : samples) { keypoints += sample.table.features.keypoints.size(); }
  const auto describe_all = [&] {
    for (const Sample& sample : samples) { (void)describer.describe(*sample.scan, sample.table.features.keypoints); }
  };
  const Times a_keypoint = timed(std::max<std::size_t>(keypoints, 1), describe_all);
  table.add("describe 24 keypoints", "us", a_keypoint * 24, 60.0);
}

/// All pairs of the samples, as if each were the only one.
void add_pair_alone(const std::vector<Sample>& samples, StageTable& table) {
  PairMatcher matcher;
  const auto match_all = [&] {
    for (const Sample& query : samples) {
      for (const Sample& reference : samples) {
        matcher.set_query(query.table.columns());
        (void)matcher.align(reference.table.columns());
      }
    }
  };
  table.add("pair alone", "us", timed(samples.size() * samples.size(), match_all), 10.0);
}

/// The papers' method against a map of the whole log.
void add_query(const SpeedOptions& options, const ScanLog& log, const std::vector<Sample>& samples, StageTable& table,
               const Session& session) {
  constexpr std::size_t real_map = 1464;  // the scans that the target of a query speaks of
  const PlaceMap map = value_or_quit(build_place_map(log, {}, session.threads), options.log);
  SolutionSetFinder finder(map);
  const std::size_t queries = std::min<std::size_t>(samples.size(), 16);
  const auto find_all = [&] {
    for (std::size_t i = 0; i < queries; ++i) {
      (void)finder.find(samples[i * samples.size() / queries].table.features);
    }
  };
  const Times query = timed(queries, find_all);
  const auto scans = static_cast<double>(map.size());
  table.add("pair within a query", "us", query * (1 / scans), 3.0);
  const bool is_real_map = map.size() == real_map;
  table.add("query of " + std::to_string(map.size()) + " scans", "ms", query * 1e-3,
            is_real_map ? std::optional(3.0) : std::nullopt);
  const double megabytes = static_cast<double>(map.bytes()) * 1e-6;
  table.add("map", "MB", {megabytes, megabytes, megabytes}, is_real_map ? std::optional(20.0) : std::nullopt);
}

/// Least times in the order of the rows, and the targets.
svg::Figure stages_figure(const nlohmann::ordered_json& rows) {
  svg::Chart chart{.title = "Time of a stage, in the order of the table",
                   .x = {.label = "row"},
                   .y = {.label = "least of 9 (µs)", .scale = svg::AxisScale::logarithmic}};
  svg::Series measured{.legend = "measured", .style = svg::series_style(0)};
  svg::Series wanted{.legend = "target", .style = svg::series_style(1)};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i]["unit"] != "us") { continue; }
    measured.x.push_back(static_cast<double>(i + 1));
    measured.y.push_back(rows[i]["least"]);
    if (rows[i]["target"].is_null()) { continue; }
    wanted.x.push_back(static_cast<double>(i + 1));
    wanted.y.push_back(rows[i]["target"]);
  }
  chart.series = {measured, wanted};
  return {.panels = {chart}};
}

}  // namespace

SpeedSection speed_stages(const SpeedOptions& options, const Session& session) {
  std::vector<SpeedLog> logs;
  if (options.log.empty()) {
    logs.push_back(simulated_log(180, session));
    logs.push_back(simulated_log(360, session));
  } else {
    logs.push_back(given_log(options, session));
  }
  SpeedSection section;
  for (const SpeedLog& log : logs) {
    const std::vector<Sample> samples = samples_of(log.log);
    StageTable table(log, section.rows);
    add_features(samples, table);
    add_pair_alone(samples, table);
    add_query(options, log.log, samples, table, session);
  }
  section.figure = stages_figure(section.rows);
  return section;
}

}  // namespace flirt::app
