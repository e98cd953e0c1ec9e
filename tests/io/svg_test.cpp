#include "flirt/io/svg.hpp"

#include "tests/support/numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace flirt::svg {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count_of(std::string_view part, std::string_view text) {
  std::size_t n = 0;
  for (std::size_t i = text.find(part); i != std::string_view::npos; i = text.find(part, i + 1)) { ++n; }
  return n;
}

/// Every element is closed, in order.
bool is_well_formed(std::string_view text) {
  std::vector<std::string> open;
  for (std::size_t begin = text.find('<'); begin != std::string_view::npos; begin = text.find('<', begin + 1)) {
    const std::size_t end = text.find('>', begin);
    if (end == std::string_view::npos) { return false; }
    const std::string_view tag = text.substr(begin + 1, end - begin - 1);
    if (tag.ends_with('/')) { continue; }
    const std::string name(tag.substr(0, tag.find_first_of(" \n")));
    if (!name.starts_with('/')) {
      open.push_back(name);
    } else if (open.empty() || "/" + open.back() != name) {
      return false;
    } else {
      open.pop_back();
    }
  }
  return open.empty() && count_of("\"", text) % 2 == 0;
}

/// A square room with all kinds of layers.
Plan full_plan() {
  Plan plan{.title = "A <room> & \"more\""};
  plan.layers.emplace_back(Raster{.image = {2, 1, {0, 255}}, .map_from_image = {0, 0, 0.5}, .resolution = 1});
  plan.layers.emplace_back(Points{.at = {{0, 0}, {4, 4}, {nan_value, 1}}, .legend = "points"});
  plan.layers.emplace_back(Polylines{
      .lines = {{{0, 0}, {4, 0}, {4, 4}}}, .outline = Outline::closed, .fill_opacity = 0.2, .legend = "lines"});
  plan.layers.emplace_back(Circles{.circles = {{{2, 2}, 1}}, .legend = "circles"});
  plan.layers.emplace_back(Robots{.map_from_robot = {{1, 1, 0.3}}, .legend = "robots"});
  plan.layers.emplace_back(Arrows{.arrows = {{{0, 0}, {1, 1}}}, .legend = "arrows"});
  plan.layers.emplace_back(Labels{.labels = {{{1, 1}, "here"}}});
  return plan;
}

Chart full_chart() {
  Chart chart{.title = "Recall", .x = {.label = "noise (m)"}, .y = {.label = "recall"}};
  for (std::size_t k = 0; k < 5; ++k) {
    Series series{.legend = "series " + std::to_string(k), .style = series_style(k)};
    for (int i = 0; i <= 10; ++i) {
      series.x.push_back(0.05 * i);
      series.y.push_back(1 - 0.01 * i * static_cast<double>(k + 1));
      series.low.push_back(series.y.back() - 0.02);
      series.high.push_back(series.y.back() + 0.02);
    }
    chart.series.push_back(series);
  }
  return chart;
}

TEST(Svg, IsWellFormedAndTheSameEveryTime) {
  const Figure figure{.title = "All <of> it", .panels = {full_plan(), full_chart(), Plan{}, Chart{}}, .columns = 2};
  const std::string text = to_svg(figure);
  EXPECT_TRUE(is_well_formed(text)) << text;
  EXPECT_EQ(text, to_svg(figure));
  EXPECT_THAT(text, HasSubstr("A &lt;room&gt; &amp; &quot;more&quot;"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  EXPECT_THAT(text, Not(HasSubstr("inf")));
}

TEST(Svg, HoldsEveryLayerAndItsLegend) {
  const std::string text = to_svg({.panels = {full_plan()}});
  for (const std::string_view word : {"points", "lines", "circles", "robots", "arrows", "here"}) {
    EXPECT_THAT(text, HasSubstr(">" + std::string(word) + "<"));
  }
  EXPECT_THAT(text, HasSubstr("data:image/png;base64,iVBORw0KGgo"));
  EXPECT_EQ(count_of("h0", text), 3U);  // two points, one in the legend; the one that is not finite is left out
}

/// The point at which a plan draws the only dot it holds: "Mx yh0".
Point2 dot_of(const Plan& plan) {
  const std::string text = to_svg({.panels = {plan}});
  const std::size_t begin = text.find("\"M");
  double x = 0;
  double y = 0;
  EXPECT_EQ(std::sscanf(text.c_str() + begin, "\"M%lf %lfh0", &x, &y), 2);
  return {x, y};
}

TEST(Svg, HasYUpAndEqualScales) {
  const Bounds bounds{{0, 0}, {10, 5}};
  const auto dot_at = [&](Point2 point) {
    Plan plan{.bounds = bounds};
    plan.layers.emplace_back(Points{.at = {point}});
    return dot_of(plan);
  };
  const Point2 origin = dot_at({0, 0});
  const Point2 right = dot_at({2, 0});
  const Point2 up = dot_at({0, 2});
  EXPECT_NEAR(right.x - origin.x, 96, 0.02);  // 480 px for 10 m
  EXPECT_NEAR(origin.y - up.y, 96, 0.02);
  EXPECT_EQ(origin.y, right.y);
  EXPECT_EQ(origin.x, up.x);
}

TEST(Svg, FindsBoundsThatHoldEveryLayer) {
  Plan plan;
  plan.layers.emplace_back(Points{.at = {{100, -50}, {103, -47}}});
  plan.layers.emplace_back(Circles{.circles = {{{110, -50}, 5}}});
  const std::string text = to_svg({.panels = {plan}});
  EXPECT_EQ(count_of("h0", text), 2U);
  EXPECT_EQ(count_of("<circle", text), 1U);
}

TEST(Svg, LeavesOutPointsBeyondGivenBounds) {
  Plan plan{.bounds = Bounds{{0, 0}, {1, 1}}};
  plan.layers.emplace_back(Points{.at = {{0.5, 0.5}, {7, 7}, {-7, 0.5}}});
  EXPECT_EQ(count_of("h0", to_svg({.panels = {plan}})), 1U);
}

TEST(Svg, ChoosesARoundScaleBar) {
  const auto bar = [](double metres) {
    const std::string text = to_svg({.panels = {Plan{.bounds = Bounds{{0, 0}, {metres, metres}}}}});
    const std::size_t end = text.rfind("</text>");
    return text.substr(text.rfind('>', end - 1) + 1, end - text.rfind('>', end - 1) - 1);
  };
  EXPECT_EQ(bar(10), "2 m");
  EXPECT_EQ(bar(40), "10 m");
  EXPECT_EQ(bar(100), "20 m");
  EXPECT_EQ(bar(0.5), "10 cm");
  EXPECT_EQ(bar(10000), "2 km");
}

TEST(Svg, PutsRoundTicksOnAxes) {
  Chart chart{.x = {.low = 0.0, .high = 0.5}, .y = {.low = 0.0, .high = 1.0}};
  chart.series.push_back({.x = {0, 0.5}, .y = {0, 1}});
  const std::string text = to_svg({.panels = {chart}});
  for (const std::string_view tick : {">0<", ">0.1<", ">0.5<", ">0.2<", ">1<", ">0.8<"}) {
    EXPECT_THAT(text, HasSubstr(tick));
  }
}

TEST(Svg, PutsPowersOfTenOnLogarithmicAxes) {
  Chart chart{.x = {.scale = AxisScale::logarithmic}, .y = {.scale = AxisScale::logarithmic}};
  chart.series.push_back({.x = {0, 1e3, 1e6}, .y = {1, 0.1, 10}});
  const std::string text = to_svg({.panels = {chart}});
  EXPECT_THAT(text, HasSubstr(">10<tspan dy=\"-4\" font-size=\"8\">6</tspan><"));
  EXPECT_THAT(text, HasSubstr(">0.1<"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  EXPECT_TRUE(is_well_formed(text));
}

TEST(Svg, TellsTicksOfLargeNumbersApart) {
  Chart chart;
  chart.series.push_back({.x = {1134864629, 1134864639}, .y = {0, 1}});
  const std::string text = to_svg({.panels = {chart}});
  EXPECT_THAT(text, HasSubstr(">1134864630<"));
  EXPECT_THAT(text, HasSubstr(">1134864632<"));
}

TEST(Svg, InterruptsSeriesWhereAValueIsMissing) {
  Chart chart;
  chart.series.push_back({.x = {0, 1, 2, 3, 4}, .y = {1, 2, nan_value, 2, 1}, .style = {.marker = Marker::none}});
  const std::string text = to_svg({.panels = {chart}});
  const std::size_t begin = text.find("d=\"M", text.rfind("<svg"));
  const std::string path = text.substr(begin, text.find("/>", begin) - begin);
  EXPECT_EQ(count_of("M", path), 2U);
  EXPECT_EQ(count_of("L", path), 2U);
}

TEST(Svg, DrawsChartsOfOneValueAndOfNone) {
  Chart one;
  one.series.push_back({.x = {3}, .y = {0}});
  for (const Chart& chart : {one, Chart{}}) {
    const std::string text = to_svg({.panels = {chart}});
    EXPECT_TRUE(is_well_formed(text));
    EXPECT_THAT(text, Not(HasSubstr("nan")));
  }
}

TEST(Svg, GivesSeriesStylesThatDifferInMoreThanColour) {
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = i + 1; k < 6; ++k) {
      const SeriesStyle a = series_style(i);
      const SeriesStyle b = series_style(k);
      EXPECT_FALSE(a.colour == b.colour);
      EXPECT_TRUE(a.dash != b.dash || a.marker != b.marker) << i << ' ' << k;
    }
  }
}

TEST(Svg, WritesCompactNumbers) {
  Plan plan{.bounds = Bounds{{0, 0}, {1, 1}}};
  std::vector<Point2> points;
  for (int i = 0; i < 1000; ++i) { points.push_back({0.5 + 0.3 * std::cos(0.37 * i), 0.5 + 0.3 * std::sin(0.37 * i)}); }
  plan.layers.emplace_back(Points{.at = points});
  EXPECT_LT(to_svg({.panels = {plan}}).size(), 1000 * 16 + 1500);
}

TEST(Svg, PutsPanelsIntoRows) {
  const Figure figure{.panels = {Plan{}, Plan{}, Plan{}}, .columns = 2, .panel_width = 200};
  const std::string text = to_svg(figure);
  EXPECT_THAT(text, HasSubstr(" width=\"448\""));
  std::set<std::string> corners;
  for (std::size_t i = text.find("<svg x="); i != std::string::npos; i = text.find("<svg x=", i + 1)) {
    corners.insert(text.substr(i, text.find(" width", i) - i));
  }
  EXPECT_EQ(corners.size(), 3U);
}

TEST(Svg, EscapesText) {
  EXPECT_EQ(escaped("a<b> & \"c\"\x01\n σ"), "a&lt;b&gt; &amp; &quot;c&quot; σ");
}

}  // namespace
}  // namespace flirt::svg
