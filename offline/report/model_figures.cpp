#include "offline/report/model_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "offline/report/axis.hpp"
#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

Figure bar_figure(const std::string& name, const std::string& title, const std::string& caption,
                  const std::vector<Bar>& bars) {
  const double height = 2.6 * panel_text * static_cast<double>(bars.size());
  SvgCanvas canvas(panel_width, height + 4, title, caption, panel_text);
  horizontal_bars(canvas, {8, 0, panel_width - 16, height}, bars);
  return {name, title, caption, {canvas}};
}

using Quantity = std::optional<double> FrontierPoint::*;

/// One panel of the frontier figure: a cost over an error.
struct Panel {
  std::string error;
  std::string cost;
  std::string unit;
  std::vector<FrontierPoint> points;
  std::vector<Point> data;
};

Panel panel(const BuildRecord& record, const std::string& error, Quantity error_of, const std::string& cost,
            const std::string& unit, Quantity cost_of) {
  Panel result{error, cost, unit, {}, {}};
  for (const FrontierPoint& point : record.frontier) {
    if (!(point.*error_of) || !(point.*cost_of)) continue;
    result.points.push_back(point);
    result.data.push_back({*(point.*error_of), *(point.*cost_of)});
  }
  return result;
}

std::vector<Panel> panels(const BuildRecord& record) {
  const char* force = "worst patch force error";
  const Quantity force_error = &FrontierPoint::worst_patch_force_error;
  std::vector<Panel> all{panel(record, "RMS error", &FrontierPoint::rms_error, "size", "B", &FrontierPoint::bytes),
                         panel(record, force, force_error, "size", "B", &FrontierPoint::bytes),
                         panel(record, force, force_error, "work of a step", "units", &FrontierPoint::step_work)};
  std::erase_if(all, [](const Panel& one) { return one.data.size() < 2; });
  return all;
}

bool chosen(const BuildRecord& record, const FrontierPoint& point) {
  return record.threshold && std::abs(point.threshold - *record.threshold) <= 1e-9 * std::abs(*record.threshold);
}

/// Rings the chosen point; names its threshold and that of others as far as their texts keep clear of each other.
void label_thresholds(SvgCanvas& canvas, const SvgPlot& plot, const Rectangle& area, const BuildRecord& record,
                      const Panel& panel) {
  constexpr double room = 5 * panel_text;
  std::vector<double> taken;
  const auto label = [&](std::size_t i, const std::string& colour, bool bold) {
    const Point at = plot.at(panel.data[i].x, panel.data[i].y);
    taken.push_back(at.x);
    canvas.text({at.x + 9, at.y - 7}, readable(panel.points[i].threshold, 2),
                {.paint = colour, .bold = bold, .halo = paint::page});
  };
  for (std::size_t i = 0; i < panel.data.size(); ++i) {
    if (!chosen(record, panel.points[i])) continue;
    const Point at = plot.at(panel.data[i].x, panel.data[i].y);
    canvas.circle(at, 6.5, paint::page, {paint::vermilion, 2.4});
    canvas.circle(at, 3, paint::vermilion);
    label(i, paint::ink, true);
  }
  for (std::size_t i = 0; i < panel.data.size(); ++i) {
    const double x = plot.at(panel.data[i].x, panel.data[i].y).x;
    const bool clear = std::none_of(taken.begin(), taken.end(), [&](double t) { return std::abs(t - x) < room; });
    if (clear && x < area.right() - 3 * panel_text) label(i, paint::muted, false);
  }
}

SvgCanvas drawn(const BuildRecord& record, const Panel& panel, const std::string& title, const std::string& caption) {
  std::vector<double> errors, costs;
  for (const Point& point : panel.data) {
    errors.push_back(point.x);
    costs.push_back(point.y);
  }
  std::vector<LegendEntry> legend{{"tried", {paint::blue, 2}}};
  if (std::any_of(panel.points.begin(), panel.points.end(),
                  [&](const FrontierPoint& point) { return chosen(record, point); })) {
    legend.push_back({"chosen", {paint::vermilion}, true});
  }
  const PanelFrame frame = panel_frame(false, legend);
  SvgCanvas canvas(panel_width, frame.height, title, caption, panel_text);
  SvgPlot plot(canvas, frame.area, logarithmic_axis(panel.error, "%", errors),
               logarithmic_axis(panel.cost, panel.unit, costs));
  std::vector<Point> by_error = panel.data;
  std::sort(by_error.begin(), by_error.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
  plot.curve(by_error, {paint::blue, 1.8});
  plot.dots(panel.data, 3.5, paint::blue);
  label_thresholds(canvas, plot, frame.area, record, panel);
  plot.legend(legend);
  return canvas;
}

/// One curve of the level figure; errors of zero have no place on its axis.
struct ErrorCurve {
  const char* name;
  const char* colour;
  std::vector<Point> data;
};

std::vector<ErrorCurve> error_curves(const std::vector<LevelErrors>& levels) {
  std::vector<ErrorCurve> curves{
      {"RMS", paint::blue, {}}, {"worst column", paint::green, {}}, {"worst patch force", paint::vermilion, {}}};
  for (const LevelErrors& level : levels) {
    const double values[] = {level.rms, level.worst_column, level.patch_force};
    for (std::size_t i = 0; i < curves.size(); ++i) {
      if (values[i] > 0) curves[i].data.push_back({static_cast<double>(level.level), values[i]});
    }
  }
  std::erase_if(curves, [](const ErrorCurve& curve) { return curve.data.empty(); });
  return curves;
}

}  // namespace

Figure bytes_figure(const std::vector<KindBytes>& kinds) {
  double total = 0;
  for (const KindBytes& kind : kinds) total += static_cast<double>(kind.bytes);
  std::vector<Bar> bars;
  for (const KindBytes& kind : kinds) {
    const auto bytes = static_cast<double>(kind.bytes);
    bars.push_back(
        {kind.name, bytes, fmt::format("{}, {}", readable_bytes(bytes), readable_percent(bytes / total)), paint::blue});
  }
  return bar_figure("bytes", "Where the bytes are",
                    fmt::format("The model file's {} by kind of section.", readable_bytes(total)), bars);
}

bool has_frontier(const BuildRecord& record) { return !panels(record).empty(); }

Figure frontier_figure(const BuildRecord& record) {
  const std::string title = "Size and speed against error";
  std::string caption =
      "Each point is the same set of Green's functions compressed with another threshold, which is written beside it, "
      "and measured against the exact columns. Down is cheaper, left is more exact.";
  if (record.patches) caption += fmt::format(" Patch forces: {} patches.", readable_count(*record.patches));
  if (record.threshold) caption += fmt::format(" This model: {}.", readable(*record.threshold, 3));
  Figure figure{"frontier", title, caption, {}};
  for (const Panel& one : panels(record)) figure.panels.push_back(drawn(record, one, title, caption));
  return figure;
}

bool has_level_errors(const std::vector<LevelErrors>& levels) { return !error_curves(levels).empty(); }

Figure level_errors_figure(const std::vector<LevelErrors>& levels) {
  const std::string title = "Compression error of each constraint level";
  const std::string caption =
      "The compliance of each constraint level against the exact one: all of it, its worst column, and the nodal "
      "forces "
      "that hold its worst patch.";
  const auto curves = error_curves(levels);
  std::vector<double> values;
  std::vector<LegendEntry> legend;
  for (const ErrorCurve& curve : curves) {
    for (const Point& point : curve.data) values.push_back(point.y);
    legend.push_back({curve.name, {curve.colour, 2}});
  }
  const PanelFrame frame = panel_frame(false, legend);
  SvgCanvas canvas(panel_width, frame.height, title, caption, panel_text);
  const PlotAxis across{
      .label = "constraint level", .min = levels.front().level - 0.3, .max = levels.back().level + 0.3, .whole = true};
  SvgPlot plot(canvas, frame.area, across, logarithmic_axis("error", "%", values));
  for (const ErrorCurve& curve : curves) {
    plot.curve(curve.data, {curve.colour, 1.8});
    plot.dots(curve.data, 3.5, curve.colour);
  }
  plot.legend(legend);
  return {"level_errors", title, caption, {canvas}};
}

Figure stages_figure(const std::vector<StageTime>& stages) {
  double total = 0;
  std::vector<Bar> bars;
  for (const StageTime& stage : stages) {
    total += stage.seconds;
    bars.push_back({stage.name, stage.seconds, readable(stage.seconds, 3) + "\u202fs", paint::green});
  }
  return bar_figure("stages", "Time to build",
                    fmt::format("Wall time of each stage, {}\u202fs in all.", readable(total, 3)), bars);
}

}  // namespace greenloop::offline
