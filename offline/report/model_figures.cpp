#include "offline/report/model_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "offline/report/axis.hpp"
#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

constexpr double bar_pitch = 28, bar_labels = 190;

Figure bar_figure(const std::string& name, const std::string& title, const std::string& caption,
                  const std::vector<Bar>& bars) {
  const double height = bar_pitch * static_cast<double>(bars.size());
  SvgCanvas canvas(figure_width, height + 16, title, caption);
  horizontal_bars(canvas, {bar_labels, 8, figure_width - bar_labels - 20, height}, bars);
  return {name, title, caption, canvas.str()};
}

/// One panel of the error figure: a cost over the RMS error.
struct CostCurve {
  std::string quantity;
  std::string unit;
  std::vector<ErrorPoint> points;
  std::vector<double> costs;
};

CostCurve cost_curve(const BuildRecord& record, const std::string& quantity, const std::string& unit,
                     std::optional<double> ErrorPoint::*cost) {
  CostCurve curve{quantity, unit, {}, {}};
  for (const ErrorPoint& point : record.curve) {
    if (!(point.*cost) || !(*(point.*cost) > 0)) continue;
    curve.points.push_back(point);
    curve.costs.push_back(*(point.*cost));
  }
  return curve;
}

std::vector<CostCurve> cost_curves(const BuildRecord& record) {
  std::vector<CostCurve> curves{cost_curve(record, "work of the sum", "units", &ErrorPoint::sum_work),
                                cost_curve(record, "size", "B", &ErrorPoint::bytes)};
  std::erase_if(curves, [](const CostCurve& curve) { return curve.points.size() < 2; });
  return curves;
}

bool chosen(const BuildRecord& record, const ErrorPoint& point) {
  return record.epsilon && std::abs(point.epsilon - *record.epsilon) <= 1e-9 * std::abs(*record.epsilon);
}

/// Rings the chosen point; names its ε and that of others as far as their texts keep clear of each other.
void label_thresholds(SvgCanvas& canvas, const SvgPlot& plot, const Rectangle& area, const BuildRecord& record,
                      const std::vector<ErrorPoint>& points, const std::vector<Point>& data) {
  constexpr double room = 58;
  std::vector<double> taken;
  const auto label = [&](std::size_t i, const std::string& colour, bool bold) {
    const Point at = plot.at(data[i].x, data[i].y);
    taken.push_back(at.x);
    canvas.text({at.x + 9, at.y - 7}, fmt::format("ε = {}", readable(points[i].epsilon, 2)),
                {.paint = colour, .size = 11.5, .bold = bold});
  };
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (!chosen(record, points[i])) continue;
    const Point at = plot.at(data[i].x, data[i].y);
    canvas.circle(at, 6.5, paint::page, {paint::vermilion, 2.4});
    canvas.circle(at, 3, paint::vermilion);
    label(i, paint::ink, true);
  }
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double x = plot.at(data[i].x, data[i].y).x;
    const bool clear = std::none_of(taken.begin(), taken.end(), [&](double t) { return std::abs(t - x) < room; });
    if (clear && x < area.right() - 40) label(i, paint::muted, false);
  }
}

void draw_cost_curve(SvgCanvas& canvas, const Rectangle& area, const BuildRecord& record, const CostCurve& curve) {
  std::vector<double> errors;
  std::vector<Point> data;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    errors.push_back(curve.points[i].rms_error);
    data.push_back({errors.back(), curve.costs[i]});
  }
  SvgPlot plot(canvas, area, logarithmic_axis("RMS error", "%", errors),
               logarithmic_axis(curve.quantity, curve.unit, curve.costs));
  std::vector<Point> by_error = data;
  std::sort(by_error.begin(), by_error.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
  plot.curve(by_error, {paint::blue, 1.8});
  plot.dots(data, 3.5, paint::blue);
  label_thresholds(canvas, plot, area, record, curve.points, data);
  std::vector<LegendEntry> legend{{curve.quantity + " over ε", {paint::blue, 2}}};
  if (std::any_of(curve.points.begin(), curve.points.end(), [&](const ErrorPoint& p) { return chosen(record, p); })) {
    legend.push_back({"chosen", {paint::vermilion}, true});
  }
  plot.legend(legend);
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

bool has_error_curve(const BuildRecord& record) { return !cost_curves(record).empty(); }

Figure error_figure(const BuildRecord& record) {
  constexpr double left = 74, top = 40, gap = 100, height = 250;
  const auto curves = cost_curves(record);
  const double width = (figure_width - left - 20 - gap) / 2;
  std::string caption =
      "What the threshold ε buys: each point is the same set of Green's functions, compressed with another ε and "
      "measured "
      "against the exact columns. Down is cheaper, left is more exact.";
  if (record.curve_columns)
    caption += fmt::format(" Curve: {} sampled columns.", readable_count(*record.curve_columns));
  if (record.epsilon) caption += fmt::format(" This model: ε = {}.", readable(*record.epsilon, 3));
  SvgCanvas canvas(figure_width, top + height + 48, "Speed and size against error", caption);
  double x = left;
  for (const CostCurve& curve : curves) {
    draw_cost_curve(canvas, {x, top, curves.size() == 1 ? 2 * width + gap : width, height}, record, curve);
    x += width + gap;
  }
  return {"error", "Speed and size against error", caption, canvas.str()};
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
