// apps/flirt/speed_map_scans.cpp: localization in maps of 10³ to 10⁵ scans.
#include "flirt/eval/statistics.hpp"
#include "flirt/map/landmarks.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/place_map.hpp"

#include "apps/flirt/speed_section.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace flirt::app {
namespace {

constexpr std::array methods{LocalizeMethod::papers, LocalizeMethod::features, LocalizeMethod::automatic};

/// A log whose every second scan makes the map, at as many far places as it takes. The others are asked.
class Tiles {
 public:
  explicit Tiles(const ScanLog& log) : log_(log) {
    constexpr double apart = 30;  // m between one place and the next: farther than a scanner sees through a door
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (const Pose2& pose : log.map_from_robot) {
      lowest = std::min({lowest, pose.x, pose.y});
      highest = std::max({highest, pose.x, pose.y});
    }
    middle_ = {(lowest + highest) / 2, (lowest + highest) / 2};
    side_ = highest - lowest + apart;
  }

  [[nodiscard]] ScanLog map_log(std::size_t size) const {
    const std::size_t each = (log_.scans.size() + 1) / 2;
    const auto columns =
        static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(size) / static_cast<double>(each))));
    ScanLog tiled;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t scan = 2 * (i % each);
      const std::size_t tile = i / each;
      Pose2 pose = log_.map_from_robot[scan];
      pose.x += side_ * static_cast<double>(tile % columns);
      pose.y += side_ * static_cast<double>(tile / columns);
      tiled.scans.push_back(log_.scans[scan]);
      tiled.map_from_robot.push_back(pose);
    }
    return tiled;
  }

  /// Scans that lie between those of the map.
  [[nodiscard]] std::vector<std::size_t> questions(std::size_t count) const {
    const std::size_t between = log_.scans.size() / 2;
    std::vector<std::size_t> scans;
    for (std::size_t i = 0; i < std::min(count, between); ++i) {
      scans.push_back(2 * (i * between / std::min(count, between)) + 1);
    }
    return scans;
  }

  /// The pose in the log's own place, whatever place it was found at.
  [[nodiscard]] Pose2 folded(Pose2 pose) const {
    pose.x -= side_ * std::round((pose.x - middle_.x) / side_);
    pose.y -= side_ * std::round((pose.y - middle_.y) / side_);
    return pose;
  }

 private:
  const ScanLog& log_;
  Point2 middle_{};
  double side_{0};
};

bool same_place(const Pose2& a, const Pose2& b) {
  return distance(a, b) <= 0.5 && heading_difference(a, b) <= radians_from_degrees(10);
}

/// One method's answers to all questions: where it has the scan, in the log's own place, and how long that took.
struct Answers {
  std::vector<std::optional<Pose2>> map_from_sensor{};
  std::vector<double> times_ms{};
  double prepare_s{0};
};

Answers ask(const PlaceMap& map, const ScanLog& log, const Tiles& tiles, std::span<const std::size_t> questions,
            LocalizeMethod method) {
  Localizer localizer(map, {.method = method});
  Answers answers;
  answers.prepare_s = seconds_of([&] { static_cast<void>(localizer.localize(log.scans[questions.front()])); });
  for (const std::size_t scan : questions) {
    LocalizationResult result;
    answers.times_ms.push_back(1e3 * seconds_of([&] { result = localizer.localize(log.scans[scan]); }));
    const PoseHypothesis* const best = result.best();
    answers.map_from_sensor.push_back(best == nullptr ? std::optional<Pose2>{}
                                                      : std::optional(tiles.folded(best->map_from_sensor)));
  }
  return answers;
}

/// Questions whose answer is the place that `expected` says, of those where it says one.
template <class Expected>
double share_at(const Answers& answers, std::span<const std::size_t> questions, const Expected& expected) {
  Rate rate;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const std::optional<Pose2> place = expected(i);
    if (!place) { continue; }
    const auto& found = answers.map_from_sensor[i];
    ++rate.total;
    rate.hits += found && same_place(*found, *place) ? 1 : 0;
  }
  return rate.value();
}

svg::Figure figure_of(const nlohmann::ordered_json& rows) {
  svg::Chart time{.title = "Time of a query",
                  .x = {.label = "map scans", .scale = svg::AxisScale::logarithmic},
                  .y = {.label = "median (ms)", .scale = svg::AxisScale::logarithmic}};
  for (std::size_t i = 0; i < methods.size(); ++i) {
    svg::Series times{.legend = std::string(to_string(methods[i])), .style = svg::series_style(i)};
    for (const auto& row : rows) {
      if (row["method"] != times.legend) { continue; }
      times.x.push_back(row["map_scans"]);
      times.y.push_back(row["query_ms_median"]);
    }
    time.series.push_back(times);
  }
  return {.panels = {time}};
}

}  // namespace

SpeedSection speed_map_scans(const SpeedOptions& options, const Session& session) {
  const ScanLog log = speed_log(options, session);
  if (log.scans.size() < 2) { throw BadInput("expected a log of two scans or more"); }
  const Tiles tiles(log);
  const std::vector<std::size_t> questions = tiles.questions(options.queries);
  SpeedSection section;
  for (const std::size_t size : options.sizes) {
    const ScanLog map_log = tiles.map_log(size);
    std::optional<PlaceMap> map;
    const double build_s = seconds_of([&] { map = value_or_quit(build_place_map(map_log, {}, session.threads)); });
    Answers exact;
    for (const LocalizeMethod method : methods) {
      const Answers answers = ask(*map, log, tiles, questions, method);
      if (method == LocalizeMethod::papers) { exact = answers; }
      section.rows.push_back(
          {{"map_scans", size},
           {"keypoints", map->feature_count()},
           {"build_s", build_s},
           {"map_mb", static_cast<double>(map->bytes()) * 1e-6},
           {"method", to_string(method)},
           {"prepare_s", answers.prepare_s},
           {"query_ms_median", quantile(answers.times_ms, 0.5)},
           {"query_ms_p95", quantile(answers.times_ms, 0.95)},
           {"right", share_at(answers, questions,
                              [&](std::size_t i) { return std::optional(log.map_from_sensor(questions[i])); })},
           {"as_all_pairs", share_at(answers, questions, [&](std::size_t i) { return exact.map_from_sensor[i]; })}});
    }
  }
  section.figure = figure_of(section.rows);
  return section;
}

}  // namespace flirt::app
