// bench/instructions/probe.cpp: one stage over made-up scans, for counting its instructions.
//
//   valgrind --tool=callgrind --toggle-collect=flirt_measured instructions_probe detect
//
// Everything but the body of `flirt_measured` is preparation and not counted: inputs, and one run before, so that
// memory is allocated and the SIMD kernels are chosen. scripts/compare_instructions runs it, also built against other
// commits: so it uses as little of the library as it can. Prints the SIMD target and what the stage found.
#include "flirt/features/extract.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/map/solution_set.hpp"
#include "flirt/match/columns.hpp"
#include "flirt/match/pair_matcher.hpp"

#include "rooms.hpp"

#include <hwy/targets.h>

#include <cstddef>
#include <cstdio>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

/// The name that callgrind looks for.
extern "C" [[gnu::noinline]] std::size_t flirt_measured(const std::function<std::size_t()>& stage) {
  return stage();
}

namespace flirt::bench {
namespace {

struct Described {
  Features features;
  KeypointTable table;

  [[nodiscard]] FeatureColumns columns() const { return {table.columns(), rows_of(features.descriptors)}; }
};

std::vector<Described> described(const std::vector<PlacedScan>& scans) {
  FeatureExtractor extractor;
  std::vector<Described> all;
  for (const PlacedScan& placed : scans) {
    Features features = extractor.extract(placed.scan);
    KeypointTable table = table_of(features.keypoints);
    all.push_back({std::move(features), std::move(table)});
  }
  return all;
}

PlaceMap map_of(const std::vector<PlacedScan>& scans, const std::vector<Described>& all) {
  PlaceMapBuilder builder;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    builder.add(scans[i].scan, scans[i].map_from_sensor, all[i].features);
  }
  return std::move(builder).build();
}

/// Runs it twice, the second time counted. Returns what the stage found.
std::size_t measured(const std::function<std::size_t()>& stage) {
  (void)stage();
  return flirt_measured(stage);
}

#ifdef __OPTIMIZE__
constexpr const char* compiler = __VERSION__ ", optimised";
#else
constexpr const char* compiler = __VERSION__;
#endif

std::size_t detect_stage(const std::vector<PlacedScan>& scans) {
  Detector detector{DetectorParams{}};
  return measured([&] {
    std::size_t keypoints = 0;
    for (const PlacedScan& placed : scans) { keypoints += detector.detect(placed.scan).size(); }
    return keypoints;
  });
}

std::size_t describe_stage(const std::vector<PlacedScan>& scans) {
  const std::vector<Described> all = described(scans);
  Describer describer{DescriptorParams{}};
  return measured([&] {
    std::size_t rows = 0;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      rows += describer.describe(scans[i].scan, all[i].features.keypoints).size();
    }
    return rows;
  });
}

/// All ordered pairs.
std::size_t match_stage(const std::vector<PlacedScan>& scans) {
  const std::vector<Described> all = described(scans);
  PairMatcher matcher;
  return measured([&] {
    std::size_t aligned = 0;
    for (const Described& query : all) {
      matcher.set_query(query.columns());
      for (const Described& reference : all) { aligned += matcher.align(reference.columns()) ? 1U : 0U; }
    }
    return aligned;
  });
}

/// Every eighth scan against the map of all, by the papers' method.
std::size_t query_papers_stage(const std::vector<PlacedScan>& scans) {
  const std::vector<Described> all = described(scans);
  SolutionSetFinder finder(map_of(scans, all));
  return measured([&] {
    std::size_t hypotheses = 0;
    for (std::size_t i = 0; i < all.size(); i += 8) { hypotheses += finder.find(all[i].features).hypotheses.size(); }
    return hypotheses;
  });
}

/// Two scans against the map of all, by the evidence.
std::size_t query_stage(const std::vector<PlacedScan>& scans) {
  const PlaceMap map = map_of(scans, described(scans));
  Localizer localizer(map);
  return measured([&] {
    std::size_t hypotheses = 0;
    for (std::size_t i = 5; i < scans.size(); i += scans.size() / 2) {
      hypotheses += localizer.localize(scans[i].scan).hypotheses.size();
    }
    return hypotheses;
  });
}

int run(std::string_view stage) {
  const std::vector<PlacedScan> scans = scans_in_rooms(32);
  std::size_t found = 0;
  if (stage == "detect") {
    found = detect_stage(scans);
  } else if (stage == "describe") {
    found = describe_stage(scans);
  } else if (stage == "match") {
    found = match_stage(scans);
  } else if (stage == "query_papers") {
    found = query_papers_stage(scans);
  } else if (stage == "query") {
    found = query_stage(scans);
  } else {
    std::fputs("instructions_probe: expected detect, describe, match, query_papers or query\n", stderr);
    return 1;
  }
  const auto best = hwy::SupportedTargets() & -hwy::SupportedTargets();  // the lowest bit is the best target
  std::printf("target %s\ncompiler %s\nfound %zu\n", hwy::TargetName(best), compiler, found);
  return 0;
}

}  // namespace
}  // namespace flirt::bench

int main(int argc, char** argv) {
  return flirt::bench::run(argc == 2 ? argv[1] : "");
}
