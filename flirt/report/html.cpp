#include "flirt/report/html.hpp"

#include "flirt/io/svg.hpp"

#include <algorithm>

namespace flirt {
namespace {

constexpr std::string_view style = R"(
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: 1rem 0; }
th, td { padding: .25rem .75rem; text-align: left; border-bottom: 1px solid #8884; }
td.number { text-align: right; }
figure { margin: 1rem 0; overflow-x: auto; } figure svg { background: #fff; max-width: 100%; height: auto; }
figcaption { color: #777; }
)";

bool looks_like_number(std::string_view cell) {
  return !cell.empty() && std::all_of(cell.begin(), cell.end(), [](char c) {
    return (c >= '0' && c <= '9') || std::string_view(" .,+-[]/%").find(c) != std::string_view::npos;
  });
}

}  // namespace

HtmlReport::HtmlReport(std::string_view title) : title_(svg::escaped(title)) {}

void HtmlReport::heading(std::string_view text) {
  body_ += "<h2>" + svg::escaped(text) + "</h2>\n";
}

void HtmlReport::paragraph(std::string_view text) {
  body_ += "<p>" + svg::escaped(text) + "</p>\n";
}

void HtmlReport::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
  body_ += "<table>\n<tr>";
  for (const std::string& cell : header) { body_ += "<th>" + svg::escaped(cell) + "</th>"; }
  body_ += "</tr>\n";
  for (const auto& row : rows) {
    body_ += "<tr>";
    for (const std::string& cell : row) {
      body_ += (looks_like_number(cell) ? "<td class=\"number\">" : "<td>") + svg::escaped(cell) + "</td>";
    }
    body_ += "</tr>\n";
  }
  body_ += "</table>\n";
}

void HtmlReport::figure(std::string_view svg, std::string_view caption) {
  if (const std::size_t start = svg.find("<svg"); start != std::string_view::npos) { svg.remove_prefix(start); }
  body_ += "<figure>\n" + std::string(svg) + "\n<figcaption>" + svg::escaped(caption) + "</figcaption>\n</figure>\n";
}

std::string HtmlReport::text() const {
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         title_ + "</title>\n<style>" + std::string(style) + "</style>\n</head>\n<body>\n<h1>" + title_ + "</h1>\n" +
         body_ + "</body>\n</html>\n";
}

}  // namespace flirt
