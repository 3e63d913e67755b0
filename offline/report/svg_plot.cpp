#include "offline/report/svg_plot.hpp"

#include <algorithm>
#include <cmath>

#include "offline/report/downsampling.hpp"
#include "offline/report/figure.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

std::string label_with_unit(const std::string& quantity, const std::string& unit) {
  return unit.empty() ? quantity : quantity + " [" + unit + "]";
}

/// A unit with its prefix; words take a power of ten instead.
std::string prefixed(const SiPrefix& prefix, const std::string& unit) {
  if (unit.size() <= 2) return prefix.symbol + unit;
  const std::string power = prefix.symbol == "k"   ? "10³ "
                            : prefix.symbol == "M" ? "10⁶ "
                            : prefix.symbol == "G" ? "10⁹ "
                                                   : "";
  return power + unit;
}

constexpr double legend_sample = 1.67;  // of a text's size

/// Where the entries stand from the legend's first, in rows no wider than `width`; y is that of the row.
std::vector<Point> legend_places(const std::vector<LegendEntry>& entries, double width, double em) {
  std::vector<Point> places;
  Point next;
  for (const LegendEntry& entry : entries) {
    const double needed = (legend_sample + 0.5) * em + text_width(entry.text, em);
    if (next.x > 0 && next.x + needed > width) next = {0, next.y + 1.5 * em};
    places.push_back(next);
    next.x += needed + 1.5 * em;
  }
  return places;
}

/// The prefix to show `largest` with; words are never divided.
SiPrefix prefix_for(const std::string& unit, double largest) {
  const SiPrefix prefix = si_prefix(largest);
  return unit.size() > 2 && prefix.factor < 1 ? SiPrefix{} : prefix;
}

}  // namespace

PlotAxis axis_from_zero(const std::string& quantity, const std::string& unit, double largest) {
  const SiPrefix prefix = prefix_for(unit, largest);
  return {.label = label_with_unit(quantity, prefixed(prefix, unit)),
          .min = 0,
          .max = largest > 0 ? 1.06 * largest : 1,
          .unit = prefix.factor};
}

PlotAxis logarithmic_axis(const std::string& quantity, const std::string& unit, const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double air = std::max(std::pow(*high / *low, 0.08), 1.15);
  const SiPrefix prefix = unit == "%" ? SiPrefix{0.01, ""} : prefix_for(unit, *high);
  return {.label = label_with_unit(quantity, prefixed(prefix, unit)),
          .min = *low / air,
          .max = *high * air,
          .logarithmic = true,
          .unit = prefix.factor};
}

SvgPlot::SvgPlot(SvgCanvas& canvas, const Rectangle& area, const PlotAxis& x, const PlotAxis& y)
    : canvas_(canvas), area_(area), x_{x.min, x.max, area.x, area.right(), x.logarithmic, x.whole}, y_{y.min,
                                                                                                       y.max,
                                                                                                       area.bottom(),
                                                                                                       area.y,
                                                                                                       y.logarithmic,
                                                                                                       y.whole} {
  draw_frame(x, y);
}

void SvgPlot::draw_frame(const PlotAxis& x, const PlotAxis& y) {
  const double em = canvas_.text_size(), tick_size = 0.96 * em;
  const Stroke grid{paint::grid, 1}, rule{paint::rule, 1};
  double widest = 0;
  for (const double tick : x_.ticks(static_cast<int>(area_.width / (6.7 * em)))) {
    canvas_.line({x_(tick), area_.y}, {x_(tick), area_.bottom()}, grid);
    canvas_.line({x_(tick), area_.bottom()}, {x_(tick), area_.bottom() + 4}, rule);
    canvas_.text({x_(tick), area_.bottom() + 1.42 * em}, readable(tick / x.unit),
                 {.paint = paint::muted, .size = tick_size, .anchor = Anchor::middle});
  }
  for (const double tick : y_.ticks(std::max(static_cast<int>(area_.height / (2.6 * em)), 2))) {
    const std::string text = readable(tick / y.unit);
    widest = std::max(widest, text_width(text, tick_size));
    canvas_.line({area_.x, y_(tick)}, {area_.right(), y_(tick)}, grid);
    canvas_.text({area_.x - 7, y_(tick) + em / 3}, text,
                 {.paint = paint::muted, .size = tick_size, .anchor = Anchor::end});
  }
  canvas_.line({area_.x, area_.bottom()}, {area_.right(), area_.bottom()}, {paint::rule, 1.2});
  canvas_.text({area_.x + area_.width / 2, area_.bottom() + 3 * em}, x.label, {.anchor = Anchor::middle});
  canvas_.text({area_.x - 7 - 1.1 * em - widest, area_.y + area_.height / 2}, y.label,
               {.anchor = Anchor::middle, .turn = -90});
}

std::vector<Point> SvgPlot::placed(const std::vector<Point>& data) const {
  std::vector<Point> pixels;
  pixels.reserve(data.size());
  for (const Point& point : data) pixels.push_back(at(point.x, point.y));
  return pixels;
}

void SvgPlot::curve(const std::vector<Point>& data, const Stroke& stroke) {
  canvas_.polyline(placed(downsample(data, static_cast<int>(area_.width))), stroke);
}

void SvgPlot::steps(const std::vector<Point>& data, const Stroke& stroke) {
  canvas_.polyline(placed(staircase(downsample(data, static_cast<int>(area_.width)))), stroke);
}

void SvgPlot::area_below(const std::vector<Point>& data, const std::string& fill, double opacity) {
  std::vector<Point> outline = placed(downsample(data, static_cast<int>(area_.width)));
  if (outline.empty()) return;
  outline.push_back({outline.back().x, area_.bottom()});
  outline.push_back({outline.front().x, area_.bottom()});
  canvas_.polygon(outline, fill, opacity);
}

void SvgPlot::dots(const std::vector<Point>& data, double radius, const std::string& fill, const Stroke& stroke) {
  for (const Point& point : placed(data)) canvas_.circle(point, radius, fill, stroke);
}

void SvgPlot::crosses(const std::vector<Point>& data, const std::string& paint) {
  constexpr double arm = 4;
  double last_column = -1;
  for (const Point& point : placed(data)) {
    if (std::floor(point.x) == last_column) continue;
    last_column = std::floor(point.x);
    canvas_.line({point.x - arm, point.y - arm}, {point.x + arm, point.y + arm}, {paint, 1.8});
    canvas_.line({point.x - arm, point.y + arm}, {point.x + arm, point.y - arm}, {paint, 1.8});
  }
}

void SvgPlot::legend(const std::vector<LegendEntry>& entries) {
  const double em = canvas_.text_size(), sample = legend_sample * em;
  const std::vector<Point> places = legend_places(entries, area_.width, em);
  const double first = area_.y - em - (places.empty() ? 0 : places.back().y);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const LegendEntry& entry = entries[i];
    const double x = area_.x + places[i].x, y = first + places[i].y;
    if (entry.marker) {
      canvas_.circle({x + sample / 2, y - em / 3}, 4, entry.stroke.paint);
    } else {
      canvas_.line({x, y - em / 3}, {x + sample, y - em / 3}, entry.stroke);
    }
    canvas_.text({x + sample + em / 2, y}, entry.text);
  }
}

PanelFrame panel_frame(bool heading, const std::vector<LegendEntry>& legend, double plot_height) {
  constexpr double em = panel_text, left = 5.4 * em, right = 0.9 * em;
  const double width = panel_width - left - right;
  const auto places = legend_places(legend, width, em);
  const double rows = places.empty() ? 0 : places.back().y + 1.6 * em;
  const double top = (heading ? 1.9 : 0.4) * em + rows + 0.6 * em;
  return {top + plot_height + 3.6 * em, {left, top, width, plot_height}};
}

void horizontal_bars(SvgCanvas& canvas, const Rectangle& area, const std::vector<Bar>& bars) {
  const double em = canvas.text_size(),
               pitch = area.height / static_cast<double>(std::max<std::size_t>(bars.size(), 1));
  double largest = 0;
  for (const Bar& bar : bars) largest = std::max(largest, bar.value);
  double top = area.y;
  for (const Bar& bar : bars) {
    const double length = largest > 0 ? bar.value / largest * area.width : 0;
    canvas.text({area.x, top + 1.1 * em}, bar.label);
    canvas.text({area.right(), top + 1.1 * em}, bar.value_text, {.paint = paint::muted, .anchor = Anchor::end});
    canvas.rectangle({area.x, top + 1.5 * em, std::max(length, bar.value > 0 ? 1.0 : 0.0), 0.6 * em}, bar.fill);
    top += pitch;
  }
}

}  // namespace greenloop::offline
