// bench/instructions/probe.cpp: one stage of the work, on the same simulated scans each time, for callgrind.
//
//   valgrind --tool=callgrind --toggle-collect='measured_*' flirt_probe detect|describe|match|query
//
// What is done in a function `measured_…` counts; what prepares it does not. Prints how much was found, so that it can
// be seen whether two builds did the same.
#include "flirt/features/extract.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/match/pair_matcher.hpp"
#include "flirt/sim/office.hpp"
#include "flirt/sim/simulate.hpp"

#include <cstdio>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {
namespace {

ScanLog drive() {
  SimulateParams params;
  params.drive.rounds = 1;
  params.drive.scan_distance = 1.0;
  params.drive.scan_turn = 1.0;
  params.seed = 1;
  params.threads = 1;
  auto simulation = simulate(make_office({.area = 300}), params);
  return simulation ? std::move(simulation->log) : ScanLog{};
}

struct ScanFeatures {
  Features features{};
  KeypointTable table{};

  [[nodiscard]] FeatureColumns columns() const { return {table.columns(), rows_of(features.descriptors)}; }
};

std::vector<ScanFeatures> features_of(const ScanLog& log) {
  std::vector<ScanFeatures> all;
  for (const Scan& scan : log.scans) {
    Features features = extract(scan);
    KeypointTable table = table_of(features.keypoints);
    all.push_back({std::move(features), std::move(table)});
  }
  return all;
}

}  // namespace

extern "C" {

[[gnu::noinline]] std::size_t measured_detect(Detector& detector, const ScanLog& log) {
  std::size_t keypoints = 0;
  for (const Scan& scan : log.scans) { keypoints += detector.detect(scan).size(); }
  return keypoints;
}

[[gnu::noinline]] std::size_t measured_describe(Describer& describer, const ScanLog& log,
                                                std::span<const ScanFeatures> features) {
  std::size_t descriptors = 0;
  for (std::size_t i = 0; i < features.size(); ++i) {
    descriptors += describer.describe(log.scans[i], features[i].features.keypoints).size();
  }
  return descriptors;
}

/// All pairs, as against a map: few of them belong together.
[[gnu::noinline]] std::size_t measured_match(PairMatcher& matcher, std::span<const ScanFeatures> features) {
  std::size_t aligned = 0;
  for (const ScanFeatures& query : features) {
    matcher.set_query(query.columns());
    for (const ScanFeatures& reference : features) { aligned += matcher.align(reference.columns()) ? 1 : 0; }
  }
  return aligned;
}

[[gnu::noinline]] std::size_t measured_query(Localizer& localizer, const ScanLog& log) {
  constexpr std::size_t every = 16;
  std::size_t unique = 0;
  for (std::size_t i = 0; i < log.scans.size(); i += every) {
    unique += localizer.localize(log.scans[i]).verdict == Verdict::unique ? 1 : 0;
  }
  return unique;
}

}  // extern "C"

namespace {

int run(std::string_view stage) {
  const ScanLog log = drive();
  std::size_t found = 0;
  if (stage == "detect") {
    Detector detector;
    found = measured_detect(detector, log);
  } else if (stage == "describe") {
    const std::vector<ScanFeatures> features = features_of(log);
    Describer describer;
    found = measured_describe(describer, log, features);
  } else if (stage == "match") {
    const std::vector<ScanFeatures> features = features_of(log);
    PairMatcher matcher;
    found = measured_match(matcher, features);
  } else if (stage == "query") {
    const auto map = build_place_map(log, {}, 1);
    if (!map) { return 3; }
    Localizer localizer(*map);
    static_cast<void>(localizer.localize(log.scans.front()));  // prepares what all queries share
    found = measured_query(localizer, log);
  } else {
    std::fputs("usage: flirt_probe detect|describe|match|query\n", stderr);
    return 1;
  }
  std::printf("%zu scans, %zu found\n", log.scans.size(), found);
  return found > 0 ? 0 : 3;
}

}  // namespace
}  // namespace flirt

int main(int argc, char** argv) {
  return flirt::run(argc == 2 ? argv[1] : "");
}
