// flirt/io/svg.hpp: figures as SVG text: plans of the world in metres and line charts, several side by side.
//
//   svg::Plan plan{.title = "Scan 12 in the map"};
//   plan.layers.emplace_back(svg::Points{.at = points, .colour = svg::sky_blue, .legend = "end points"});
//   plan.layers.emplace_back(svg::Robots{.map_from_robot = {pose}, .legend = "robot"});
//   const std::string text = svg::to_svg({.panels = {plan}});
//
// Equal input gives equal bytes. Points that are not finite are left out.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/grid/grey_image.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace flirt::svg {

struct Colour {
  std::uint8_t red{0};
  std::uint8_t green{0};
  std::uint8_t blue{0};
  friend bool operator==(const Colour&, const Colour&) = default;
};

// The palette of Okabe and Ito (2008), told apart by colour-blind readers. Yellow is for fills: too light for lines.
inline constexpr Colour black{0, 0, 0};
inline constexpr Colour orange{230, 159, 0};
inline constexpr Colour sky_blue{86, 180, 233};
inline constexpr Colour green{0, 158, 115};
inline constexpr Colour yellow{240, 228, 66};
inline constexpr Colour blue{0, 114, 178};
inline constexpr Colour vermilion{213, 94, 0};
inline constexpr Colour purple{204, 121, 167};
inline constexpr Colour grey{150, 150, 150};

enum class Dash : std::uint8_t { solid, dashed, dotted, dash_dot };
enum class Marker : std::uint8_t { none, circle, square, triangle, diamond, cross };
enum class Outline : std::uint8_t { open, closed };
enum class AxisScale : std::uint8_t { linear, logarithmic };

// The layers of a plan. Every layer is a set of like marks with one style and at most one entry in the legend; later
// layers cover earlier ones. World coordinates are metres, y up; widths and radii are pixels unless said otherwise.

struct Points {
  std::vector<Point2> at{};  ///< m
  Colour colour{blue};
  double radius{1.2};  ///< px
  double opacity{1};
  std::string legend{};  ///< empty: not in the legend
};

struct Polylines {
  std::vector<std::vector<Point2>> lines{};  ///< m
  Colour colour{blue};
  double width{1.5};  ///< px
  Dash dash{Dash::solid};
  Outline outline{Outline::open};
  double opacity{1};
  double fill_opacity{0};
  std::string legend{};
};

struct Circle {
  Point2 centre{};   ///< m
  double radius{0};  ///< m
};
struct Circles {
  std::vector<Circle> circles{};
  Colour colour{vermilion};
  double width{1.5};  ///< px
  Dash dash{Dash::solid};
  double fill_opacity{0};
  std::string legend{};
};

/// Triangles whose apex points ahead, at least 8 px long.
struct Robots {
  std::vector<Pose2> map_from_robot{};
  Colour colour{vermilion};
  double length{0.5};  ///< m
  std::string legend{};
};

struct Arrow {
  Point2 from{};  ///< m
  Point2 to{};    ///< m
};
struct Arrows {
  std::vector<Arrow> arrows{};
  Colour colour{black};
  double width{1.2};  ///< px
  std::string legend{};
};

struct Label {
  Point2 at{};  ///< m, lower left corner of the text
  std::string text{};
};
struct Labels {
  std::vector<Label> labels{};
  Colour colour{black};
  double size{11};  ///< px
};

/// A grid map as a picture; pixels stay sharp when enlarged.
struct Raster {
  GreyImage image{};
  Pose2 map_from_image{};  ///< pose of the lower left corner
  double resolution{0};    ///< m per pixel
  double opacity{1};
};

using Layer = std::variant<Points, Polylines, Circles, Robots, Arrows, Labels, Raster>;

struct Bounds {
  Point2 low{};   ///< lower left corner
  Point2 high{};  ///< upper right corner
};

/// The world from above, equal scale on both axes, with a scale bar and a legend below.
struct Plan {
  std::string title{};
  std::vector<Layer> layers{};
  std::optional<Bounds> bounds{};  ///< m; else all that the layers hold
};

/// A colour, dash and marker that differ together, so that lines are told apart in grey as well.
struct SeriesStyle {
  Colour colour{blue};
  Dash dash{Dash::solid};
  Marker marker{Marker::circle};
};
/// The style of the i-th of several series.
[[nodiscard]] SeriesStyle series_style(std::size_t i);

struct Series {
  std::string legend{};
  std::vector<double> x{};
  std::vector<double> y{};     ///< as many as x; not finite: a gap
  std::vector<double> low{};   ///< lower edge of an interval around y, shaded; empty: none
  std::vector<double> high{};  ///< upper edge; as many as `low`
  SeriesStyle style{};
};

struct Axis {
  std::string label{};          ///< with its unit: "time (s)"
  std::optional<double> low{};  ///< else from the data
  std::optional<double> high{};
  AxisScale scale{AxisScale::linear};  ///< logarithmic leaves out what is not positive
};

struct Chart {
  std::string title{};
  Axis x{};
  Axis y{};
  std::vector<Series> series{};
};

using Panel = std::variant<Plan, Chart>;

struct Figure {
  std::string title{};
  std::vector<Panel> panels{};
  std::size_t columns{0};   ///< panels in a row; 0: all
  double panel_width{480};  ///< px
};

/// The figure as one SVG document (text, UTF-8). O(all points).
[[nodiscard]] std::string to_svg(const Figure& figure);

/// Text with &, <, >, " written as entities and control characters left out.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace flirt::svg
