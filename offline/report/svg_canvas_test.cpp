#include "offline/report/svg_canvas.hpp"

#include <doctest/doctest.h>

#include <string>

#include "offline/report/theme.hpp"

namespace greenloop::offline {

TEST_CASE("markup in text is escaped") {
  CHECK(escape_markup(R"(<b a="1">'x' & y</b>)") == "&lt;b a=&quot;1&quot;&gt;&#39;x&#39; &amp; y&lt;/b&gt;");
  CHECK(escape_markup(std::string("a\x01\tb", 4)) == "a  b");
  CHECK(escape_markup("b\xE4r") == "b\xEF\xBF\xBDr");
}

TEST_CASE("a drawing contains no unescaped caller text") {
  SvgCanvas canvas(100, 50, "<title>", "a & b");
  canvas.text({1, 2}, "<script>alert(1)</script>");
  const std::string drawing = canvas.str();
  CHECK(drawing.find("<script") == std::string::npos);
  CHECK(drawing.find("&lt;script&gt;") != std::string::npos);
  CHECK(drawing.find("a &amp; b") != std::string::npos);
}

TEST_CASE("a polyline is written in relative moves without drift") {
  SvgCanvas canvas(100, 50, "t", "d");
  canvas.polyline({{0.04, 0}, {0.08, 10}, {0.12, 10}}, {"var(--ink)", 1});
  CHECK(canvas.str().find("d=\"M0 0l0.1 10l0 0\"") != std::string::npos);
}

TEST_CASE("a file of its own knows no CSS variables") {
  SvgCanvas canvas(100, 50, "t", "d");
  for (const ThemeColour& colour : theme_colours) {
    canvas.rectangle({0, 0, 1, 1}, "var(--" + std::string(colour.name) + ")");
  }
  const std::string file = standalone_svg({canvas}, 1);
  CHECK(file.starts_with("<?xml"));
  CHECK(file.find("var(") == std::string::npos);
  CHECK(file.find("#d55e00") != std::string::npos);
}

}  // namespace greenloop::offline
