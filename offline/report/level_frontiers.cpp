#include "offline/report/level_frontiers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "offline/report/axis.hpp"
#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

using Quantity = std::optional<double> LevelFrontierPoint::*;

struct ErrorKind {
  const char* name;
  const char* colour;
  Quantity value;
};
constexpr ErrorKind error_kinds[] = {
    {"RMS", paint::blue, &LevelFrontierPoint::rms_error},
    {"worst column", paint::green, &LevelFrontierPoint::worst_column_error},
    {"worst patch force", paint::vermilion, &LevelFrontierPoint::worst_patch_force_error}};

struct LevelPoints {
  std::vector<LevelFrontierPoint> points;  // by increasing threshold
  std::vector<bool> chosen;
};

std::map<unsigned, LevelPoints> by_level(const BuildRecord& record) {
  std::map<unsigned, LevelPoints> levels;
  for (const FrontierPoint& point : record.frontier) {
    const bool chosen =
        record.threshold && std::abs(point.threshold - *record.threshold) <= 1e-9 * std::abs(*record.threshold);
    for (const LevelFrontierPoint& level : point.levels) {
      levels[level.level].points.push_back(level);
      levels[level.level].chosen.push_back(chosen);
    }
  }
  std::erase_if(levels, [](const auto& entry) { return entry.second.points.size() < 2; });
  return levels;
}

/// One error's points and, of them, the chosen one.
struct Curve {
  std::vector<Point> data, chosen;
};

Curve curve_of(const LevelPoints& level, Quantity error, Quantity cost) {
  Curve curve;
  for (std::size_t i = 0; i < level.points.size(); ++i) {
    const auto x = level.points[i].*error, y = level.points[i].*cost;
    if (!x || !y) continue;
    curve.data.push_back({*x, *y});
    if (level.chosen[i]) curve.chosen.push_back({*x, *y});
  }
  return curve;
}

/// Nothing if there are too few points for a plot.
std::optional<SvgCanvas> panel(const std::string& heading, const std::string& caption, const LevelPoints& level,
                               const char* cost_name, const char* unit, Quantity cost) {
  std::vector<Curve> curves;
  std::vector<double> errors, costs;
  std::vector<LegendEntry> legend;
  for (const ErrorKind& kind : error_kinds) {
    curves.push_back(curve_of(level, kind.value, cost));
    legend.push_back({kind.name, {kind.colour, 2}});
    for (const Point& point : curves.back().data) {
      errors.push_back(point.x);
      costs.push_back(point.y);
    }
  }
  if (errors.size() < 2) return {};
  const PanelFrame frame = panel_frame(true, legend);
  SvgCanvas canvas(panel_width, frame.height, heading, caption, panel_text);
  canvas.text({frame.area.x, 1.2 * panel_text}, heading, {.bold = true});
  SvgPlot plot(canvas, frame.area, logarithmic_axis("error", "%", errors), logarithmic_axis(cost_name, unit, costs));
  for (std::size_t i = 0; i < curves.size(); ++i) {
    plot.curve(curves[i].data, {error_kinds[i].colour, 1.8});
    plot.dots(curves[i].data, 2.5, error_kinds[i].colour);
    plot.dots(curves[i].chosen, 6, paint::none, {paint::ink, 2});
  }
  plot.legend(legend);
  return canvas;
}

}  // namespace

bool has_level_frontiers(const BuildRecord& record) { return !by_level(record).empty(); }

Figure level_frontiers_figure(const BuildRecord& record) {
  const std::string title = "Size and speed against error, level by level";
  std::string caption =
      "The same trials on each constraint level: bytes of the model cut off after it, work of a step that is resolved "
      "there, over the errors of that level's compliance. The rings are this model, measured on all columns and "
      "patches; "
      "the other points are measured on a sample.";
  if (record.contacts) caption += fmt::format(" Work: {} contacts.", readable_count(*record.contacts));
  Figure figure{"level_frontiers", title, caption, {}};
  for (const auto& [number, level] : by_level(record)) {
    const std::string heading = fmt::format("constraint level {}", number);
    for (auto& one : {panel(heading, caption, level, "size", "B", &LevelFrontierPoint::bytes),
                      panel(heading, caption, level, "work of a step", "units", &LevelFrontierPoint::step_work)}) {
      if (one) figure.panels.push_back(*one);
    }
  }
  return figure;
}

}  // namespace greenloop::offline
