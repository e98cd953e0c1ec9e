#include "apps/flirt/localize_report.hpp"

#include "flirt/io/svg.hpp"
#include "flirt/report/html.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <utility>

namespace flirt::app {
namespace {

constexpr double least_shown_weight = 0.01;
constexpr std::size_t most_shown = 12;                      // hypotheses in a picture
constexpr double right_distance = 0.5;                      // m
constexpr double right_heading = radians_from_degrees(10);  // rad

std::string with_interval(const Rate& rate) {
  const Interval interval = rate.wilson();
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", rate.value(), interval.low, interval.high);
}

std::vector<std::vector<std::string>> summary_rows(const LocalizeSummary& summary) {
  std::vector<std::vector<std::string>> rows;
  if (summary.agree.total > 0) {
    rows.push_back({"right: within 0.5 m and 10° of the log's pose", with_interval(summary.agree),
                    fmt::format("{} of {}", summary.agree.hits, summary.agree.total)});
    rows.push_back({"right when the verdict is unique", with_interval(summary.agree_if_unique),
                    fmt::format("{} of {}", summary.agree_if_unique.hits, summary.agree_if_unique.total)});
  }
  rows.push_back(
      {"verdicts", fmt::format("{} unique, {} ambiguous, {} lost", summary.unique, summary.ambiguous, summary.lost)});
  rows.push_back({"time for a scan, one thread, median", fmt::format("{:.2f} ms", summary.time_median_us / 1000)});
  rows.push_back({"95th percentile", fmt::format("{:.2f} ms", summary.time_p95_us / 1000)});
  return rows;
}

/// Where the scans were taken: right and wrong answers; without poses in the log, the answers themselves.
std::string answers_figure(std::span<const LocalizedScan> scans, std::vector<Point2> points) {
  svg::Points right{.colour = svg::blue, .radius = 2, .legend = "right"};
  svg::Points wrong{.colour = svg::vermilion, .radius = 3.5, .legend = "wrong"};
  svg::Points none{.colour = svg::black, .radius = 3, .legend = "lost"};
  svg::Points answers{.colour = svg::green, .radius = 2, .legend = "answer"};
  for (const LocalizedScan& scan : scans) {
    if (!scan.pose_in_log) {
      if (scan.map_from_sensor) { answers.at.push_back(scan.map_from_sensor->translation()); }
      continue;
    }
    auto& group = !scan.map_from_sensor ? none : (scan.agrees() ? right : wrong);
    group.at.push_back(scan.pose_in_log->translation());
  }
  svg::Plan plan;
  plan.layers.emplace_back(svg::Points{.at = std::move(points), .colour = svg::grey, .radius = 0.8, .legend = "map"});
  for (svg::Points* group : {&right, &none, &wrong, &answers}) {
    if (!group->at.empty()) { plan.layers.emplace_back(std::move(*group)); }
  }
  return svg::to_svg({.panels = {plan}, .panel_width = 1000});
}

}  // namespace

bool LocalizedScan::agrees() const {
  return map_from_sensor && pose_in_log && distance(*map_from_sensor, *pose_in_log) <= right_distance &&
         heading_difference(*map_from_sensor, *pose_in_log) <= right_heading;
}

LocalizeSummary summarise(std::span<const LocalizedScan> scans) {
  LocalizeSummary summary;
  std::vector<double> times;
  for (const LocalizedScan& scan : scans) {
    times.push_back(scan.time_us);
    summary.unique += scan.verdict == Verdict::unique ? 1 : 0;
    summary.ambiguous += scan.verdict == Verdict::ambiguous ? 1 : 0;
    summary.lost += scan.verdict == Verdict::lost ? 1 : 0;
    if (!scan.pose_in_log) { continue; }
    ++summary.agree.total;
    summary.agree.hits += scan.agrees() ? 1 : 0;
    if (scan.verdict != Verdict::unique) { continue; }
    ++summary.agree_if_unique.total;
    summary.agree_if_unique.hits += scan.agrees() ? 1 : 0;
  }
  summary.time_median_us = quantile(times, 0.5);
  summary.time_p95_us = quantile(times, 0.95);
  return summary;
}

std::string summary_text(const LocalizeSummary& summary) {
  std::string text;
  for (const auto& row : summary_rows(summary)) {
    text += fmt::format("{:<46} {}{}\n", row[0], row[1], row.size() > 2 ? "  (" + row[2] + ")" : "");
  }
  return text;
}

std::vector<Point2> map_points(const PlaceMap& map) {
  const double cell = map.evidence().params().cell_size;
  std::vector<Point2> points;
  map.evidence().for_each_row([&](CellIndex first, std::span<const EvidenceCell> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (!row[i].occupied()) { continue; }
      points.push_back({(first.x + static_cast<double>(i) + 0.5) * cell, (first.y + 0.5) * cell});
    }
  });
  return points;
}

std::string localization_picture(std::vector<Point2> points, const Scan& scan, const LocalizationResult& result,
                                 const std::optional<Pose2>& pose_in_log, const std::string& title) {
  svg::Plan plan{.title = title};
  plan.layers.emplace_back(svg::Points{.at = std::move(points), .colour = svg::grey, .radius = 0.8, .legend = "map"});
  if (const PoseHypothesis* best = result.best(); best != nullptr) {
    svg::Points ends{.colour = svg::blue, .radius = 1.0, .legend = "scan at the best pose"};
    for (const BeamPoint& end : hit_points(scan)) { ends.at.push_back(best->map_from_sensor * end.point); }
    plan.layers.emplace_back(std::move(ends));
  }
  if (pose_in_log) {
    plan.layers.emplace_back(svg::Robots{
        .map_from_robot = {*pose_in_log}, .colour = svg::black, .length = 1.4, .legend = "pose in the log"});
  }
  svg::Robots poses{.colour = svg::vermilion, .length = 0.6, .legend = "hypotheses"};
  for (const PoseHypothesis& hypothesis : result.hypotheses) {
    const bool shown = hypothesis.weight >= least_shown_weight && poses.map_from_robot.size() < most_shown;
    if (shown) { poses.map_from_robot.push_back(hypothesis.map_from_sensor); }
  }
  plan.layers.emplace_back(std::move(poses));
  return svg::to_svg({.panels = {plan}, .panel_width = 1000});
}

std::string localize_report(const std::string& title, std::span<const LocalizedScan> scans, std::vector<Point2> points,
                            std::span<const CaptionedFigure> examples) {
  HtmlReport page(title);
  page.paragraph("Each scan was localized on its own: no first guess, no odometry, no memory of the scan before.");
  page.table({"", "value [Wilson 95 %]", ""}, summary_rows(summarise(scans)));
  page.figure(answers_figure(scans, std::move(points)), "Where the scans were taken, and what became of each.");
  for (const CaptionedFigure& example : examples) { page.figure(example.svg, example.caption); }
  return page.text();
}

}  // namespace flirt::app
