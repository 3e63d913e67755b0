#include "rt_tests/bench/multigrid_figures.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>

#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::bench {
namespace {

using offline::LegendEntry;
using offline::Point;
namespace paint = offline::paint;

using Read = std::function<double(const MultigridFigures& figures, const SolverFigures& solver)>;

struct Curve {
  std::string name, paint;
  std::optional<SolverFigures> (*solver)(const MultigridFigures& figures);
};

const std::vector<Curve>& curves() {
  static const std::vector<Curve> all{
      {"multigrid", paint::blue, [](const MultigridFigures& f) { return std::optional(f.multigrid); }},
      {"GAMG", paint::orange, [](const MultigridFigures& f) { return f.gamg; }},
      {"diagonal", paint::vermilion, [](const MultigridFigures& f) { return f.diagonal; }}};
  return all;
}

std::vector<Point> points_of(const std::vector<MultigridFigures>& rows, const Curve& curve, const Read& x,
                             const Read& y) {
  std::vector<Point> points;
  for (const MultigridFigures& row : rows) {
    const auto solver = curve.solver(row);
    if (solver && solver->reached) points.push_back({x(row, *solver), y(row, *solver)});
  }
  return points;
}

offline::SvgCanvas panel(const std::string& title, const std::vector<MultigridFigures>& rows,
                         const std::string& x_label, const Read& x, const std::string& y_label,
                         const std::string& y_unit, const Read& y) {
  std::vector<LegendEntry> legend;
  std::vector<double> across, up;
  for (const Curve& curve : curves()) {
    const auto points = points_of(rows, curve, x, y);
    if (!points.empty()) legend.push_back({curve.name, {curve.paint, 2}});
    for (const Point& point : points) {
      across.push_back(point.x);
      up.push_back(point.y);
    }
  }
  const auto frame = offline::panel_frame(true, legend);
  offline::SvgCanvas canvas(offline::panel_width, frame.height, title, title, offline::panel_text);
  canvas.text({offline::panel_width / 2, 1.2 * offline::panel_text}, title,
              {.anchor = offline::Anchor::middle, .bold = true});
  offline::SvgPlot plot(canvas, frame.area, offline::logarithmic_axis(x_label, "", across),
                        offline::logarithmic_axis(y_label, y_unit, up));
  for (const Curve& curve : curves()) {
    const auto points = points_of(rows, curve, x, y);
    plot.curve(points, {curve.paint, 2});
    plot.dots(points, 3, curve.paint);
  }
  plot.legend(legend);
  return canvas;
}

std::vector<MultigridFigures> homogeneous(const std::vector<MultigridFigures>& all) {
  std::vector<MultigridFigures> rows;
  for (const auto& f : all) {
    if (f.problem == all.front().problem && f.poisson == all.front().poisson) rows.push_back(f);
  }
  return rows;
}

/// Balls of the size that most contrasts were measured at, the largest of equals.
std::vector<MultigridFigures> by_contrast(const std::vector<MultigridFigures>& all) {
  std::vector<MultigridFigures> most;
  for (const auto& of : all) {
    std::vector<MultigridFigures> rows;
    for (const auto& f : all) {
      if (f.problem == "stiff ball" && f.tetrahedra == of.tetrahedra) rows.push_back(f);
    }
    if (rows.size() >= most.size()) most = rows;
  }
  std::sort(most.begin(), most.end(), [](const auto& a, const auto& b) { return a.contrast < b.contrast; });
  return most;
}

}  // namespace

offline::Figure multigrid_figure(const std::vector<MultigridFigures>& all) {
  const Read tetrahedra = [](const MultigridFigures& f, const SolverFigures&) { return double(f.tetrahedra); };
  const Read contrast = [](const MultigridFigures& f, const SolverFigures&) { return f.contrast; };
  const Read time = [](const MultigridFigures&, const SolverFigures& s) { return s.seconds(); };
  const Read iterations = [](const MultigridFigures&, const SolverFigures& s) { return double(s.iterations); };
  const auto sizes = homogeneous(all), balls = by_contrast(all);
  return {
      "multigrid",
      "Time and iterations against size and stiffness",
      "Cubes of one material, and with a ball that is stiffer; set-up and solution to a true residual of 1e-5 on one "
      "thread.",
      {panel("one material", sizes, "tetrahedra", tetrahedra, "time", "s", time),
       panel("one material", sizes, "tetrahedra", tetrahedra, "iterations", "", iterations),
       panel("stiff ball", balls, "contrast", contrast, "time", "s", time),
       panel("stiff ball", balls, "contrast", contrast, "iterations", "", iterations)}};
}

}  // namespace greenloop::bench
