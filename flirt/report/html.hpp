// flirt/report/html.hpp: a report as one HTML file that opens without a network: text, tables, figures.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace flirt {

/// Built from top to bottom; all text is escaped, figures are SVG documents put in as they are.
class HtmlReport {
 public:
  explicit HtmlReport(std::string_view title);

  void heading(std::string_view text);
  void paragraph(std::string_view text);
  /// Cells that look like numbers are set to the right. Rows may be shorter than the header.
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
  void figure(std::string_view svg, std::string_view caption);

  /// The whole page.
  [[nodiscard]] std::string text() const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace flirt
