// Plans: the world from above.
#include "flirt/io/png.hpp"
#include "flirt/io/svg_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace flirt::svg::parts {
namespace {

constexpr double scale_bar_strip = 26;  // px below the plot

// --- What the layers cover -------------------------------------------------------------------------------------------

struct Extent {
  Point2 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Point2 high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

  void add(Point2 point, double radius = 0) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(radius)) { return; }
    low = {std::min(low.x, point.x - radius), std::min(low.y, point.y - radius)};
    high = {std::max(high.x, point.x + radius), std::max(high.y, point.y + radius)};
  }
  [[nodiscard]] bool is_empty() const { return low.x > high.x; }
};

void cover(Extent& extent, const Points& layer) {
  for (const Point2 point : layer.at) { extent.add(point); }
}
void cover(Extent& extent, const Polylines& layer) {
  for (const auto& line : layer.lines) {
    for (const Point2 point : line) { extent.add(point); }
  }
}
void cover(Extent& extent, const Circles& layer) {
  for (const Circle& circle : layer.circles) { extent.add(circle.centre, circle.radius); }
}
void cover(Extent& extent, const Robots& layer) {
  for (const Pose2& pose : layer.map_from_robot) { extent.add(pose.translation(), layer.length / 2); }
}
void cover(Extent& extent, const Arrows& layer) {
  for (const Arrow& arrow : layer.arrows) {
    extent.add(arrow.from);
    extent.add(arrow.to);
  }
}
void cover(Extent& extent, const Labels& layer) {
  for (const Label& label : layer.labels) { extent.add(label.at); }
}
void cover(Extent& extent, const Raster& layer) {
  const double width = static_cast<double>(layer.image.width) * layer.resolution;
  const double height = static_cast<double>(layer.image.height) * layer.resolution;
  for (const Point2 corner : {Point2{0, 0}, Point2{width, 0}, Point2{0, height}, Point2{width, height}}) {
    extent.add(layer.map_from_image * corner);
  }
}

Bounds bounds_of(const Plan& plan) {
  if (plan.bounds) { return *plan.bounds; }
  Extent extent;
  for (const Layer& layer : plan.layers) {
    std::visit([&](const auto& one) { cover(extent, one); }, layer);
  }
  if (extent.is_empty()) { return {{-1, -1}, {1, 1}}; }
  const double larger = std::max(extent.high.x - extent.low.x, extent.high.y - extent.low.y);
  const double padding = larger > 0 ? 0.04 * larger : 1.0;
  return {extent.low - Point2{padding, padding}, extent.high + Point2{padding, padding}};
}

// --- From the world to the page --------------------------------------------------------------------------------------

/// The plot: its size on the page, and what of the world it shows.
struct View {
  double width{0};   ///< px
  double height{0};  ///< px
  double scale{1};   ///< px per m
  Point2 centre{};   ///< m

  [[nodiscard]] Point2 pixel(Point2 point) const {
    return {width / 2 + (point.x - centre.x) * scale, height / 2 - (point.y - centre.y) * scale};
  }
  [[nodiscard]] bool shows(Point2 pixel, double radius) const {
    return pixel.x >= -radius && pixel.y >= -radius && pixel.x <= width + radius && pixel.y <= height + radius;
  }
};

View view_of(const Plan& plan, double width) {
  const Bounds bounds = bounds_of(plan);
  const double world_width = std::max(bounds.high.x - bounds.low.x, 1e-6);
  const double world_height = std::max(bounds.high.y - bounds.low.y, 1e-6);
  const double height = width * std::clamp(world_height / world_width, 0.35, 1.25);
  return {width, height, std::min(width / world_width, height / world_height), 0.5 * (bounds.low + bounds.high)};
}

// --- The layers ------------------------------------------------------------------------------------------------------

std::string path(const std::string& attributes, const std::string& data) {
  return data.empty() ? std::string{} : "<path" + attributes + attribute("d", data) + "/>\n";
}

/// Lines of length zero with round ends: the shortest way to write many dots.
std::string dots(const std::vector<Point2>& pixels, Colour colour, double radius, double opacity) {
  std::string data;
  std::string previous;
  for (const Point2 pixel : pixels) {
    std::string place = number(pixel.x) + ' ' + number(pixel.y);
    if (place != previous) { data.append("M").append(place).append("h0"); }
    previous = std::move(place);
  }
  return path(stroke(colour, 2 * radius, Dash::solid, opacity) + attribute("stroke-linecap", "round"), data);
}

std::string draw_layer(const Points& layer, const View& view) {
  std::vector<Point2> pixels;
  for (const Point2 point : layer.at) {
    const Point2 pixel = view.pixel(point);
    if (view.shows(pixel, layer.radius)) { pixels.push_back(pixel); }  // false for NaN
  }
  return dots(pixels, layer.colour, layer.radius, layer.opacity);
}

std::string line_attributes(const Polylines& layer) {
  std::string attributes = stroke(layer.colour, layer.width, layer.dash, layer.opacity);
  if (layer.fill_opacity > 0) {
    attributes.replace(attributes.find("none"), 4, hex(layer.colour));
    attributes += attribute("fill-opacity", layer.fill_opacity);
  }
  return attributes + attribute("stroke-linejoin", "round");
}

std::string draw_layer(const Polylines& layer, const View& view) {
  std::string data;
  for (const auto& line : layer.lines) {
    std::vector<Point2> pixels;
    pixels.reserve(line.size());
    for (const Point2 point : line) { pixels.push_back(view.pixel(point)); }
    data += path_through(pixels, layer.outline);
  }
  return path(line_attributes(layer), data);
}

std::string draw_layer(const Circles& layer, const View& view) {
  std::string text;
  for (const Circle& circle : layer.circles) {
    const Point2 pixel = view.pixel(circle.centre);
    const double radius = circle.radius * view.scale;
    if (!view.shows(pixel, radius)) { continue; }
    text += "<circle" + attribute("cx", pixel.x) + attribute("cy", pixel.y) + attribute("r", radius) + "/>\n";
  }
  if (text.empty()) { return {}; }
  std::string attributes = stroke(layer.colour, layer.width, layer.dash);
  if (layer.fill_opacity > 0) {
    attributes.replace(attributes.find("none"), 4, hex(layer.colour));
    attributes += attribute("fill-opacity", layer.fill_opacity);
  }
  return "<g" + attributes + ">\n" + text + "</g>\n";
}

/// A triangle of this length, px, centred on its pose; `heading` is counter-clockwise on the page.
std::vector<Point2> triangle(Point2 centre, double heading, double length) {
  const Point2 ahead{std::cos(heading) * length, -std::sin(heading) * length};
  const Point2 left{ahead.y, -ahead.x};
  return {centre + 0.55 * ahead, centre - 0.45 * ahead + 0.36 * left, centre - 0.45 * ahead - 0.36 * left};
}

std::string draw_layer(const Robots& layer, const View& view) {
  std::string data;
  const double length = std::max(8.0, layer.length * view.scale);
  for (const Pose2& pose : layer.map_from_robot) {
    const Point2 pixel = view.pixel(pose.translation());
    if (is_finite(pose) && view.shows(pixel, length)) {
      data += path_through(triangle(pixel, pose.theta, length), Outline::closed);
    }
  }
  return path(attribute("fill", hex(layer.colour)) + attribute("stroke", "#fff") + attribute("stroke-width", 0.6),
              data);
}

/// Shaft and head of an arrow, px.
std::string arrow_path(Point2 from, Point2 to) {
  const Point2 shaft = to - from;
  const double length = norm(shaft);
  if (!(length > 0) || !std::isfinite(length)) { return {}; }
  const Point2 back = (-std::min(7.0, length) / length) * shaft;
  const Point2 side{-0.5 * back.y, 0.5 * back.x};
  return path_through({from, to}) + path_through({to + back + side, to, to + back - side});
}

std::string draw_layer(const Arrows& layer, const View& view) {
  std::string data;
  for (const Arrow& arrow : layer.arrows) { data += arrow_path(view.pixel(arrow.from), view.pixel(arrow.to)); }
  return path(stroke(layer.colour, layer.width), data);
}

std::string draw_layer(const Labels& layer, const View& view) {
  std::string text;
  const std::string attributes = attribute("font-size", layer.size) + attribute("fill", hex(layer.colour)) +
                                 R"( stroke="#fff" stroke-width="2.5" paint-order="stroke")";  // readable on anything
  for (const Label& label : layer.labels) {
    const Point2 pixel = view.pixel(label.at);
    if (view.shows(pixel, 0)) { text += text_at(pixel.x, pixel.y, label.text, Anchor::start, attributes); }
  }
  return text;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U;
    };
    const std::uint32_t group = byte(0) << 16U | byte(1) << 8U | byte(2);
    text += digits[group >> 18U & 63U];
    text += digits[group >> 12U & 63U];
    text += i + 1 < bytes.size() ? digits[group >> 6U & 63U] : '=';
    text += i + 2 < bytes.size() ? digits[group & 63U] : '=';
  }
  return text;
}

std::string draw_layer(const Raster& layer, const View& view) {
  if (layer.image.pixels.empty() || !(layer.resolution > 0) || !is_finite(layer.map_from_image)) { return {}; }
  const double per_pixel = layer.resolution * view.scale;
  const double height = static_cast<double>(layer.image.height) * layer.resolution;
  const Point2 corner = view.pixel(layer.map_from_image * Point2{0, height});
  std::string text = "<image" + attribute("width", static_cast<double>(layer.image.width));
  text += attribute("height", static_cast<double>(layer.image.height));
  std::string placement = "translate(" + number(corner.x) + ' ' + number(corner.y) + ") rotate(";
  placement += number(-degrees_from_radians(layer.map_from_image.theta)) + ") scale(" + std::to_string(per_pixel) + ')';
  text += attribute("transform", placement) + attribute("style", "image-rendering:pixelated");
  if (layer.opacity < 1) { text += attribute("opacity", layer.opacity); }
  return text + attribute("href", "data:image/png;base64," + base64(encode_png(layer.image))) + "/>\n";
}

// --- Legend and scale bar --------------------------------------------------------------------------------------------

std::string legend_picture(const Points& layer) {
  return dots({{0, 0}}, layer.colour, std::max(2.5, layer.radius), 1);
}
std::string legend_picture(const Polylines& layer) {
  return path(stroke(layer.colour, std::max(1.2, layer.width), layer.dash, layer.opacity), "M-11 0L11 0");
}
std::string legend_picture(const Circles& layer) {
  return "<circle r=\"5\"" + stroke(layer.colour, layer.width, layer.dash) + "/>";
}
std::string legend_picture(const Robots& layer) {
  return path(attribute("fill", hex(layer.colour)), path_through(triangle({0, 0}, 0, 12), Outline::closed));
}
std::string legend_picture(const Arrows& layer) {
  return path(stroke(layer.colour, layer.width), arrow_path({-11, 0}, {11, 0}));
}

std::vector<LegendEntry> legend_of(const Plan& plan) {
  std::vector<LegendEntry> entries;
  for (const Layer& layer : plan.layers) {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.legend; }) {
            if (!one.legend.empty()) { entries.push_back({legend_picture(one), one.legend}); }
          }
        },
        layer);
  }
  return entries;
}

std::string scale_bar(const View& view, double left, double top) {
  const double metres = round_down(0.25 * view.width / view.scale);
  const double length = metres * view.scale;
  const std::string data =
      path_through({{left, top + 6}, {left, top + 12}, {left + length, top + 12}, {left + length, top + 6}});
  std::string label = number(metres) + " m";
  if (metres >= 1000) { label = number(metres / 1000) + " km"; }
  if (metres < 1) { label = number(metres * 100) + " cm"; }
  return path(stroke(black, 1.2), data) + text_at(left + length + 6, top + 14, label);
}

}  // namespace

double height(const Plan& plan, double width) {
  const auto rows = static_cast<double>(legend_rows(legend_of(plan), width));
  return (plan.title.empty() ? 0 : title_height) + view_of(plan, width).height + scale_bar_strip + rows * legend_row;
}

std::string draw(const Plan& plan, double left, double top, double width) {
  const View view = view_of(plan, width);
  const Box box{left, top + (plan.title.empty() ? 0 : title_height), view.width, view.height};
  std::string text = plan.title.empty() ? std::string{} : title_above(box, plan.title);
  const std::string place = attribute("x", box.left) + attribute("y", box.top) + attribute("width", box.width) +
                            attribute("height", box.height);
  text += "<svg" + place + attribute("overflow", "hidden") + ">\n";  // an inner svg cuts off what lies outside
  for (const Layer& layer : plan.layers) {
    text += std::visit([&](const auto& one) { return draw_layer(one, view); }, layer);
  }
  text += "</svg>\n<rect" + place + stroke(Colour{200, 200, 200}, 1) + "/>\n";
  const double below = box.top + box.height;
  return text + scale_bar(view, left, below) + legend(legend_of(plan), left, below + scale_bar_strip, width);
}

}  // namespace flirt::svg::parts
