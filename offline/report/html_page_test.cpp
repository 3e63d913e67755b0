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
  page.verdict({false, evil, {{evil, evil, evil, false}}});
  page.heading(evil);
  page.paragraph(evil);
  page.figure({"name", evil, evil, {SvgCanvas(1, 1, evil, evil)}});
  page.figures({{"name", evil, evil, {}}});
  page.begin_fold(evil);
  page.end_fold();
  page.facts({{evil, {{evil, evil}, {evil, "two\nlines " + evil}}}});
  page.table({{evil}, {{evil}}}, evil);
  page.missing({{evil, evil}});
  const std::string text = page.str();
  CHECK_FALSE(has(text, "<script"));
  std::size_t count = 0;
  for (std::size_t at = text.find("&lt;script&gt;"); at != std::string::npos; at = text.find("&lt;script&gt;", at + 1))
    ++count;
  CHECK(count == 26);
}

TEST_CASE("a page is one complete document in light and dark") {
  const std::string text = HtmlPage("a", "b").str();
  CHECK(text.starts_with("<!DOCTYPE html>"));
  CHECK(text.ends_with("</html>\n"));
  CHECK(has(text, "prefers-color-scheme:dark"));
  CHECK(has(text, "@media print"));
}

TEST_CASE("a verdict shows what was asked beside what is reached, and marks what is judged") {
  HtmlPage page("a", "b");
  page.verdict({false, "Not good enough.", {{"x", "5 %", "7 %", false}, {"y", "1", "0", true}, {"z", "–", "3 MB"}}});
  const std::string text = page.str();
  CHECK(has(text, "<section class=\"verdict bad\">\n<p>Not good enough.</p>"));
  CHECK(has(text, "<tr class=\"bad\"><td>x</td><td>5 %</td><td>7 %</td><td class=\"mark\">✗</td></tr>"));
  CHECK(has(text, "<tr class=\"good\"><td>y</td><td>1</td><td>0</td><td class=\"mark\">✓</td></tr>"));
  CHECK(has(text, "<tr class=\"\"><td>z</td><td>–</td><td>3 MB</td><td class=\"mark\"></td></tr>"));
}

TEST_CASE("a page is legible on a telephone: as wide as the screen, no text below 14 pixels, wide tables scroll") {
  HtmlPage page("a", "b");
  page.table({{"a", "b", "c", "d", "e"}, {}}, "wide");
  page.table({{"a", "b"}, {}}, "narrow");
  const std::string text = page.str();
  CHECK(has(text, "<meta name=\"viewport\" content=\"width=device-width"));
  CHECK(has(text, "<div class=\"wide\"><table class=\"many\">"));
  CHECK(has(text, "<div class=\"wide\"><table>"));
  const std::string size = "font-size:";
  for (std::size_t at = text.find(size); at != std::string::npos; at = text.find(size, at + 1)) {
    const std::string value = text.substr(at + size.size(), 8);
    if (value.find("px") != std::string::npos) CHECK(std::stod(value) >= 14);
  }
}

TEST_CASE("nothing missing leaves no heading") {
  HtmlPage page("a", "b");
  page.missing({});
  CHECK_FALSE(has(page.str(), "Not in this report"));
}

}  // namespace greenloop::offline
