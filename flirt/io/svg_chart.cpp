// Charts: lines over two axes.
#include "flirt/io/svg_parts.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

namespace flirt::svg {

SeriesStyle series_style(std::size_t i) {
  constexpr std::array<Colour, 6> colours{blue, vermilion, green, black, purple, orange};
  constexpr std::array<Dash, 4> dashes{Dash::solid, Dash::dashed, Dash::dash_dot, Dash::dotted};
  constexpr std::array<Marker, 5> markers{Marker::circle, Marker::square, Marker::triangle, Marker::diamond,
                                          Marker::cross};
  return {colours[i % colours.size()], dashes[i % dashes.size()], markers[i % markers.size()]};
}

namespace parts {
namespace {

constexpr double left_margin = 52;    // px, for the labels of the y axis
constexpr double bottom_margin = 40;  // px, for those of the x axis
constexpr double aspect = 0.62;       // height of the plot by the width of the panel
constexpr double marker_radius = 3;   // px

// --- Axes ------------------------------------------------------------------------------------------------------------

/// An axis with its limits settled, on its scale: the value itself, or its decimal logarithm.
struct Range {
  double low{0};
  double high{1};
  AxisScale scale{AxisScale::linear};

  [[nodiscard]] double on_scale(double value) const {
    if (scale == AxisScale::linear) { return value; }
    return value > 0 ? std::log10(value) : std::numeric_limits<double>::quiet_NaN();
  }
  /// 0 at the low end, 1 at the high end; NaN for what has no place.
  [[nodiscard]] double share(double value) const { return (on_scale(value) - low) / (high - low); }
};

struct Tick {
  double value{0};
  std::string label{};  ///< SVG, escaped
};

/// Limits from data that lie at `values` on the scale; wide enough never to divide by zero.
Range range_of(const Axis& axis, const std::vector<double>& values) {
  Range range{0, 1, axis.scale};
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double value : values) {
    const double place = range.on_scale(value);
    if (!std::isfinite(place)) { continue; }
    low = std::min(low, place);
    high = std::max(high, place);
  }
  if (axis.low && std::isfinite(range.on_scale(*axis.low))) { low = range.on_scale(*axis.low); }
  if (axis.high && std::isfinite(range.on_scale(*axis.high))) { high = range.on_scale(*axis.high); }
  if (!std::isfinite(low) || !std::isfinite(high)) { return range; }
  if (!(high > low)) {
    const double half = low == 0 ? 1.0 : 0.5 * std::abs(low);
    return {low - half, low + half, axis.scale};
  }
  return {low, high, axis.scale};
}

double tick_step(const Range& range, double most) {
  const double step = round_down((range.high - range.low) / most);
  return step * most < range.high - range.low ? round_down(step * 2.5) : step;
}

/// Moves the ends that the caller left open out to the next ticks.
Range widened(const Range& range, const Axis& axis) {
  const double step = range.scale == AxisScale::linear ? tick_step(range, 6) : 1.0;
  Range wide = range;
  if (!axis.low) { wide.low = std::floor(range.low / step + 1e-9) * step; }
  if (!axis.high) { wide.high = std::ceil(range.high / step - 1e-9) * step; }
  return wide;
}

std::string general(double value, int digits) {
  std::array<char, 40> buffer{};
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, digits);
  return {buffer.data(), error == std::errc{} ? end : buffer.data()};
}

std::vector<Tick> linear_ticks(const Range& range) {
  std::vector<Tick> ticks;
  const double step = tick_step(range, 6);
  const double largest = std::max(std::abs(range.low), std::abs(range.high));
  const int digits = std::clamp(static_cast<int>(std::ceil(std::log10(largest / step))) + 1, 6, 15);
  const double first = std::ceil(range.low / step - 1e-9);
  for (int i = 0; i <= 12 && (first + i) * step <= range.high + 1e-9 * step; ++i) {
    const double value = (first + i) * step;
    ticks.push_back({value, general(std::abs(value) < 1e-9 * step ? 0.0 : value, digits)});
  }
  return ticks;
}

std::string power_of_ten(int exponent) {
  return "10<tspan dy=\"-4\" font-size=\"8\">" + std::to_string(exponent) + "</tspan>";
}

std::vector<Tick> logarithmic_ticks(const Range& range) {
  std::vector<Tick> ticks;
  const int first = static_cast<int>(std::floor(range.low + 1e-9));
  const int last = static_cast<int>(std::ceil(range.high - 1e-9));
  const int every = std::max(1, (last - first) / 8);
  const bool finer = range.high - range.low <= 2.0;
  const bool plain = first >= -3 && last <= 4;
  for (int exponent = first; exponent <= last; exponent += every) {
    const double decade = std::pow(10.0, exponent);
    ticks.push_back({decade, plain ? general(decade, 6) : power_of_ten(exponent)});
    if (!finer) { continue; }
    for (const double factor : {2.0, 5.0}) { ticks.push_back({factor * decade, general(factor * decade, 6)}); }
  }
  std::erase_if(ticks, [&](const Tick& tick) {
    const double share = range.share(tick.value);
    return share < -1e-9 || share > 1 + 1e-9;
  });
  return ticks;
}

std::vector<Tick> ticks_of(const Range& range) {
  return range.scale == AxisScale::linear ? linear_ticks(range) : logarithmic_ticks(range);
}

// --- Series ----------------------------------------------------------------------------------------------------------

struct Axes {
  Range x{};
  Range y{};
  Box plot{};

  /// Within the plot; not finite when the point has no place on the axes.
  [[nodiscard]] Point2 pixel(double at_x, double at_y) const {
    return {x.share(at_x) * plot.width, (1 - y.share(at_y)) * plot.height};
  }
};

Axes axes_of(const Chart& chart, const Box& plot) {
  std::vector<double> x;
  std::vector<double> y;
  for (const Series& series : chart.series) {
    x.insert(x.end(), series.x.begin(), series.x.end());
    for (const auto* values : {&series.y, &series.low, &series.high}) {
      y.insert(y.end(), values->begin(), values->end());
    }
  }
  return {range_of(chart.x, x), widened(range_of(chart.y, y), chart.y), plot};
}

std::string marker_path(Marker marker, Point2 at) {
  constexpr double r = marker_radius;
  const auto shape = [&](std::initializer_list<Point2> corners) {
    std::vector<Point2> pixels;
    for (const Point2 corner : corners) { pixels.push_back(at + corner); }
    return path_through(pixels, Outline::closed);
  };
  switch (marker) {
    case Marker::none:
      return {};
    case Marker::circle:
      return "M" + number(at.x - r) + ' ' + number(at.y) + "a3 3 0 1 0 6 0a3 3 0 1 0-6 0Z";
    case Marker::square:
      return shape({{-r, -r}, {r, -r}, {r, r}, {-r, r}});
    case Marker::triangle:
      return shape({{0, -1.2 * r}, {1.2 * r, r}, {-1.2 * r, r}});
    case Marker::diamond:
      return shape({{0, -1.4 * r}, {1.4 * r, 0}, {0, 1.4 * r}, {-1.4 * r, 0}});
    case Marker::cross:
      return path_through({at + Point2{-r, -r}, at + Point2{r, r}}) +
             path_through({at + Point2{-r, r}, at + Point2{r, -r}});
  }
  return {};
}

std::string draw_markers(const std::vector<Point2>& pixels, const SeriesStyle& style) {
  std::string data;
  for (const Point2 pixel : pixels) {
    if (std::isfinite(pixel.x) && std::isfinite(pixel.y)) { data += marker_path(style.marker, pixel); }
  }
  if (data.empty()) { return {}; }
  const std::string fill = style.marker == Marker::cross ? std::string("none") : hex(style.colour);
  return "<path" + attribute("fill", fill) + attribute("stroke", hex(style.colour)) + attribute("d", data) + "/>\n";
}

/// The shaded interval around a series.
std::string draw_interval(const Series& series, const Axes& axes) {
  std::vector<Point2> outline;
  const std::size_t n = std::min({series.x.size(), series.low.size(), series.high.size()});
  const auto add = [&](Point2 pixel) {
    if (std::isfinite(pixel.x) && std::isfinite(pixel.y)) { outline.push_back(pixel); }
  };
  for (std::size_t i = 0; i < n; ++i) { add(axes.pixel(series.x[i], series.high[i])); }
  for (std::size_t i = n; i-- > 0;) { add(axes.pixel(series.x[i], series.low[i])); }
  if (outline.size() < 3) { return {}; }
  return "<path" + attribute("fill", hex(series.style.colour)) + attribute("fill-opacity", 0.15) +
         attribute("d", path_through(outline, Outline::closed)) + "/>\n";
}

std::string draw_series(const Series& series, const Axes& axes) {
  std::vector<Point2> pixels;
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    pixels.push_back(axes.pixel(series.x[i], series.y[i]));
  }
  const std::string data = path_through(pixels);
  if (data.empty()) { return {}; }
  return "<path" + stroke(series.style.colour, 1.6, series.style.dash) + attribute("stroke-linejoin", "round") +
         attribute("d", data) + "/>\n" + draw_markers(pixels, series.style);
}

// --- The frame -------------------------------------------------------------------------------------------------------

std::string grid_line(Point2 from, Point2 to) {
  return "<path" + stroke(Colour{228, 228, 228}, 1) + attribute("d", path_through({from, to})) + "/>\n";
}

/// A tick's label; the label is SVG already.
std::string tick_text(double x, double y, const std::string& label, std::string_view anchor) {
  return "<text" + attribute("x", x) + attribute("y", y) + attribute("text-anchor", anchor) + ">" + label + "</text>\n";
}

std::string draw_axes(const Chart& chart, const Axes& axes) {
  const Box& plot = axes.plot;
  const double bottom = plot.top + plot.height;
  std::string text;
  for (const Tick& tick : ticks_of(axes.x)) {
    const double x = plot.left + axes.x.share(tick.value) * plot.width;
    text += grid_line({x, plot.top}, {x, bottom}) + tick_text(x, bottom + 15, tick.label, "middle");
  }
  for (const Tick& tick : ticks_of(axes.y)) {
    const double y = bottom - axes.y.share(tick.value) * plot.height;
    text += grid_line({plot.left, y}, {plot.left + plot.width, y}) + tick_text(plot.left - 6, y + 4, tick.label, "end");
  }
  text += "<path" + stroke(black, 1) +
          attribute("d", path_through({{plot.left, plot.top}, {plot.left, bottom}, {plot.left + plot.width, bottom}})) +
          "/>\n";
  text += text_at(plot.left + plot.width / 2, bottom + 32, chart.x.label, Anchor::middle);
  const double middle = plot.top + plot.height / 2;
  const double label_x = plot.left - left_margin + 11;
  return text + text_at(label_x, middle, chart.y.label, Anchor::middle,
                        attribute("transform", "rotate(-90 " + number(label_x) + ' ' + number(middle) + ')'));
}

/// The start of an inner svg in the plot's own coordinates that cuts off what lies outside, but for half a marker.
std::string clipped_to(const Box& plot) {
  constexpr double spill = marker_radius + 2;
  const double width = plot.width + 2 * spill;
  const double height = plot.height + 2 * spill;
  const std::string view = number(-spill) + ' ' + number(-spill) + ' ' + number(width) + ' ' + number(height);
  return "<svg" + attribute("x", plot.left - spill) + attribute("y", plot.top - spill) + attribute("width", width) +
         attribute("height", height) + attribute("viewBox", view) + attribute("overflow", "hidden") + ">\n";
}

std::vector<LegendEntry> legend_of(const Chart& chart) {
  std::vector<LegendEntry> entries;
  for (const Series& series : chart.series) {
    if (series.legend.empty()) { continue; }
    std::string picture = "<path" + stroke(series.style.colour, 1.6, series.style.dash) + " d=\"M-11 0L11 0\"/>";
    entries.push_back({picture + draw_markers({{0, 0}}, series.style), series.legend});
  }
  return entries;
}

}  // namespace

double height(const Chart& chart, double width) {
  const auto rows = static_cast<double>(legend_rows(legend_of(chart), width - left_margin));
  return (chart.title.empty() ? 8 : title_height) + aspect * width + bottom_margin + rows * legend_row;
}

std::string draw(const Chart& chart, double left, double top, double width) {
  const double above = chart.title.empty() ? 8 : title_height;
  const Box plot{left + left_margin, top + above, width - left_margin - 8, aspect * width};
  const Axes axes = axes_of(chart, plot);
  std::string text = chart.title.empty() ? std::string{} : title_above({left, plot.top, width, 0}, chart.title);
  text += draw_axes(chart, axes);
  text += clipped_to(plot);
  for (const Series& series : chart.series) { text += draw_interval(series, axes); }
  for (const Series& series : chart.series) { text += draw_series(series, axes); }
  text += "</svg>\n";
  return text + legend(legend_of(chart), plot.left, plot.top + plot.height + bottom_margin, plot.width);
}

}  // namespace parts
}  // namespace flirt::svg
