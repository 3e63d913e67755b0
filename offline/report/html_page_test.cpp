#include "offline/report/html_page.hpp"

#include <doctest/doctest.h>

#include <string>

namespace greenloop::offline {
namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const std::string evil = "<script>alert('x')</script>";

}  // namespace

TEST_CASE("no text of any section reaches the page unescaped") {
  HtmlPage page(evil, evil);
  page.key_figures({{evil, evil, KeyFigure::Mood::bad}});
  page.heading(evil);
  page.paragraph(evil);
  page.figure({"name", evil, evil, "<svg></svg>"});
  page.facts({{evil, {{evil, evil}, {evil, "two\nlines " + evil}}}});
  page.table({{evil}, {{evil}}}, evil);
  page.missing({{evil, evil}});
  const std::string text = page.str();
  CHECK_FALSE(has(text, "<script"));
  std::size_t count = 0;
  for (std::size_t at = text.find("&lt;script&gt;"); at != std::string::npos; at = text.find("&lt;script&gt;", at + 1))
    ++count;
  CHECK(count == 19);
}

TEST_CASE("a page is one complete document in light and dark") {
  const std::string text = HtmlPage("a", "b").str();
  CHECK(text.starts_with("<!DOCTYPE html>"));
  CHECK(text.ends_with("</html>\n"));
  CHECK(has(text, "prefers-color-scheme:dark"));
  CHECK(has(text, "@media print"));
}

TEST_CASE("nothing missing leaves no heading") {
  HtmlPage page("a", "b");
  page.missing({});
  CHECK_FALSE(has(page.str(), "Not in this report"));
}

}  // namespace greenloop::offline
