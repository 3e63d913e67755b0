#include "offline/figures/comparison_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

constexpr double left = 66, right = 16, top = 62, gap = 70, height = 230, bottom = 48;
constexpr double legend_top = 20, legend_row = 20;
constexpr const char* series_colours[] = {paint::blue,   paint::vermilion, paint::green,
                                          paint::orange, paint::purple,    paint::sky};

struct Curve {
  std::string name;
  Stroke stroke;
  std::vector<Point> data;
  bool dots = true;
};

struct Panel {
  std::string x, x_unit, y, y_unit;
  std::vector<Curve> curves;
  bool from_zero = false;  // else logarithmic
};

std::vector<Point> points_of(const std::vector<RatePoint>& points, RateQuantity x, RateQuantity y) {
  std::vector<Point> data;
  for (const RatePoint& point : points) {
    const Point at{point.*x, point.*y};
    if (at.x > 0 && at.y > 0 && std::isfinite(at.x) && std::isfinite(at.y)) data.push_back(at);
  }
  return data;
}

std::vector<double> values(const Panel& panel, double Point::*coordinate) {
  std::vector<double> all;
  for (const Curve& curve : panel.curves) {
    for (const Point& point : curve.data) all.push_back(point.*coordinate);
  }
  return all;
}

void draw_panel(SvgCanvas& canvas, const Rectangle& area, const Panel& panel) {
  const auto x = values(panel, &Point::x), y = values(panel, &Point::y);
  if (x.empty()) return;
  const auto axis = [&](const std::string& label, const std::string& unit, const std::vector<double>& all) {
    return panel.from_zero ? axis_from_zero(label, unit, *std::max_element(all.begin(), all.end()))
                           : logarithmic_axis(label, unit, all);
  };
  SvgPlot plot(canvas, area, axis(panel.x, panel.x_unit, x), axis(panel.y, panel.y_unit, y));
  for (const Curve& curve : panel.curves) {
    if (curve.stroke.width > 0) plot.curve(curve.data, curve.stroke);
    if (curve.dots) plot.dots(curve.data, 2.5, curve.stroke.paint);
  }
}

struct LegendPlace {
  double x, y;
};

// in as many rows as the curves' names take
std::vector<LegendPlace> place_legend(const std::vector<Curve>& curves) {
  std::vector<LegendPlace> places;
  LegendPlace next{left, legend_top};
  for (const Curve& curve : curves) {
    const double width = 46 + text_width(curve.name, 12);
    if (next.x > left && next.x + width > figure_width) next = {left, next.y + legend_row};
    places.push_back(next);
    next.x += width;
  }
  return places;
}

// one legend over all panels: they have the same curves
Figure panels_figure(const std::string& name, const std::string& title, const std::string& caption,
                     const std::vector<Panel>& panels) {
  const auto count = static_cast<double>(panels.size());
  const double width = (figure_width - left - right - gap * (count - 1)) / count;
  const std::vector<LegendPlace> legend = place_legend(panels.front().curves);
  const double panels_top = top + legend.back().y - legend_top;
  SvgCanvas canvas(figure_width, panels_top + height + bottom, title, caption);
  for (std::size_t i = 0; i < legend.size(); ++i) {
    const Curve& curve = panels.front().curves[i];
    canvas.line({legend[i].x, legend[i].y}, {legend[i].x + 20, legend[i].y}, curve.stroke);
    canvas.text({legend[i].x + 26, legend[i].y + 4}, curve.name, {.size = 12});
  }
  double x = left;
  for (const Panel& panel : panels) {
    draw_panel(canvas, {x, panels_top, width, height}, panel);
    x += width + gap;
  }
  return {name, title, caption, {canvas}};
}

std::vector<Curve> form_curves(const BodyComparison& body, RateQuantity x, RateQuantity y) {
  std::vector<Curve> curves;
  for (std::size_t i = 0; i < body.forms.size(); ++i) {
    const FormRates& form = body.forms[i];
    const char* colour = series_colours[i % std::size(series_colours)];
    curves.push_back({form.wavelet + ", one-sided", {colour, 1.5, "5 3"}, points_of(form.column.back().points, x, y)});
    curves.push_back({form.wavelet + ", two-sided", {colour, 1.8}, points_of(form.two_sided.back().points, x, y)});
  }
  return curves;
}

std::vector<Panel> error_panels(const BodyComparison& body, const std::string& label, const std::string& unit,
                                RateQuantity x) {
  return {{label, unit, "RMS error", "%", form_curves(body, x, &RatePoint::rms)},
          {label, unit, "MAX error", "%", form_curves(body, x, &RatePoint::worst_column)},
          {label, unit, "worst patch force error", "%", form_curves(body, x, &RatePoint::patch_force)}};
}

std::vector<Curve> level_curves(const std::vector<LevelRates>& levels, RateQuantity x) {
  std::vector<Curve> curves;
  for (const LevelRates& level : levels) {
    const char* colour = series_colours[level.level % std::size(series_colours)];
    curves.push_back(
        {fmt::format("level {}", level.level), {colour, 1.8}, points_of(level.points, x, &RatePoint::rms)});
  }
  return curves;
}

Panel cost_panel(const BodyComparison& body, const std::string& label, const std::string& unit,
                 double SummationPoint::*cost, const LineFit& fit) {
  Panel panel{.x = "blocks summed",
              .x_unit = "blocks",
              .y = label,
              .y_unit = unit,
              .curves = {{"measured", {paint::blue, 0}, {}}, {"fitted", {paint::ink, 1.2}, {}, false}},
              .from_zero = true};
  for (const SummationPoint& point : body.summation) {
    panel.curves[0].data.push_back({point.blocks, point.*cost});
    panel.curves[1].data.push_back({point.blocks, fit.intercept + fit.slope * point.blocks});
  }
  return panel;
}

}  // namespace

Figure error_over_ratio(const BodyComparison& body) {
  return panels_figure(body.name + "_error_over_ratio", fmt::format("Error against compression, {}", body.name),
                       "Blocks of the dense matrix over blocks kept. One-sided: the rule of James and Pai 2003; "
                       "two-sided: Greenloop's. Forces of patches that are not positive definite have no point.",
                       error_panels(body, "times fewer blocks", "", &RatePoint::ratio));
}

Figure error_over_threshold(const BodyComparison& body) {
  return panels_figure(body.name + "_error_over_threshold", fmt::format("Error against threshold, {}", body.name),
                       "One-sided: relative to the column's largest block; two-sided: relative to the coefficients' "
                       "conditional compliances.",
                       error_panels(body, "threshold", "%", &RatePoint::threshold));
}

Figure level_errors_over_ratio(const BodyComparison& body) {
  const FormRates& form = body.forms.back();
  return panels_figure(
      body.name + "_levels", fmt::format("RMS error of each constraint level, {}, {}", body.name, form.wavelet),
      "Left two: one-sided, Green's functions of each level's scaling functions, every free node's rows. Right: "
      "two-sided, averages of the level on both sides.",
      {{"times fewer blocks, one-sided", "", "RMS error", "%", level_curves(form.column, &RatePoint::ratio)},
       {"threshold, one-sided", "%", "RMS error", "%", level_curves(form.column, &RatePoint::threshold)},
       {"times fewer blocks, two-sided", "", "RMS error", "%", level_curves(form.two_sided, &RatePoint::ratio)}});
}

Figure summation_cost(const BodyComparison& body) {
  const SummationFit fit = fit_summation(body.summation);
  return panels_figure(body.name + "_summation", fmt::format("Cost of a step against blocks summed, {}", body.name),
                       fmt::format("Forces held and the whole field summed, one model per threshold of its field "
                                   "columns. The line explains {:.2f} % of the "
                                   "variance of the work and {:.2f} % of that of the processor time.",
                                   100 * fit.work.r_squared, 100 * fit.seconds.r_squared),
                       {cost_panel(body, "work of a step", "units", &SummationPoint::work, fit.work),
                        cost_panel(body, "processor time", "s", &SummationPoint::seconds, fit.seconds)});
}

Figure growth_figure(const std::vector<BodyComparison>& bodies) {
  Panel column{"RMS error", "%", "ratio of compressions, one-sided", "", {}};
  Panel two_sided{"RMS error", "%", "ratio of compressions, two-sided", "", {}};
  for (const Growth& step : growth(bodies)) {
    const std::string name = step.from + " to " + step.to;
    for (Panel* panel : {&column, &two_sided}) {
      if (panel->curves.empty() || panel->curves.back().name != name) {
        panel->curves.push_back({name, {series_colours[panel->curves.size() % std::size(series_colours)], 1.8}, {}});
      }
      const auto value = panel == &column ? step.column : step.two_sided;
      if (value) panel->curves.back().data.push_back({step.rms, *value});
    }
  }
  return panels_figure("growth", "Growth of compression with the number of vertices",
                       "How many times more a body compresses than the next smaller one at the same RMS error; 4 would "
                       "be blocks in proportion to vertices.",
                       {column, two_sided});
}

}  // namespace greenloop::offline
