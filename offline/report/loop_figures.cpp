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

constexpr double left = 74, top = 40, plot_height = 210, figure_height = top + plot_height + 48;
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

Rectangle full_area() { return {left, top, figure_width - left - 20, plot_height}; }

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

std::string seconds(double time) { return readable(time) + "\u202fs"; }

}  // namespace

Figure force_figure(const std::vector<TraceCycle>& trace) {
  const auto total = over_time(trace, [](const TraceCycle& cycle) { return cycle.force; });
  const auto parts = force_series(trace);
  const bool components = parts.size() == 3 && parts[0].name.ends_with("component");
  const TraceCycle& strongest = trace[summarise(trace).strongest];
  const std::string caption =
      fmt::format("Force of the body on the {}. Largest: {} at {} on {} contact nodes.",
                  components || parts.size() < 2 ? "probe" : "probes, total being the sum of their magnitudes",
                  readable(strongest.force, 3) + "\u202fN", seconds(strongest.time), strongest.contacts);
  SvgCanvas canvas(figure_width, figure_height, "Force over time", caption);
  SvgPlot plot(canvas, full_area(), time_axis(trace), force_axis(total, parts));
  const Stroke total_stroke{paint::muted, 4, "", 0.5};
  plot.curve(total, total_stroke);
  std::vector<LegendEntry> legend{{components ? "magnitude" : "total", total_stroke}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Stroke stroke{series_paints[i % series_paints.size()], 1.2};
    plot.curve(parts[i].data, stroke);
    legend.push_back({parts[i].name, stroke});
  }
  plot.legend(legend);
  return {"force", "Force over time", caption, canvas.str()};
}

Figure work_figure(const std::vector<TraceCycle>& trace) {
  const TraceSummary summary = summarise(trace);
  const auto work = over_time(trace, [](const TraceCycle& cycle) { return cycle.work; });
  const auto budget = over_time(trace, [](const TraceCycle& cycle) { return cycle.budget; });
  std::vector<Point> misses;
  std::uint64_t largest = summary.worst_work;
  for (const TraceCycle& cycle : trace) {
    largest = std::max(largest, cycle.budget);
    if (cycle.missed()) misses.push_back({cycle.time, static_cast<double>(cycle.work)});
  }
  const std::string caption =
      fmt::format("Work of each cycle; one unit is one multiply-add. The dearest cycle took {} of its budget. {}",
                  readable_percent(summary.worst_share),
                  misses.empty() ? fmt::format("No miss in {} cycles.", readable_count(summary.cycles))
                                 : fmt::format("Crosses: {} of {} cycles missed (over budget or held).",
                                               readable_count(misses.size()), readable_count(summary.cycles)));
  SvgCanvas canvas(figure_width, figure_height, "Work per cycle against the budget", caption);
  SvgPlot plot(canvas, full_area(), time_axis(trace),
               axis_from_zero("work", summary.worst_work > 0 ? "units" : "", static_cast<double>(largest)));
  plot.area_below(work, paint::blue, 0.15);
  plot.curve(work, {paint::blue, 1.2});
  plot.steps(budget, {paint::ink, 1.6, "7 4"});
  std::vector<LegendEntry> legend{{"work of the cycle", {paint::blue, 2}}, {"budget", {paint::ink, 1.6, "7 4"}}};
  if (!misses.empty()) {
    plot.crosses(misses, paint::vermilion);
    legend.push_back({fmt::format("missed ({})", readable_count(misses.size())), {paint::vermilion}, true});
  }
  plot.legend(legend);
  return {"work", "Work per cycle against the budget", caption, canvas.str()};
}

Figure levels_figure(const std::vector<TraceCycle>& trace, std::size_t levels) {
  const TraceSummary summary = summarise(trace);
  std::size_t answered = 0, shown = std::max<std::size_t>(levels, summary.cycles_at_level.size());
  for (const std::size_t count : summary.cycles_at_level) answered += count;
  for (const TraceCycle& cycle : trace)
    shown = std::max<std::size_t>(shown, std::max(cycle.level, cycle.field_level) + 1);
  const std::string caption = fmt::format(
      "Level at which each cycle was resolved; {} is the finest. Right: share of the {} answered cycles in contact.",
      shown - 1, readable_count(answered));
  SvgCanvas canvas(figure_width, figure_height, "Levels used", caption);
  constexpr double histogram_width = 190;
  const Rectangle area{left, top, figure_width - left - histogram_width - 50, plot_height};
  const PlotAxis y{.label = "level", .min = -0.5, .max = static_cast<double>(shown) - 0.5, .whole = true};
  SvgPlot plot(canvas, area, time_axis(trace), y);
  const Stroke constraint{paint::blue, 1.5}, field{paint::orange, 3.6};
  plot.steps(over_time(trace, [](const TraceCycle& cycle) { return cycle.field_level; }), field);
  plot.steps(over_time(trace, [](const TraceCycle& cycle) { return cycle.level; }), constraint);
  plot.legend({{"constraint level", constraint}, {"field level", field}});

  // the histogram stands beside the curve, on the same rows
  const double x = area.right() + 24, room = histogram_width - 58;
  canvas.text({x, top - 12}, "cycles at constraint level");
  for (std::size_t level = 0; level < shown; ++level) {
    const double count =
        level < summary.cycles_at_level.size() ? static_cast<double>(summary.cycles_at_level[level]) : 0;
    const double share = answered > 0 ? count / static_cast<double>(answered) : 0;
    const double middle = plot.at(0, static_cast<double>(level)).y;
    const double thickness = std::min(0.6 * plot_height / static_cast<double>(shown), 30.0);
    canvas.rectangle({x, middle - thickness / 2, share * room, thickness}, paint::blue);
    canvas.text({x + share * room + 6, middle + 4}, readable_percent(share), {.paint = paint::muted, .size = 11.5});
  }
  canvas.line({x, top}, {x, top + plot_height}, {paint::rule, 1.2});
  return {"levels", "Levels used", caption, canvas.str()};
}

}  // namespace greenloop::offline
