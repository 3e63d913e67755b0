#include "offline/report/svg_plot.hpp"

#include <doctest/doctest.h>

#include <string>

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

TEST_CASE("bars are as long as their values, and the longest leaves room for its text") {
  SvgCanvas canvas(400, 100, "t", "d");
  horizontal_bars(canvas, {100, 0, 200, 60},
                  {{"a", 2, "2", "#111111"}, {"b", 1, "1", "#222222"}, {"c", 0, "0", "#333333"}});
  const std::string drawing = canvas.str();
  const double room = text_width("2", 12) + 10;
  const auto bar_width = [&](const std::string& fill) {
    const std::size_t end = drawing.find("fill=\"" + fill);
    const std::size_t at = drawing.rfind("width=\"", end);
    return std::stod(drawing.substr(at + 7));
  };
  CHECK(bar_width("#111111") == doctest::Approx(200 - room).epsilon(0.01));
  CHECK(bar_width("#222222") == doctest::Approx((200 - room) / 2).epsilon(0.01));
  CHECK(bar_width("#333333") == 0);
}

}  // namespace greenloop::offline
