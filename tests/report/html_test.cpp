#include "flirt/report/html.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace flirt {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(HtmlReport, EscapesWhatItIsGiven) {
  HtmlReport report("a < b");
  report.paragraph("<script>");
  report.table({"x & y"}, {{"\"quoted\""}, {"0.98 [0.97, 0.99]"}});
  const std::string page = report.text();
  EXPECT_THAT(page, HasSubstr("<title>a &lt; b</title>"));
  EXPECT_THAT(page, HasSubstr("<p>&lt;script&gt;</p>"));
  EXPECT_THAT(page, HasSubstr("<th>x &amp; y</th>"));
  EXPECT_THAT(page, HasSubstr("<td class=\"number\">0.98 [0.97, 0.99]</td>"));
  EXPECT_THAT(page, HasSubstr("<td>&quot;quoted&quot;</td>"));
}

TEST(HtmlReport, EmbedsFiguresWithoutTheirXmlHeaderAndNeedsNoNetwork) {
  HtmlReport report("r");
  report.figure("<?xml version=\"1.0\"?>\n<svg><g/></svg>", "a figure");
  EXPECT_THAT(report.text(), HasSubstr("<figure>\n<svg><g/></svg>"));
  EXPECT_THAT(report.text(), Not(HasSubstr("<?xml")));
  EXPECT_THAT(report.text(), Not(HasSubstr("http")));
}

}  // namespace
}  // namespace flirt
