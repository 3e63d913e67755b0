#include "offline/report/svg_plot.hpp"

#include <doctest/doctest.h>

#include <string>

#include "offline/report/figure.hpp"

namespace greenloop::offline {
namespace {

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("an axis from zero takes the prefix of its largest value") {
  const PlotAxis axis = axis_from_zero("force", "N", 0.0042);
  CHECK(axis.label == "force [mN]");
  CHECK(axis.unit == 1e-3);
  CHECK(axis.max > 0.0042);
  CHECK(axis_from_zero("force", "N", 0).max > 0);
  CHECK(axis_from_zero("work", "units", 2.5e6).label == "work [10⁶ units]");
  CHECK(logarithmic_axis("RMS error", "%", {0.01, 0.1}).unit == 0.01);
  CHECK(logarithmic_axis("size", "B", {2e5, 3e6}).label == "size [MB]");
}

TEST_CASE("data lands where the axes say") {
  SvgCanvas canvas(400, 300, "t", "d");
  const SvgPlot plot(canvas, {50, 20, 300, 200}, {.label = "x", .min = 0, .max = 10},
                     {.label = "y", .min = 1, .max = 100, .logarithmic = true});
  CHECK(plot.at(5, 10).x == doctest::Approx(200));
  CHECK(plot.at(5, 10).y == doctest::Approx(120));
  CHECK(plot.at(0, 1).y == doctest::Approx(220));
}

TEST_CASE("both axes are labelled and ticked in their unit") {
  SvgCanvas canvas(400, 300, "t", "d");
  const SvgPlot plot(canvas, {50, 20, 300, 200}, {.label = "time [s]", .min = 0, .max = 10},
                     {.label = "force [mN]", .min = 0, .max = 0.004, .unit = 1e-3});
  const std::string drawing = canvas.str();
  CHECK(drawing.find(">time [s]<") != std::string::npos);
  CHECK(drawing.find(">force [mN]<") != std::string::npos);
  CHECK(drawing.find(">3<") != std::string::npos);
}

TEST_CASE("a long trace stays small") {
  SvgCanvas canvas(800, 300, "t", "d");
  SvgPlot plot(canvas, {50, 20, 700, 200}, {.label = "x", .min = 0, .max = 60}, {.label = "y", .min = 0, .max = 1});
  std::vector<Point> data;
  data.reserve(60'000);
  for (int i = 0; i < 60'000; ++i) data.push_back({i * 1e-3, (i * 7919 % 1000) * 1e-3});
  plot.curve(data, {"var(--blue)", 1});
  CHECK(canvas.str().size() < 60'000);
}

TEST_CASE("crosses are thinned to one per pixel column") {
  SvgCanvas canvas(200, 100, "t", "d");
  SvgPlot plot(canvas, {0, 0, 100, 100}, {.label = "", .min = 0, .max = 1}, {.label = "", .min = 0, .max = 1});
  std::vector<Point> data;
  data.reserve(10'000);
  for (int i = 0; i < 10'000; ++i) data.push_back({i * 1e-4, 0.5});
  plot.crosses(data, "#123456");
  CHECK(occurrences(canvas.str(), "#123456") == 200);
}

TEST_CASE("bars are as long as their values, and the longest fills the area") {
  SvgCanvas canvas(400, 100, "t", "d");
  horizontal_bars(canvas, {100, 0, 200, 60},
                  {{"a", 2, "2", "#111111"}, {"b", 1, "1", "#222222"}, {"c", 0, "0", "#333333"}});
  const std::string drawing = canvas.str();
  const auto bar_width = [&](const std::string& fill) {
    const std::size_t end = drawing.find("fill=\"" + fill);
    const std::size_t at = drawing.rfind("width=\"", end);
    return std::stod(drawing.substr(at + 7));
  };
  CHECK(bar_width("#111111") == 200);
  CHECK(bar_width("#222222") == 100);
  CHECK(bar_width("#333333") == 0);
}

TEST_CASE("a legend that is too long for a row takes another, and the plot makes room for it") {
  const std::vector<LegendEntry> one{{"a", {"#111111"}}},
      many{{"a", {"#111111"}}, {"worst column", {"#222222"}}, {"worst patch force", {"#333333"}}};
  const PanelFrame low = panel_frame(false, one), high = panel_frame(false, many);
  CHECK(high.area.y > low.area.y + panel_text);
  CHECK(high.area.height == low.area.height);
  SvgCanvas canvas(panel_width, high.height, "t", "d", panel_text);
  SvgPlot plot(canvas, high.area, {.label = "x"}, {.label = "y"});
  plot.legend(many);
  const std::string drawing = canvas.str();
  const auto place = [&](const char* text, const char* axis) {
    const std::size_t at = drawing.rfind(axis, drawing.find(text));
    return std::stod(drawing.substr(at + 4));
  };
  CHECK(place(">a<", " y=\"") == place(">worst column<", " y=\""));
  CHECK(place(">worst patch force<", " y=\"") > place(">a<", " y=\"") + panel_text);
  CHECK(place(">worst patch force<", " y=\"") < high.area.y);
  CHECK(place(">a<", " y=\"") > panel_text);
  CHECK(place(">worst patch force<", " x=\"") + text_width("worst patch force", panel_text) < panel_width);
}

}  // namespace greenloop::offline
