// flirt/io/svg_parts.hpp: what plans and charts share in writing SVG. Internal to flirt/io; use flirt/io/svg.hpp.
#pragma once

#include "flirt/io/svg.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace flirt::svg::parts {

/// A rectangle on the page, px, y down.
struct Box {
  double left{0};
  double top{0};
  double width{0};
  double height{0};
};

/// One line of a legend: a picture of 22 × 12 px centred on the origin, and its text.
struct LegendEntry {
  std::string picture{};
  std::string text{};
};

enum class Anchor : std::uint8_t { start, middle, end };

inline constexpr double small_text = 11;    ///< px
inline constexpr double title_height = 24;  ///< px, where there is a title
inline constexpr double legend_row = 18;    ///< px

/// A coordinate with at most two decimals and no needless characters.
[[nodiscard]] std::string number(double value);
/// The same for several: name="value" with a space before.
[[nodiscard]] std::string attribute(std::string_view name, double value);
[[nodiscard]] std::string attribute(std::string_view name, std::string_view value);
/// #rrggbb
[[nodiscard]] std::string hex(Colour colour);
/// Attributes of a line: colour, width, dashes, no fill.
[[nodiscard]] std::string stroke(Colour colour, double width, Dash dash = Dash::solid, double opacity = 1);
/// A text whose base line starts, is centred or ends at (x, y).
[[nodiscard]] std::string text_at(double x, double y, std::string_view text, Anchor anchor = Anchor::start,
                                  std::string_view more_attributes = {});
[[nodiscard]] std::string title_above(const Box& box, std::string_view title);
/// "M…L…" through the points, px; points that are not finite interrupt it, and points that fall on the one before are
/// left out.
[[nodiscard]] std::string path_through(const std::vector<Point2>& pixels, Outline outline = Outline::open);

/// Rows that the legend needs in this width.
[[nodiscard]] std::size_t legend_rows(const std::vector<LegendEntry>& entries, double width);
/// The legend from the upper left corner of a place of this width.
[[nodiscard]] std::string legend(const std::vector<LegendEntry>& entries, double left, double top, double width);

/// Largest of 1, 2, 5 · 10^k that is at most `value`; value > 0.
[[nodiscard]] double round_down(double value);

// The two kinds of panel: how high one of this width becomes (title and legend included), and its drawing.
[[nodiscard]] double height(const Plan& plan, double width);
[[nodiscard]] double height(const Chart& chart, double width);
[[nodiscard]] std::string draw(const Plan& plan, double left, double top, double width);
[[nodiscard]] std::string draw(const Chart& chart, double left, double top, double width);

}  // namespace flirt::svg::parts
