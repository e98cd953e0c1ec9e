// apps/flirt/speed_map_size.cpp: one scan against maps of thousands of scans: a log's scans tiled to far places.
#include "flirt/core/rng.hpp"
#include "flirt/eval/cpu_time.hpp"
#include "flirt/eval/statistics.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/map/solution_set.hpp"
#include "flirt/map/word_index.hpp"

#include "apps/flirt/memory.hpp"
#include "apps/flirt/speed_log.hpp"
#include "apps/flirt/speed_section.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt::app {
namespace {

/// Even scans of a log make the map, over and over in tiles; odd ones ask.
struct Tiling {
  ScanLog log;
  double side{0};           ///< m, from tile to tile: no beam reaches another
  std::size_t per_tile{0};  ///< scans
  std::size_t tiles_a_row{0};

  [[nodiscard]] Pose2 map_from_sensor(std::size_t i) const {
    const std::size_t tile = i / per_tile;
    const std::size_t column = tile % tiles_a_row;
    const std::size_t row = tile / tiles_a_row;
    Pose2 pose = log.map_from_sensor(2 * (i % per_tile));
    pose.x += side * static_cast<double>(column);
    pose.y += side * static_cast<double>(row);
    return pose;
  }
};

double extent_of(const ScanLog& log) {
  const auto [x_low, x_high] = std::ranges::minmax(log.map_from_robot, {}, &Pose2::x);
  const auto [y_low, y_high] = std::ranges::minmax(log.map_from_robot, {}, &Pose2::y);
  return std::max(x_high.x - x_low.x, y_high.y - y_low.y);
}

Tiling tiling_of(ScanLog log, std::size_t size) {
  constexpr double between = 100.0;  // m, more than two beams reach indoors
  Tiling tiling{.log = std::move(log)};
  tiling.side = extent_of(tiling.log) + between;
  tiling.per_tile = (tiling.log.scans.size() + 1) / 2;
  const std::size_t tiles = (size + tiling.per_tile - 1) / tiling.per_tile;
  tiling.tiles_a_row = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(tiles))));
  return tiling;
}

/// A centimetre of noise on each hit of every tile but the first, so that no two map scans are equal.
Scan tile_scan(const Tiling& tiling, std::size_t i, std::uint64_t seed) {
  constexpr double half_width = 0.01;  // m
  Scan scan = tiling.log.scans[2 * (i % tiling.per_tile)];
  if (i < tiling.per_tile) { return scan; }
  Rng rng(seed, i);
  for (double& range : scan.ranges) {
    if (classify(range, scan.beams) != Reading::hit) { continue; }
    const double noisy = range + rng.uniform(-half_width, half_width);
    if (classify(noisy, scan.beams) == Reading::hit) { range = noisy; }
  }
  return scan;
}

struct BuiltMap {
  PlaceMap map;
  double features_s;
  double evidence_s;
};

BuiltMap map_of(const Tiling& tiling, std::size_t size, const Session& session) {
  const Progress progress = progress_bar(session, "map of " + std::to_string(size));
  FeatureExtractor extractor;
  PlaceMapBuilder builder;
  double features_us = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const Scan scan = tile_scan(tiling, i, session.seed);
    const double start = process_cpu_us();
    const Features features = extractor.extract(scan);
    builder.add(scan, tiling.map_from_sensor(i), features);
    features_us += process_cpu_us() - start;
    if (progress && i % 256 == 0) { progress(static_cast<double>(i) / static_cast<double>(size)); }
  }
  const double start = process_cpu_us();
  PlaceMap map = std::move(builder).build();
  const double evidence_s = (process_cpu_us() - start) * 1e-6;
  if (progress) { progress(1.0); }
  return {std::move(map), features_us * 1e-6, evidence_s};
}

struct SizeQuestion {
  Features features;
  Pose2 tile_from_sensor;
};

std::vector<SizeQuestion> questions_of(const Tiling& tiling, std::size_t count) {
  FeatureExtractor extractor;
  std::vector<SizeQuestion> questions;
  for (const std::size_t i : spread_evenly(tiling.log.scans.size() / 2, count)) {
    questions.push_back({extractor.extract(tiling.log.scans[2 * i + 1]), tiling.log.map_from_sensor(2 * i + 1)});
  }
  return questions;
}

using Answer = std::optional<Pose2>;

/// The same place in whichever tile.
bool is_same(const Answer& answer, const Pose2& truth, double side) {
  return answer &&
         std::hypot(std::remainder(answer->x - truth.x, side), std::remainder(answer->y - truth.y, side)) <= 0.5 &&
         heading_difference(*answer, truth) <= radians_from_degrees(10);
}

struct Answers {
  std::vector<Answer> poses;
  std::vector<double> times_ms;
};

template <class Find>
Answers ask(const std::vector<SizeQuestion>& questions, const Find& find) {
  Answers answers;
  for (const SizeQuestion& question : questions) {
    const double start = process_cpu_us();
    const SolutionSet found = find(question.features);
    answers.times_ms.push_back((process_cpu_us() - start) * 1e-3);
    const Hypothesis* const best = found.best();
    answers.poses.push_back(best == nullptr ? Answer() : Answer(best->map_from_sensor));
  }
  return answers;
}

/// `exact` for the recall: the share of its answers that `answers` has too.
void add_answers(nlohmann::ordered_json& row, const std::vector<SizeQuestion>& questions, const Answers& answers,
                 const Answers& exact, double side) {
  Rate right;
  Rate recall;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    right = {right.hits + (is_same(answers.poses[i], questions[i].tile_from_sensor, side) ? 1U : 0U), right.total + 1};
    if (!exact.poses[i]) { continue; }
    recall = {recall.hits + (is_same(answers.poses[i], *exact.poses[i], side) ? 1U : 0U), recall.total + 1};
  }
  row["query_ms_median"] = quantile(answers.times_ms, 0.5);
  row["query_ms_p95"] = quantile(answers.times_ms, 0.95);
  row["right"] = right.value();
  row["recall_of_exact"] = recall.value();
}

void add_size(const Tiling& tiling, std::size_t size, const SpeedOptions& options, const Session& session,
              nlohmann::ordered_json& rows) {
  const BuiltMap built = map_of(tiling, size, session);
  const std::vector<SizeQuestion> questions = questions_of(tiling, std::min<std::size_t>(options.queries, 50));
  SolutionSetFinder finder(built.map);
  nlohmann::ordered_json row{{"map_scans", size},
                             {"keypoints", built.map.feature_count()},
                             {"features_s", built.features_s},
                             {"evidence_s", built.evidence_s},
                             {"map_mb", static_cast<double>(built.map.bytes()) * 1e-6},
                             {"resident_mb", resident_mb()}};
  nlohmann::ordered_json words_row = row;
  const Answers exact = ask(questions, [&](const Features& features) { return finder.find(features); });
  row["method"] = "exact";
  row["index_s"] = 0.0;
  row["index_mb"] = 0.0;
  add_answers(row, questions, exact, exact, tiling.side);
  rows.push_back(std::move(row));

  const double start = process_cpu_us();
  const WordIndex index(built.map);
  words_row["method"] = "words";
  words_row["index_s"] = (process_cpu_us() - start) * 1e-6;
  words_row["index_mb"] = static_cast<double>(index.bytes()) * 1e-6;
  const Answers quick =
      ask(questions, [&](const Features& features) { return finder.find_among(features, index.most_alike(features)); });
  add_answers(words_row, questions, quick, exact, tiling.side);
  rows.push_back(std::move(words_row));
}

svg::Figure growth_with_scans(const nlohmann::ordered_json& rows) {
  constexpr std::array<std::string_view, 2> series_names{"exact", "words"};
  svg::Chart time{.title = "Time of a query",
                  .x = {.label = "map scans", .scale = svg::AxisScale::logarithmic},
                  .y = {.label = "median (ms)", .scale = svg::AxisScale::logarithmic}};
  svg::Chart right{.title = "Right answers",
                   .x = {.label = "map scans", .scale = svg::AxisScale::logarithmic},
                   .y = {.label = "share", .low = 0.0, .high = 1.0}};
  for (std::size_t i = 0; i < series_names.size(); ++i) {
    svg::Series times{.legend = std::string(series_names[i]), .style = svg::series_style(i)};
    svg::Series shares = times;
    for (const auto& row : rows) {
      if (row["method"] != times.legend) { continue; }
      times.x.push_back(row["map_scans"]);
      times.y.push_back(row["query_ms_median"]);
      shares.x.push_back(row["map_scans"]);
      shares.y.push_back(row["right"]);
    }
    time.series.push_back(times);
    right.series.push_back(shares);
  }
  return {.panels = {time, right}};
}

}  // namespace

SpeedSection speed_map_size(const SpeedOptions& options, const Session& session) {
  const SpeedLog source = options.log.empty() ? simulated_log(360, session) : given_log(options, session);
  SpeedSection section;
  for (const std::size_t size : options.sizes) {
    add_size(tiling_of(source.log, size), size, options, session, section.rows);
  }
  section.figure = growth_with_scans(section.rows);
  return section;
}

}  // namespace flirt::app
