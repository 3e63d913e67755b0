#include "offline/report/stability_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

#include "offline/report/axis.hpp"
#include "offline/report/csv_table.hpp"
#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

std::vector<Point> points_of(const std::vector<StabilityPoint>& points, double rate, bool stable) {
  std::vector<Point> data;
  for (const StabilityPoint& point : points) {
    if (point.rate == rate && point.stable == stable) data.push_back({point.delay, point.stiffness});
  }
  return data;
}

std::vector<Point> bound_of(const std::vector<StabilityPoint>& points, double rate) {
  std::vector<Point> data;
  for (const StabilityPoint& point : points) {
    const bool is_new = data.empty() || point.delay > data.back().x;
    if (point.rate == rate && is_new) data.push_back({point.delay, point.bound});
  }
  return data;
}

/// What all panels share.
struct Axes {
  PlotAxis delay, stiffness;
};

Axes axes_of(const std::vector<StabilityPoint>& points) {
  std::vector<double> values;
  double longest = 0;
  for (const StabilityPoint& point : points) {
    values.push_back(point.stiffness);
    values.push_back(point.bound);
    longest = std::max(longest, point.delay);
  }
  Axes axes{axis_from_zero("delay", "s", longest > 0 ? longest : 1e-3), logarithmic_axis("stiffness", "N/m", values)};
  axes.delay.min = -0.05 * axes.delay.max;
  return axes;
}

SvgCanvas panel(const std::vector<StabilityPoint>& points, double rate, const Axes& axes, const std::string& title,
                const std::string& caption) {
  const std::vector<LegendEntry> legend{
      {"comes to rest", {paint::blue}, true}, {"does not", {paint::vermilion}, true}, {"bound", {paint::ink, 1.6}}};
  const PanelFrame frame = panel_frame(true, legend);
  SvgCanvas canvas(panel_width, frame.height, title, caption, panel_text);
  canvas.text({panel_width / 2, 1.2 * panel_text}, readable(rate) + "\u202fHz",
              {.anchor = Anchor::middle, .bold = true});
  SvgPlot plot(canvas, frame.area, axes.delay, axes.stiffness);
  plot.curve(bound_of(points, rate), {paint::ink, 1.6});
  plot.dots(points_of(points, rate, true), 4, paint::blue);
  plot.dots(points_of(points, rate, false), 4, paint::vermilion);
  plot.legend(legend);
  return canvas;
}

}  // namespace

std::vector<StabilityPoint> load_stability(const std::filesystem::path& path) {
  const CsvTable table = CsvTable::load(path);
  const auto rate = table.numbers("rate"), delay = table.numbers("delay"), stiffness = table.numbers("stiffness"),
             bound = table.numbers("bound");
  const auto stable = table.counts("stable", 1);
  if (rate.empty()) throw std::runtime_error(path.string() + ": a stability map without a single loop");
  std::vector<StabilityPoint> points;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    if (!(rate[i] > 0 && stiffness[i] > 0 && bound[i] > 0 && delay[i] >= 0)) {
      throw std::runtime_error(
          fmt::format("{}: line {}: rate, stiffness and bound have to be above 0, the delay not "
                      "below it",
                      path.string(), i + 2));
    }
    points.push_back({rate[i], delay[i], stiffness[i], bound[i], stable[i] == 1});
  }
  return points;
}

Figure stability_figure(const std::vector<StabilityPoint>& points) {
  const std::string title = "Stability over stiffness, delay and rate";
  std::size_t within = 0, resting = 0, beyond = 0, resting_beyond = 0;
  std::set<double> rates;
  for (const StabilityPoint& point : points) {
    rates.insert(point.rate);
    const bool passive = point.stiffness <= point.bound;
    ++(passive ? within : beyond);
    if (point.stable) ++(passive ? resting : resting_beyond);
  }
  const std::string caption = fmt::format(
      "A device whose ball is pressed into the body and disturbed, at the stiffness that its handle feels. The line is "
      "the bound of Colgate and Schenkel, below which a loop is passive against any hand. Of {} loops below it {} come "
      "to rest, of {} above it {}.",
      within, resting, beyond, resting_beyond);
  Figure figure{"stability", title, caption, {}};
  const Axes axes = axes_of(points);
  for (const double rate : rates) figure.panels.push_back(panel(points, rate, axes, title, caption));
  return figure;
}

}  // namespace greenloop::offline
