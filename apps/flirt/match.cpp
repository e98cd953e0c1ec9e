// apps/flirt/match.cpp: `flirt match`, the rigid motion between two scans from their keypoints, checked by all beams.
#include "flirt/match/match.hpp"

#include "flirt/io/feature_params_json.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/svg.hpp"
#include "flirt/match/ransac.hpp"
#include "flirt/match/verify.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/feature_flags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace flirt::app {
namespace {

struct MatchOptions {
  std::string log;
  std::string other;  ///< log of the reference; empty: the same
  std::size_t scan{0};
  std::size_t against{0};
  std::string svg;
  FeatureFlags features;
  MatchParams match;
  RansacParams ransac;
  VerifyParams verify;
  ParamFlags params;
};

/// One of the two scans.
struct Side {
  Scan scan;
  std::optional<Pose2> map_from_sensor;  ///< as the log states it
  Features features;
};

/// All that the command found out.
struct Outcome {
  Side query;
  Side reference;
  std::vector<Match> candidates;
  std::optional<Alignment> alignment;
  Verification verification;                  ///< of the alignment
  std::optional<Pose2> reference_from_query;  ///< by the poses in the log
};

Side side_of(const ScanLog& log, std::size_t scan, const std::string& flag, const FeatureParams& features) {
  if (scan >= log.scans.size()) {
    throw UsageError(
        fmt::format("{}: expected a scan of the log, 0 to {}, found {}", flag, log.scans.size() - 1, scan));
  }
  Side side{log.scans[scan], {}, extract(log.scans[scan], features)};
  if (!log.map_from_robot.empty()) { side.map_from_sensor = log.map_from_sensor(scan); }
  return side;
}

ScanLog read_scans(const std::string& path, const Session& session) {
  ScanLog log = value_or_quit(read_log(path, {}, progress_bar(session, "reading"))).log;
  if (log.scans.empty()) { throw BadInput(path + ": expected scans, found none"); }
  return log;
}

Outcome find_alignment(const MatchOptions& options, const Session& session) {
  const ScanLog log = read_scans(options.log, session);
  const FeatureParams features = options.features.features();
  Outcome outcome;
  outcome.query = side_of(log, options.scan, "--scan", features);
  if (options.other.empty()) {
    outcome.reference = side_of(log, options.against, "--against", features);
    if (outcome.query.map_from_sensor) {
      outcome.reference_from_query = inverse(*outcome.reference.map_from_sensor) * *outcome.query.map_from_sensor;
    }
  } else {
    outcome.reference = side_of(read_scans(options.other, session), options.against, "--against", features);
  }
  outcome.candidates = match(outcome.query.features, outcome.reference.features, options.match);
  outcome.alignment = align(outcome.query.features, outcome.reference.features, outcome.candidates, options.ransac);
  if (outcome.alignment) {
    outcome.verification =
        verify(outcome.query.scan, outcome.reference.scan, outcome.alignment->reference_from_query, options.verify);
  }
  return outcome;
}

nlohmann::ordered_json matches_json(const std::vector<Match>& matches) {
  auto json = nlohmann::ordered_json::array();
  for (const Match& match : matches) {
    json.push_back({{"query", match.query}, {"reference", match.reference}, {"distance", match.distance}});
  }
  return json;
}

nlohmann::ordered_json alignment_json(const Alignment& alignment) {
  const Pose2& pose = alignment.reference_from_query;
  auto covariance = nlohmann::ordered_json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) { covariance.push_back(alignment.covariance(row, column)); }
  }
  return {{"x", pose.x},
          {"y", pose.y},
          {"theta", pose.theta},
          {"covariance", covariance},
          {"residual", alignment.residual},
          {"inliers", matches_json(alignment.inliers)}};
}

nlohmann::ordered_json verification_json(const Verification& found) {
  return {{"query_points", found.query_points},
          {"near_points", found.near_points},
          {"free_points", found.free_points},
          {"line_points", found.line_points},
          {"near_share", found.near_share},
          {"free_share", found.free_share},
          {"median_line_residual", found.median_line_residual},
          {"mean_line_residual", found.mean_line_residual}};
}

nlohmann::ordered_json outcome_json(const MatchOptions& options, const Outcome& outcome) {
  nlohmann::ordered_json json{{"log", options.log},
                              {"scan", options.scan},
                              {"other", options.other.empty() ? options.log : options.other},
                              {"against", options.against},
                              {"query_keypoints", outcome.query.features.keypoints.size()},
                              {"reference_keypoints", outcome.reference.features.keypoints.size()},
                              {"candidates", matches_json(outcome.candidates)},
                              {"alignment", nullptr},
                              {"verification", nullptr},
                              {"displacement_in_log", nullptr}};
  if (outcome.alignment) {
    json["alignment"] = alignment_json(*outcome.alignment);
    json["verification"] = verification_json(outcome.verification);
  }
  if (outcome.reference_from_query) {
    const Pose2& pose = *outcome.reference_from_query;
    json["displacement_in_log"] = {{"x", pose.x}, {"y", pose.y}, {"theta", pose.theta}};
  }
  json["feature_params"] = json_from_feature_params(options.features.features());
  json["params"] = options.params.json();
  json.update(provenance());
  return json;
}

void print(const MatchOptions& options, const Outcome& outcome) {
  fmt::print("scan {} ({} keypoints) against {} ({} keypoints): {} candidates\n", options.scan,
             outcome.query.features.keypoints.size(), options.against, outcome.reference.features.keypoints.size(),
             outcome.candidates.size());
  if (!outcome.alignment) {
    fmt::print("no alignment: fewer than {} keypoints agree on one rigid motion\n", options.ransac.min_inliers);
    return;
  }
  const Alignment& found = *outcome.alignment;
  const Pose2& pose = found.reference_from_query;
  const auto deviation = [&](int i) { return std::sqrt(found.covariance(i, i)); };
  fmt::print("displacement      {:.3f} ± {:.3f} m, {:.3f} ± {:.3f} m, {:.2f} ± {:.2f}°\n", pose.x, deviation(0), pose.y,
             deviation(1), degrees_from_radians(pose.theta), degrees_from_radians(deviation(2)));
  fmt::print("inliers           {} keypoints, residual {:.4f} m²\n", found.inliers.size(), found.residual);
  const Verification& check = outcome.verification;
  fmt::print("whole scans       {:.1f} % of {} points agree, {:.1f} % lie in space seen free\n",
             100.0 * check.near_share, check.query_points, 100.0 * check.free_share);
  fmt::print("point to line     median {:.3f} m, mean {:.3f} m over {} points\n", check.median_line_residual,
             check.mean_line_residual, check.line_points);
  if (outcome.reference_from_query) {
    fmt::print("from log's poses  {:.3f} m, {:.2f}° away\n", distance(pose, *outcome.reference_from_query),
               degrees_from_radians(heading_difference(pose, *outcome.reference_from_query)));
  }
}

std::vector<Point2> moved_points(const Scan& scan, const Pose2& plan_from_sensor) {
  std::vector<Point2> points;
  for (const BeamPoint& end : hit_points(scan)) { points.push_back(plan_from_sensor * end.point); }
  return points;
}

std::vector<Point2> moved_keypoints(const Features& features, const Pose2& plan_from_sensor) {
  std::vector<Point2> points;
  points.reserve(features.keypoints.size());
  for (const Keypoint& keypoint : features.keypoints) {
    points.push_back(plan_from_sensor * keypoint.sensor_from_keypoint.translation());
  }
  return points;
}

struct Box {
  Point2 low{};
  Point2 high{};

  [[nodiscard]] double width() const { return high.x - low.x; }
  [[nodiscard]] double height() const { return high.y - low.y; }
  [[nodiscard]] double larger_side() const { return std::max(width(), height()); }
};

/// Around the points; a point at the origin for none.
Box box_of(const std::vector<Point2>& points) {
  if (points.empty()) { return {}; }
  Box box{points.front(), points.front()};
  for (const Point2 point : points) {
    box.low = {std::min(box.low.x, point.x), std::min(box.low.y, point.y)};
    box.high = {std::max(box.high.x, point.x), std::max(box.high.y, point.y)};
  }
  return box;
}

/// Scan, keypoints (circles of `radius` metres) and sensor of one side.
void draw_side(svg::Plan& plan, const Side& side, const Pose2& plan_from_sensor, double radius, svg::Colour colour,
               const std::string& name) {
  plan.layers.emplace_back(svg::Points{moved_points(side.scan, plan_from_sensor), colour, 1.0, 1.0, name});
  svg::Circles circles{.colour = colour, .width = 1.2};
  for (const Point2 at : moved_keypoints(side.features, plan_from_sensor)) { circles.circles.push_back({at, radius}); }
  plan.layers.emplace_back(std::move(circles));
  plan.layers.emplace_back(svg::Robots{.map_from_robot = {plan_from_sensor}, .colour = colour});
}

svg::Polylines lines_between(const std::vector<Match>& matches, const std::vector<Point2>& query,
                             const std::vector<Point2>& reference) {
  svg::Polylines lines;
  for (const Match& match : matches) { lines.lines.push_back({query[match.query], reference[match.reference]}); }
  return lines;
}

bool is_inlier(const Match& match, const Alignment& alignment) {
  return std::ranges::any_of(alignment.inliers, [&](const Match& inlier) {
    return inlier.query == match.query && inlier.reference == match.reference;
  });
}

/// P1 Fig. 1: the query, turned like the reference, beside it or, where that gives the larger picture, below it;
/// inliers as lines, the other candidates faint.
svg::Plan correspondences_plan(const Outcome& outcome) {
  const double turn = outcome.alignment ? outcome.alignment->reference_from_query.theta : 0.0;
  const Box reference_box = box_of(moved_points(outcome.reference.scan, {}));
  const Box query_box = box_of(moved_points(outcome.query.scan, {0.0, 0.0, turn}));
  const double gap = 0.05 * std::max(reference_box.larger_side(), query_box.larger_side());
  const bool below = reference_box.width() + query_box.width() > reference_box.height() + query_box.height();
  const Pose2 plan_from_query = below ? Pose2{0.0, reference_box.low.y - query_box.high.y - gap, turn}
                                      : Pose2{reference_box.high.x - query_box.low.x + gap, 0.0, turn};
  const std::vector<Point2> from = moved_keypoints(outcome.query.features, plan_from_query);
  const std::vector<Point2> to = moved_keypoints(outcome.reference.features, {});

  std::vector<Match> others = outcome.candidates;
  if (outcome.alignment) {
    std::erase_if(others, [&](const Match& match) { return is_inlier(match, *outcome.alignment); });
  }
  const std::size_t inliers = outcome.alignment ? outcome.alignment->inliers.size() : 0;
  svg::Plan plan{.title = fmt::format("{} candidates, {} inliers", outcome.candidates.size(), inliers)};
  svg::Polylines faint = lines_between(others, from, to);
  faint.colour = svg::grey;
  faint.width = 0.8;
  faint.opacity = 0.35;
  faint.legend = others.empty() ? "" : "other candidates";
  plan.layers.emplace_back(std::move(faint));
  if (outcome.alignment) {
    svg::Polylines lines = lines_between(outcome.alignment->inliers, from, to);
    lines.colour = svg::green;
    lines.width = 1.2;
    lines.legend = "inliers";
    plan.layers.emplace_back(std::move(lines));
  }
  const double radius = 0.2 * gap;
  draw_side(plan, outcome.reference, {}, radius, svg::blue, "reference");
  draw_side(plan, outcome.query, plan_from_query, radius, svg::vermilion, "query");
  return plan;
}

svg::Figure figure_of(const MatchOptions& options, const Outcome& outcome) {
  svg::Figure figure{.title = fmt::format("Scan {} matched with scan {}", options.scan, options.against),
                     .panels = {correspondences_plan(outcome)},
                     .panel_width = 640};
  if (outcome.alignment) {
    svg::Plan plan{.title = "The query in the frame of the reference"};
    const double radius = 0.01 * box_of(moved_points(outcome.reference.scan, {})).larger_side();
    draw_side(plan, outcome.reference, {}, radius, svg::blue, "reference");
    draw_side(plan, outcome.query, outcome.alignment->reference_from_query, radius, svg::vermilion, "query");
    figure.panels.emplace_back(std::move(plan));
  }
  return figure;
}

}  // namespace

void add_match(CLI::App& program, Session& session) {
  auto options = std::make_shared<MatchOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("LOG", options->log, "log file")->required();
    command.add_option("--scan", options->scan, "query: index of the scan in the log")->required();
    command.add_option("--against", options->against, "reference: index of the scan")->required();
    command.add_option("--other", options->other, "log of the reference (default: the same log)");
    command.add_option("--svg", options->svg, "figure of the two scans and their correspondences");
    options->features.add(command, options->params);
    options->params.add(command, "match", options->match);
    options->params.add(command, "ransac", options->ransac);
    options->params.add(command, "verify", options->verify);
  };
  CLI::App* command = add_command(program, session, "match", "The rigid motion between two scans.",
                                  "flirt match run.log.gz --scan 120 --against 700 --svg match.svg", add_options);
  session.on(command, [&session, options] {
    options->params.resolve(session, {"ransac"});
    const Outcome outcome = find_alignment(*options, session);
    if (session.talks()) { print(*options, outcome); }
    write_json(session, outcome_json(*options, outcome));
    if (!options->svg.empty()) {
      value_or_quit(write_file_atomically(options->svg, svg::to_svg(figure_of(*options, outcome))));
    }
    return exit_done;
  });
}

}  // namespace flirt::app
