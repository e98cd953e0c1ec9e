#include "flirt/io/svg.hpp"

#include "flirt/io/svg_parts.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace flirt::svg {

namespace parts {
namespace {

constexpr double swatch_width = 28;  // px, picture and the gap to its text
constexpr double entry_gap = 14;     // px between entries of a legend

/// Width of a text of `small_text` px, estimated from its number of characters.
double text_width(std::string_view text) {
  const auto characters =
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
  return 0.56 * small_text * static_cast<double>(characters);
}

double entry_width(const LegendEntry& entry) {
  return swatch_width + text_width(entry.text) + entry_gap;
}

std::string_view dash_pattern(Dash dash) {
  switch (dash) {
    case Dash::solid:
      return {};
    case Dash::dashed:
      return "6 3";
    case Dash::dotted:
      return "1.5 3";
    case Dash::dash_dot:
      return "7 3 1.5 3";
  }
  return {};
}

std::string_view anchor_name(Anchor anchor) {
  switch (anchor) {
    case Anchor::start:
      return {};
    case Anchor::middle:
      return "middle";
    case Anchor::end:
      return "end";
  }
  return {};
}

}  // namespace

std::string number(double value) {
  std::array<char, 400> buffer{};
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, 2);
  std::string_view text(buffer.data(), error == std::errc{} ? static_cast<std::size_t>(end - buffer.data()) : 0);
  while (text.ends_with('0')) { text.remove_suffix(1); }
  if (text.ends_with('.')) { text.remove_suffix(1); }
  if (text.empty() || text == "-" || text == "-0") { return "0"; }
  return std::string(text);
}

std::string attribute(std::string_view name, std::string_view value) {
  std::string text(" ");
  text.append(name).append("=\"").append(value).append("\"");
  return text;
}

std::string attribute(std::string_view name, double value) {
  return attribute(name, number(value));
}

std::string hex(Colour colour) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text("#");
  for (const unsigned part : {colour.red, colour.green, colour.blue}) {
    text += digits[part / 16];
    text += digits[part % 16];
  }
  return text;
}

std::string stroke(Colour colour, double width, Dash dash, double opacity) {
  std::string text = attribute("fill", "none") + attribute("stroke", hex(colour)) + attribute("stroke-width", width);
  if (dash != Dash::solid) { text += attribute("stroke-dasharray", dash_pattern(dash)); }
  if (opacity < 1) { text += attribute("stroke-opacity", opacity); }
  return text;
}

std::string text_at(double x, double y, std::string_view text, Anchor anchor, std::string_view more_attributes) {
  std::string element = "<text" + attribute("x", x) + attribute("y", y);
  if (anchor != Anchor::start) { element += attribute("text-anchor", anchor_name(anchor)); }
  return element.append(more_attributes).append(">").append(escaped(text)).append("</text>\n");
}

std::string title_above(const Box& box, std::string_view title) {
  return text_at(box.left, box.top - 9, title, Anchor::start, R"( font-size="13" font-weight="600")");
}

std::string path_through(const std::vector<Point2>& pixels, Outline outline) {
  std::string path;
  std::string previous;
  bool starts = true;
  for (const Point2 pixel : pixels) {
    if (!std::isfinite(pixel.x) || !std::isfinite(pixel.y)) {
      starts = true;
      continue;
    }
    std::string place = number(pixel.x) + ' ' + number(pixel.y);
    if (!starts && place == previous) { continue; }
    path.append(starts ? "M" : "L").append(place);
    previous = std::move(place);
    starts = false;
  }
  if (outline == Outline::closed && !path.empty()) { path += 'Z'; }
  return path;
}

std::size_t legend_rows(const std::vector<LegendEntry>& entries, double width) {
  std::size_t rows = entries.empty() ? 0 : 1;
  double used = 0;
  for (const LegendEntry& entry : entries) {
    if (used > 0 && used + entry_width(entry) > width) {
      ++rows;
      used = 0;
    }
    used += entry_width(entry);
  }
  return rows;
}

std::string legend(const std::vector<LegendEntry>& entries, double left, double top, double width) {
  std::string text;
  double used = 0;
  double middle = top + legend_row / 2;
  for (const LegendEntry& entry : entries) {
    if (used > 0 && used + entry_width(entry) > width) {
      used = 0;
      middle += legend_row;
    }
    text +=
        "<g transform=\"translate(" + number(left + used + 11) + ' ' + number(middle) + ")\">" + entry.picture + "</g>";
    text += text_at(left + used + swatch_width, middle + 4, entry.text);
    used += entry_width(entry);
  }
  return text;
}

double round_down(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {10.0, 5.0, 2.0}) {
    if (factor * decade <= value * (1 + 1e-12)) { return factor * decade; }
  }
  return decade;
}

}  // namespace parts

namespace {

constexpr double margin = 16;  // px around and between panels

double panel_height(const Panel& panel, double width) {
  return std::visit([&](const auto& one) { return parts::height(one, width); }, panel);
}

std::string draw_panel(const Panel& panel, double left, double top, double width) {
  return std::visit([&](const auto& one) { return parts::draw(one, left, top, width); }, panel);
}

std::string document(double width, double height, const std::string& title, const std::string& body) {
  using parts::attribute;
  using parts::number;
  std::string text =
      "<svg xmlns=\"http://www.w3.org/2000/svg\"" + attribute("width", width) + attribute("height", height);
  text += attribute("viewBox", "0 0 " + number(width) + ' ' + number(height)) + attribute("role", "img");
  text +=
      attribute("font-family", "system-ui, Helvetica, Arial, sans-serif") + attribute("font-size", parts::small_text);
  text += attribute("fill", "#222") + ">\n";
  if (!title.empty()) { text += "<title>" + escaped(title) + "</title>\n"; }
  text += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  return text + body + "</svg>\n";
}

}  // namespace

std::string to_svg(const Figure& figure) {
  const std::size_t columns = std::max<std::size_t>(1, figure.columns == 0 ? figure.panels.size() : figure.columns);
  std::string body;
  double top = margin;
  if (!figure.title.empty()) {
    body +=
        parts::text_at(margin, top + 12, figure.title, parts::Anchor::start, R"( font-size="16" font-weight="600")");
    top += 16 + margin;
  }
  for (std::size_t begin = 0; begin < figure.panels.size(); begin += columns) {
    const std::size_t end = std::min(begin + columns, figure.panels.size());
    double row_height = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const double left = margin + static_cast<double>(i - begin) * (figure.panel_width + margin);
      body += draw_panel(figure.panels[i], left, top, figure.panel_width);
      row_height = std::max(row_height, panel_height(figure.panels[i], figure.panel_width));
    }
    top += row_height + margin;
  }
  const auto widest = static_cast<double>(std::min(columns, std::max<std::size_t>(1, figure.panels.size())));
  return document(margin + widest * (figure.panel_width + margin), top, figure.title, body);
}

std::string escaped(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20) { result += c; }
    }
  }
  return result;
}

}  // namespace flirt::svg
