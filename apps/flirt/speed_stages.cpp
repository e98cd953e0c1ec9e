// apps/flirt/speed_stages.cpp: what one scan costs, stage by stage.
#include "flirt/eval/statistics.hpp"
#include "flirt/features/extract.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/match/pair_matcher.hpp"

#include "apps/flirt/speed_section.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace flirt::app {
namespace {

constexpr int repetitions = 5;  // of which the median counts

struct ScanFeatures {
  Features features;
  KeypointTable table;

  [[nodiscard]] FeatureColumns columns() const { return {table.columns(), rows_of(features.descriptors)}; }
};

/// Median over repetitions of what `work` takes, µs for each of its `count` parts.
template <class Work>
double median_us(std::size_t count, const Work& work) {
  std::vector<double> times;
  for (int i = 0; i < repetitions; ++i) { times.push_back(1e6 * seconds_of(work) / static_cast<double>(count)); }
  return quantile(times, 0.5);
}

class Stages {
 public:
  /// At most `most` of the log's scans, evenly spread.
  Stages(const ScanLog& log, std::size_t most) {
    const std::size_t count = std::min(most, log.scans.size());
    for (std::size_t i = 0; i < count; ++i) { scans_.push_back(log.scans[i * log.scans.size() / count]); }
    for (const Scan& scan : scans_) {
      Features features = extract(scan);
      KeypointTable table = table_of(features.keypoints);
      features_.push_back({std::move(features), std::move(table)});
    }
  }

  void add_features(nlohmann::ordered_json& rows) const {
    std::size_t beams = 0;
    std::size_t keypoints = 0;
    for (const Scan& scan : scans_) { beams += scan.ranges.size(); }
    for (const ScanFeatures& scan : features_) { keypoints += scan.features.keypoints.size(); }
    Detector detector;
    Describer describer;
    add(rows, "detect", "a scan", median_us(scans_.size(), [&] {
          for (const Scan& scan : scans_) { static_cast<void>(detector.detect(scan)); }
        }));
    rows.back()["each_has"] = std::to_string(beams / scans_.size()) + " beams";
    add(rows, "describe", "a scan", median_us(scans_.size(), [&] {
          for (std::size_t i = 0; i < scans_.size(); ++i) {
            static_cast<void>(describer.describe(scans_[i], features_[i].features.keypoints));
          }
        }));
    rows.back()["each_has"] = std::to_string(keypoints / scans_.size()) + " keypoints";
  }

  void add_pairs(nlohmann::ordered_json& rows) const {
    PairMatcher matcher;
    const std::size_t pairs = scans_.size() * scans_.size();
    add(rows, "match query after query", "a pair", median_us(pairs, [&] {
          for (const ScanFeatures& query : features_) {
            matcher.set_query(query.columns());
            for (const ScanFeatures& reference : features_) { static_cast<void>(matcher.align(reference.columns())); }
          }
        }));
    add(rows, "match a pair alone", "a pair", median_us(pairs, [&] {
          for (const ScanFeatures& query : features_) {
            for (const ScanFeatures& reference : features_) {
              PairMatcher own;
              own.set_query(query.columns());
              static_cast<void>(own.align(reference.columns()));
            }
          }
        }));
  }

  /// Features of the query included.
  void add_queries(nlohmann::ordered_json& rows, const PlaceMap& map) const {
    for (const LocalizeMethod method : {LocalizeMethod::papers, LocalizeMethod::automatic}) {
      Localizer localizer(map, {.method = method});
      static_cast<void>(localizer.localize(scans_.front()));  // prepares what all queries share
      std::vector<double> times;
      for (const Scan& scan : scans_) {
        times.push_back(1e6 * seconds_of([&] { static_cast<void>(localizer.localize(scan)); }));
      }
      add(rows, "localize by " + std::string(to_string(method)), "a query", quantile(times, 0.5));
      rows.back()["p95_us"] = quantile(times, 0.95);
      rows.back()["each_has"] = std::to_string(map.size()) + " map scans";
    }
  }

 private:
  static void add(nlohmann::ordered_json& rows, std::string stage, std::string_view unit, double us) {
    rows.push_back(
        {{"stage", std::move(stage)}, {"unit", unit}, {"median_us", us}, {"p95_us", nullptr}, {"each_has", ""}});
  }

  std::vector<Scan> scans_{};
  std::vector<ScanFeatures> features_{};
};

}  // namespace

SpeedSection speed_stages(const SpeedOptions& options, const Session& session) {
  const ScanLog log = speed_log(options, session);
  const Stages stages(log, options.queries);
  SpeedSection section;
  stages.add_features(section.rows);
  stages.add_pairs(section.rows);
  stages.add_queries(section.rows, value_or_quit(build_place_map(log, {}, session.threads)));
  return section;
}

}  // namespace flirt::app
