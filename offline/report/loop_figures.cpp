#include "offline/report/loop_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "offline/report/axis.hpp"
#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

constexpr std::array<const char*, 4> series_paints{paint::blue, paint::vermilion, paint::green, paint::purple};

template <class Value>
std::vector<Point> over_time(const std::vector<TraceCycle>& trace, Value&& value) {
  std::vector<Point> curve;
  curve.reserve(trace.size());
  for (const TraceCycle& cycle : trace) curve.push_back({cycle.time, static_cast<double>(value(cycle))});
  return curve;
}

PlotAxis time_axis(const std::vector<TraceCycle>& trace) {
  const double begin = trace.front().time, last = trace.back().time;
  const double period = trace.size() > 1 ? (last - begin) / static_cast<double>(trace.size() - 1) : 1;
  return {.label = "time [s]", .min = begin, .max = last + period};
}

/// A plot over time in a panel of its own.
struct TimePlot {
  SvgCanvas canvas;
  Rectangle area;
};

TimePlot time_plot(const std::string& title, const std::string& caption, const std::vector<LegendEntry>& legend) {
  const PanelFrame frame = panel_frame(false, legend);
  return {SvgCanvas(panel_width, frame.height, title, caption, panel_text), frame.area};
}

bool pushes(const std::vector<TraceCycle>& trace, std::size_t probe) {
  return std::any_of(trace.begin(), trace.end(),
                     [&](const TraceCycle& cycle) { return cycle.probes[probe].force.norm() > 0; });
}

/// A curve with its name.
struct Series {
  std::string name;
  std::vector<Point> data;
};

std::vector<Series> force_series(const std::vector<TraceCycle>& trace) {
  std::vector<std::size_t> active;
  for (std::size_t p = 0; p < trace.front().probes.size(); ++p) {
    if (pushes(trace, p)) active.push_back(p);
  }
  std::vector<Series> series;
  if (active.size() == 1) {
    for (int axis = 0; axis < 3; ++axis) {
      series.push_back({fmt::format("{} component", "xyz"[axis]),
                        over_time(trace, [&](const TraceCycle& c) { return c.probes[active[0]].force[axis]; })});
    }
    return series;
  }
  for (const std::size_t p : active) {
    series.push_back({fmt::format("probe {}", p + 1),
                      over_time(trace, [p](const TraceCycle& c) { return c.probes[p].force.norm(); })});
  }
  return series;
}

PlotAxis force_axis(const std::vector<Point>& total, const std::vector<Series>& parts) {
  double lowest = 0, highest = 0;
  const auto include = [&](const std::vector<Point>& data) {
    for (const Point& point : data) {
      lowest = std::min(lowest, point.y);
      highest = std::max(highest, point.y);
    }
  };
  include(total);
  for (const Series& part : parts) include(part.data);
  PlotAxis axis = axis_from_zero("force", "N", std::max(highest, -lowest));
  axis.max = highest > 0 ? 1.06 * highest : axis.max;
  axis.min = 1.06 * lowest;
  return axis;
}

/// Linear from zero; logarithmic where the work is so small a part of the budget that it would lie on the axis.
PlotAxis work_axis(const std::vector<TraceCycle>& trace, const TraceSummary& summary) {
  constexpr double small_part = 0.2;
  std::uint64_t largest = summary.worst_work, least = std::max<std::uint64_t>(summary.worst_work, 1);
  for (const TraceCycle& cycle : trace) {
    largest = std::max(largest, cycle.budget);
    if (cycle.work > 0) least = std::min(least, cycle.work);
  }
  const auto most = static_cast<double>(largest);
  if (summary.worst_work == 0 || static_cast<double>(summary.worst_work) > small_part * most) {
    return axis_from_zero("work", summary.worst_work > 0 ? "units" : "", most);
  }
  return logarithmic_axis("work", "units", {static_cast<double>(least), most});
}

std::string seconds(double time) { return readable(time) + "\u202fs"; }

}  // namespace

Figure force_figure(const std::vector<TraceCycle>& trace, const std::string& run) {
  const std::string title = run.empty() ? "Force over time" : "Force over time: " + run;
  const auto total = over_time(trace, [](const TraceCycle& cycle) { return cycle.force; });
  const auto parts = force_series(trace);
  const bool components = parts.size() == 3 && parts[0].name.ends_with("component");
  const TraceCycle& strongest = trace[summarise(trace).strongest];
  const std::string caption =
      fmt::format("Force of the body on the {}. Largest: {} at {} on {} contact nodes.",
                  components || parts.size() < 2 ? "probe" : "probes, total being the sum of their magnitudes",
                  readable(strongest.force, 3) + "\u202fN", seconds(strongest.time), strongest.contacts);
  const Stroke total_stroke{paint::muted, 4, "", 0.5};
  std::vector<LegendEntry> legend{{components ? "magnitude" : "total", total_stroke}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    legend.push_back({parts[i].name, {series_paints[i % series_paints.size()], 1.2}});
  }
  TimePlot panel = time_plot(title, caption, legend);
  SvgPlot plot(panel.canvas, panel.area, time_axis(trace), force_axis(total, parts));
  plot.curve(total, total_stroke);
  for (std::size_t i = 0; i < parts.size(); ++i) plot.curve(parts[i].data, legend[i + 1].stroke);
  plot.legend(legend);
  return {run.empty() ? "force" : "force_" + run, title, caption, {panel.canvas}};
}

Figure work_figure(const std::vector<TraceCycle>& trace) {
  const TraceSummary summary = summarise(trace);
  const PlotAxis axis = work_axis(trace, summary);
  const auto work =
      over_time(trace, [&](const TraceCycle& cycle) { return std::max(static_cast<double>(cycle.work), axis.min); });
  const auto budget =
      over_time(trace, [&](const TraceCycle& cycle) { return std::max(static_cast<double>(cycle.budget), axis.min); });
  std::vector<Point> misses;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    if (trace[i].missed()) misses.push_back(work[i]);
  }
  const std::string caption = fmt::format(
      "Work of each cycle{}; a unit is an instruction at the default prices. The dearest cycle took {} of its budget. "
      "{}",
      axis.logarithmic ? ", on a logarithmic scale" : "", readable_percent(summary.worst_share),
      misses.empty() ? fmt::format("No miss in {} cycles.", readable_count(summary.cycles))
                     : fmt::format("Crosses: {} of {} cycles missed (over budget or held).",
                                   readable_count(misses.size()), readable_count(summary.cycles)));
  std::vector<LegendEntry> legend{{"work of the cycle", {paint::blue, 2}}, {"budget", {paint::ink, 1.6, "7 4"}}};
  if (!misses.empty()) {
    legend.push_back({fmt::format("missed ({})", readable_count(misses.size())), {paint::vermilion}, true});
  }
  TimePlot panel = time_plot("Work per cycle against the budget", caption, legend);
  SvgPlot plot(panel.canvas, panel.area, time_axis(trace), axis);
  plot.area_below(work, paint::blue, 0.15);
  plot.curve(work, {paint::blue, 1.2});
  plot.steps(budget, {paint::ink, 1.6, "7 4"});
  plot.crosses(misses, paint::vermilion);
  plot.legend(legend);
  return {"work", "Work per cycle against the budget", caption, {panel.canvas}};
}

Figure levels_figure(const std::vector<TraceCycle>& trace, std::size_t levels) {
  const TraceSummary summary = summarise(trace);
  std::size_t answered = 0, shown = std::max<std::size_t>(levels, summary.cycles_at_level.size());
  for (const std::size_t count : summary.cycles_at_level) answered += count;
  for (const TraceCycle& cycle : trace) {
    shown = std::max<std::size_t>(shown, std::max(cycle.level, cycle.field_level) + 1);
  }
  std::string shares;
  for (std::size_t level = summary.cycles_at_level.size(); level-- > 0 && answered > 0;) {
    const auto count = static_cast<double>(summary.cycles_at_level[level]);
    if (count > 0) {
      shares += fmt::format("{}{} at level {}", shares.empty() ? "" : ", ",
                            readable_percent(count / static_cast<double>(answered)), level);
    }
  }
  const std::string caption =
      fmt::format("Level at which each cycle was resolved; {} is the finest. Of the {} answered cycles in contact: {}.",
                  shown - 1, readable_count(answered), shares.empty() ? "none" : shares);
  const Stroke constraint{paint::blue, 1.5}, field{paint::orange, 3.6};
  const std::vector<LegendEntry> legend{{"constraint level", constraint}, {"field level", field}};
  TimePlot panel = time_plot("Levels used", caption, legend);
  const PlotAxis y{.label = "level", .min = -0.5, .max = static_cast<double>(shown) - 0.5, .whole = true};
  SvgPlot plot(panel.canvas, panel.area, time_axis(trace), y);
  plot.steps(over_time(trace, [](const TraceCycle& cycle) { return cycle.field_level; }), field);
  plot.steps(over_time(trace, [](const TraceCycle& cycle) { return cycle.level; }), constraint);
  plot.legend(legend);
  return {"levels", "Levels used", caption, {panel.canvas}};
}

}  // namespace greenloop::offline
