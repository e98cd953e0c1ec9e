#include "apps/flirt/detect_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace flirt::app {
namespace {

// --- The scan, like P1 Fig. 4 ----------------------------------------------------------------------------------------

std::vector<Point2> end_points(const Scan& scan) {
  std::vector<Point2> points;
  for (const BeamPoint& hit : hit_points(scan)) { points.push_back(hit.point); }
  return points;
}

/// Around the sensor, the keypoints and the nearest 95 % of the end points: a few far points, or support regions across
/// gaps, would make the rest too small to see.
svg::Bounds bounds_of(std::vector<Point2> points, const std::vector<Keypoint>& keypoints) {
  std::sort(points.begin(), points.end(), [](Point2 a, Point2 b) { return squared_norm(a) < squared_norm(b); });
  points.resize(points.size() * 95 / 100);
  svg::Bounds bounds;
  const auto include = [&bounds](Point2 centre, double radius) {
    bounds.low = {std::min(bounds.low.x, centre.x - radius), std::min(bounds.low.y, centre.y - radius)};
    bounds.high = {std::max(bounds.high.x, centre.x + radius), std::max(bounds.high.y, centre.y + radius)};
  };
  include({0, 0}, 1.0);
  for (const Point2& point : points) { include(point, 0.3); }
  for (const Keypoint& keypoint : keypoints) {
    include(keypoint.sensor_from_keypoint.translation(), std::min<double>(keypoint.support_radius, 1.0) + 0.2);
  }
  return bounds;
}

Point2 along(const Keypoint& keypoint, double distance) {
  return keypoint.sensor_from_keypoint * Point2{distance, 0.0};
}

svg::Plan scan_plan(const DetectFigureInput& input) {
  const std::vector<Keypoint>& keypoints = input.features.keypoints;
  svg::Plan plan{.title = fmt::format("{} keypoints, support regions and directions", keypoints.size()),
                 .bounds = bounds_of(end_points(input.scan), keypoints)};
  plan.layers.emplace_back(
      svg::Points{.at = end_points(input.scan), .colour = svg::blue, .radius = 1.3, .legend = "end points"});
  svg::Circles regions{.colour = svg::vermilion, .width = 1.0, .legend = "support regions"};
  svg::Points centres{.colour = svg::vermilion, .radius = 2.2, .legend = "keypoints"};
  svg::Arrows directions{.colour = svg::black, .width = 1.1, .legend = "directions"};
  for (const Keypoint& keypoint : keypoints) {
    const Point2 at = keypoint.sensor_from_keypoint.translation();
    regions.circles.push_back({at, keypoint.support_radius});
    centres.at.push_back(at);
    directions.arrows.push_back({at, along(keypoint, std::clamp<double>(keypoint.support_radius, 0.3, 1.0))});
  }
  plan.layers.emplace_back(regions);
  plan.layers.emplace_back(centres);
  plan.layers.emplace_back(directions);
  if (input.keypoint < keypoints.size()) {
    const Keypoint& chosen = keypoints[input.keypoint];
    const double radius =
        std::visit([&](const auto& params) { return outer_radius(params, chosen); }, input.params.descriptor);
    plan.layers.emplace_back(svg::Circles{.circles = {{chosen.sensor_from_keypoint.translation(), radius}},
                                          .colour = svg::green,
                                          .width = 2.0,
                                          .legend = fmt::format("descriptor of keypoint {}", input.keypoint)});
  }
  plan.layers.emplace_back(
      svg::Robots{.map_from_robot = {Pose2{}}, .colour = svg::black, .length = 0.4, .legend = "sensor"});
  return plan;
}

// --- The signal at each scale, like P2 Fig. 2 right ------------------------------------------------------------------

double largest_magnitude(const DetectorTrace& trace) {
  double largest = 0;
  for (const ScaleTrace& scale : trace.scales) {
    for (const double response : scale.response) { largest = std::max(largest, std::abs(response)); }
  }
  return largest;
}

/// All but vermilion, which marks the keypoints.
constexpr std::array level_colours{svg::blue, svg::sky_blue, svg::green, svg::purple, svg::grey};

/// Lines one above the other: the response of level k, over the largest of all, runs from k upwards.
svg::Chart response_chart(const DetectFigureInput& input) {
  const DetectorTrace& trace = input.trace.detector;
  const double largest = largest_magnitude(trace);
  const double factor = largest > 0 ? 0.9 / largest : 0.0;
  const bool is_curvature = std::holds_alternative<CurvatureParams>(input.params.detector);
  svg::Chart chart{
      .title = fmt::format("Response of the {} detector at each scale", detector_name(input.params.detector)),
      .x = {.label = "beam"},
      .y = {.label = fmt::format("level, plus response over its largest ({:.3g})", largest)}};
  constexpr double gap = std::numeric_limits<double>::quiet_NaN();
  svg::Series found{.legend = "keypoints", .style = {svg::vermilion, svg::Dash::solid, svg::Marker::circle}};
  for (std::size_t level = 0; level < trace.scales.size(); ++level) {
    const ScaleTrace& scale = trace.scales[level];
    svg::Series line{.legend = fmt::format("t = {:.3g} {}", scale.t, is_curvature ? "m" : "beams²"),
                     .style = {level_colours[level % level_colours.size()], svg::Dash::solid, svg::Marker::none}};
    for (std::size_t i = 0; i < scale.response.size(); ++i) {
      line.x.push_back(trace.beams[i]);
      line.y.push_back(static_cast<double>(level) + factor * scale.response[i]);
    }
    chart.series.push_back(std::move(line));
  }
  for (const Keypoint& keypoint : input.features.keypoints) {
    found.x.insert(found.x.end(), {static_cast<double>(keypoint.beam), gap});
    found.y.insert(found.y.end(), {keypoint.level + factor * static_cast<double>(keypoint.response), gap});
  }
  chart.series.push_back(std::move(found));
  return chart;
}

// --- One descriptor, like P2 Fig. 3 ----------------------------------------------------------------------------------

/// Share 0 is white, 1 the darkest shade of `colour`.
svg::Colour shade(svg::Colour colour, double share) {
  const auto mix = [&](std::uint8_t channel) {
    return static_cast<std::uint8_t>(std::lround(255.0 + std::clamp(share, 0.0, 1.0) * (channel - 255.0)));
  };
  return {mix(colour.red), mix(colour.green), mix(colour.blue)};
}

struct Tessellation {
  std::uint32_t angular_bins{0};
  std::uint32_t radial_bins{0};
  double inner{0};  ///< m
  double outer{0};  ///< m
};

Tessellation tessellation_of(const DescriptorParams& params, const Keypoint& keypoint) {
  return std::visit(
      [&](const auto& p) {
        return Tessellation{p.angular_bins, p.radial_bins, p.inner_radius, outer_radius(p, keypoint)};
      },
      params);
}

/// Outline of a bin in the keypoint's frame.
std::vector<Point2> bin_outline(const Tessellation& tessellation, std::uint32_t a, std::uint32_t j) {
  const double width = (tessellation.outer - tessellation.inner) / tessellation.radial_bins;
  const double low = tessellation.inner + j * width;
  const double step = 2.0 * std::numbers::pi / tessellation.angular_bins;
  const double first = -std::numbers::pi + a * step;
  constexpr int corners = 12;
  std::vector<Point2> outline;
  for (int i = 0; i <= corners; ++i) {
    const double angle = first + step * i / corners;
    outline.push_back({low * std::cos(angle), low * std::sin(angle)});
  }
  for (int i = corners; i >= 0; --i) {
    const double angle = first + step * i / corners;
    outline.push_back({(low + width) * std::cos(angle), (low + width) * std::sin(angle)});
  }
  return outline;
}

/// Bins filled by `values` over `full`, with the scan around the keypoint, whose direction points to the right.
svg::Plan descriptor_plan(const DetectFigureInput& input, const std::string& title, const std::vector<double>& values,
                          double full, svg::Colour colour) {
  const Keypoint& keypoint = input.features.keypoints[input.keypoint];
  const Tessellation tessellation = tessellation_of(input.params.descriptor, keypoint);
  const double margin = 1.12 * tessellation.outer;
  svg::Plan plan{.title = title, .bounds = svg::Bounds{{-margin, -margin}, {margin, margin}}};
  for (std::uint32_t a = 0; a < tessellation.angular_bins; ++a) {
    for (std::uint32_t j = 0; j < tessellation.radial_bins; ++j) {
      const double value = values[a * tessellation.radial_bins + j];
      plan.layers.emplace_back(svg::Polylines{.lines = {bin_outline(tessellation, a, j)},
                                              .colour = shade(colour, full > 0 ? value / full : 0.0),
                                              .width = 0,
                                              .outline = svg::Outline::closed,
                                              .fill_opacity = 1});
    }
  }
  svg::Polylines outlines{.colour = svg::grey, .width = 0.6, .outline = svg::Outline::closed};
  for (std::uint32_t a = 0; a < tessellation.angular_bins; ++a) {
    for (std::uint32_t j = 0; j < tessellation.radial_bins; ++j) {
      outlines.lines.push_back(bin_outline(tessellation, a, j));
    }
  }
  plan.layers.emplace_back(outlines);
  svg::Points points{.colour = svg::vermilion, .radius = 2.5, .legend = "end points"};
  for (const Point2& point : end_points(input.scan)) {
    const Point2 in_keypoint = inverse(keypoint.sensor_from_keypoint) * point;
    if (norm(in_keypoint) < tessellation.outer) { points.at.push_back(in_keypoint); }
  }
  plan.layers.emplace_back(points);
  plan.layers.emplace_back(svg::Arrows{.arrows = {{{0, 0}, {0.4 * tessellation.outer, 0}}},
                                       .colour = svg::green,
                                       .width = 2,
                                       .legend = "direction of the keypoint"});
  const Point2 sensor = inverse(keypoint.sensor_from_keypoint) * Point2{0, 0};
  const double distance = norm(sensor);
  if (distance > margin) {
    plan.layers.emplace_back(svg::Arrows{
        .arrows = {{(1.1 * tessellation.outer / distance) * sensor, (0.85 * tessellation.outer / distance) * sensor}},
        .colour = svg::blue,
        .width = 2,
        .legend = "where the sensor looks from"});
  }
  return plan;
}

template <class T>
std::vector<double> row_of(const std::vector<T>& all, std::size_t row, std::size_t dimension) {
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(row * dimension);
  return {begin, begin + static_cast<std::ptrdiff_t>(dimension)};
}

void add_descriptor(svg::Figure& figure, const DetectFigureInput& input) {
  const DescriptorTrace& trace = input.trace.descriptor;
  const auto row = [&](const auto& all) { return row_of(all, input.keypoint, trace.dimension); };
  if (trace.mean.empty()) {
    const std::vector<double> points = row(trace.hits);
    const double most = *std::max_element(points.begin(), points.end());
    figure.panels.emplace_back(descriptor_plan(
        input, fmt::format("Shape context of keypoint {}: 0 (white) to {} points", input.keypoint, most), points, most,
        svg::black));
    return;
  }
  figure.panels.emplace_back(
      descriptor_plan(input, fmt::format("β-grid of keypoint {}: occupancy, 0 (white) to 1 (black)", input.keypoint),
                      row(trace.mean), 1.0, svg::black));
  figure.panels.emplace_back(
      descriptor_plan(input, fmt::format("β-grid of keypoint {}: variance, 0 (white) to 1/12 (purple)", input.keypoint),
                      row(trace.variance), 1.0 / 12.0, svg::purple));
}

}  // namespace

std::size_t busiest_keypoint(const DescriptorTrace& trace, std::size_t keypoints) {
  std::size_t busiest = 0;
  std::uint32_t most = 0;
  for (std::size_t i = 0; i < keypoints; ++i) {
    const auto begin = trace.hits.begin() + static_cast<std::ptrdiff_t>(i * trace.dimension);
    const std::uint32_t returns = std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(trace.dimension), 0U);
    if (returns > most) {
      busiest = i;
      most = returns;
    }
  }
  return busiest;
}

svg::Figure detect_figure(const DetectFigureInput& input) {
  svg::Figure figure{.title = input.title, .columns = 2, .panel_width = 560};
  figure.panels.emplace_back(scan_plan(input));
  figure.panels.emplace_back(response_chart(input));
  if (input.keypoint < input.features.keypoints.size()) { add_descriptor(figure, input); }
  return figure;
}

}  // namespace flirt::app
