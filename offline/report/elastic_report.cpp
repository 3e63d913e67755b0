#include "offline/report/elastic_report.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "formats/write/aligned_bytes.hpp"
#include "offline/report/axis.hpp"
#include "offline/report/body_figures.hpp"
#include "offline/report/csv_table.hpp"
#include "offline/report/mesh_picture.hpp"
#include "offline/report/model_facts.hpp"
#include "offline/report/model_figures.hpp"
#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"
#include "runtime/multigrid.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

constexpr const char* nothing = "–";
constexpr Multigrid::Limits limits{.max_loads = 0, .max_holds = 0};

VisibleSurface surface_of(const MultigridView& view) {
  VisibleSurface surface;
  for (std::size_t v = 0; v < view.info->shown; ++v) {
    surface.positions.emplace_back(view.shape[3 * v], view.shape[3 * v + 1], view.shape[3 * v + 2]);
    // those that hang on fixed vertices alone do not move
    const layout::BindingRecord& binding = view.bindings[v];
    bool fixed = true;
    for (std::size_t k = 0; k < 4; ++k) fixed &= binding.weight[k] == 0 || binding.vertex[k] >= view.info->free;
    surface.fixed.push_back(fixed ? 1 : 0);
  }
  for (std::size_t t = 0; t < view.info->triangles; ++t) {
    const std::uint32_t* const corner = view.triangles + 3 * t;
    surface.triangles.push_back(
        {static_cast<int>(corner[0]), static_cast<int>(corner[1]), static_cast<int>(corner[2])});
  }
  return surface;
}

/// A body at rest, in memory of its own.
struct RestingBody {
  explicit RestingBody(const Model& model) : need(Multigrid::required(model, limits)), memory(need.bytes) {
    const auto created = Multigrid::create(model, limits, {memory.data(), memory.size()});
    if (!created) throw std::runtime_error("no body of this multigrid model");
    body = created.body;
  }

  Multigrid::Requirement need;
  AlignedBytes memory;
  Multigrid body;
};

/// The shown surface under the body's weight, and for how long.
struct Sag {
  std::vector<Vector3d> displacement;
  double seconds = 0;
};

Sag sag_of(const Model& model) {
  constexpr double shown_seconds = 2, most_units = 6e9;
  constexpr std::uint64_t cycles = 4;
  const MultigridView& view = model.view().multigrid;
  RestingBody resting(model);
  const Budget budget{resting.need.least_work + resting.need.shown_work + cycles * resting.need.cycle_work};
  const double steps = std::min(shown_seconds / view.info->time_step, most_units / static_cast<double>(budget.work));
  std::vector<Vec3> shown(view.info->shown);
  Sag sag;
  for (double i = 0; i < std::max(1.0, steps); i += 1) {
    static_cast<void>(resting.body.step({}, budget, {.shown = shown}));
    sag.seconds += view.info->time_step;
  }
  for (const Vec3& u : shown) sag.displacement.emplace_back(u.x, u.y, u.z);
  return sag;
}

/// A little from the side, upwards against gravity.
ViewFrame frame_of(const MultigridView& view, const VisibleSurface& surface) {
  const float* const g = view.info->gravity;
  const Vector3d down(static_cast<double>(g[0]), static_cast<double>(g[1]), static_cast<double>(g[2]));
  const ViewFrame facing = choose_view(surface, {});
  const Vector3d up = down.norm() > 0 ? Vector3d(-down.normalized()) : facing.up;
  Vector3d low = surface.positions.front(), high = low;
  for (const Vector3d& p : surface.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  // across the longest horizontal side
  Vector3d sides = high - low;
  for (Eigen::Index k = 0; k < 3; ++k) sides[k] *= std::abs(up[k]) > 0.7 ? 0 : 1;
  Eigen::Index longest = 0;
  sides.maxCoeff(&longest);
  const Vector3d along = Vector3d::Unit(longest), across = up.cross(along);
  return view_frame(across + 0.5 * along + 0.35 * up, up);
}

/// Of each shown vertex, 0 where it hangs on the softest matter to 1 on the stiffest, evenly in the logarithm.
std::vector<float> stiffness_of(const MultigridView& view) {
  double least = std::log(static_cast<double>(view.matters[0].mu)), most = least;
  std::vector<double> vertex(view.info->vertices, -1e300);
  for (const layout::TetrahedronRecord& tetrahedron : view.tetrahedra) {
    const double mu = std::log(static_cast<double>(view.matters[tetrahedron.matter].mu));
    least = std::min(least, mu);
    most = std::max(most, mu);
    for (const std::uint32_t v : tetrahedron.vertex) vertex[v] = std::max(vertex[v], mu);
  }
  std::vector<float> stiffness;
  for (const layout::BindingRecord& binding : view.bindings) {
    double mean = 0;
    for (std::size_t k = 0; k < 4; ++k) mean += static_cast<double>(binding.weight[k]) * vertex[binding.vertex[k]];
    stiffness.push_back(most > least ? static_cast<float>((mean - least) / (most - least)) : 0.0F);
  }
  return stiffness;
}

Figure materials_figure(const MultigridView& view, const VisibleSurface& surface, const ViewFrame& frame) {
  constexpr double height = 330;
  const std::string title = "The body and its materials";
  std::string caption = "The surface that is shown, at rest; the darker, the stiffer. Shear moduli: ";
  for (std::uint32_t m = 0; m < view.info->matters; ++m) {
    const auto mu = static_cast<double>(view.matters[m].mu);
    const SiPrefix prefix = si_prefix(mu);
    caption += fmt::format("{}{}\u202f{}Pa", m == 0 ? "" : ", ", readable(mu / prefix.factor, 3), prefix.symbol);
  }
  const std::vector<Vector3d> rest(surface.positions.size(), Vector3d::Zero());
  const Picture picture = deformed_picture(surface, rest, stiffness_of(view), frame, 800);
  SvgCanvas canvas(panel_width, height, title, caption, panel_text);
  const double shrink = std::min((panel_width - 40) / picture.image.width, (height - 20) / picture.image.height);
  const double width = shrink * picture.image.width, tall = shrink * picture.image.height;
  canvas.image({(panel_width - width) / 2, (height - tall) / 2, width, tall}, png_data_uri(picture.image));
  return {"materials", title, caption + ".", {canvas}};
}

Figure displaced_figure(const std::string& name, const std::string& title, const VisibleSurface& surface,
                        const std::vector<Vector3d>& displacement, const ViewFrame& frame) {
  Figure figure = body_figure(surface, drawn_displacement(surface.positions, displacement), frame, nullptr);
  figure.name = name;
  figure.title = title;
  return figure;
}

/// Residuals of the first step from rest under the body's weight, by its cycles.
std::vector<Point> convergence_of(const Model& model) {
  constexpr std::uint64_t most_cycles = 16;
  std::vector<Point> points;
  points.reserve(most_cycles);
  for (std::uint64_t cycles = 1; cycles <= most_cycles; ++cycles) {
    RestingBody resting(model);
    const Budget budget{resting.need.least_work + (cycles - 1) * resting.need.cycle_work};
    const auto report = resting.body.step({}, budget, {});
    const Point point{static_cast<double>(report.cycles), static_cast<double>(report.residual)};
    if (point.y > 0 && (points.empty() || point.x > points.back().x)) points.push_back(point);
  }
  return points;
}

Figure convergence_figure(const std::vector<Point>& points) {
  const std::string title = "Residual against cycles";
  const std::string caption =
      "Of the first step from rest under the body's weight: forces out of balance, relative, by multigrid cycles.";
  Figure figure{"convergence", title, caption, {}};
  if (points.empty()) return figure;
  std::vector<double> residuals;
  residuals.reserve(points.size());
  for (const Point& point : points) residuals.push_back(point.y);
  const PanelFrame frame = panel_frame(false, {});
  SvgCanvas canvas(panel_width, frame.height, title, caption, panel_text);
  SvgPlot plot(canvas, frame.area, {.label = "cycles", .min = 0, .max = points.back().x + 0.5, .whole = true},
               logarithmic_axis("residual", "%", residuals));
  plot.curve(points, {paint::blue, 2});
  plot.dots(points, 4, paint::blue);
  figure.panels.push_back(canvas);
  return figure;
}

Table grid_table(const MultigridView& view) {
  Table table{{"grid", "vertices", "tetrahedra", "blocks", "parents"}, {}};
  for (std::uint32_t g = 0; g < view.info->grids; ++g) {
    const bool coarsest = g + 1 == view.info->grids;
    const std::uint32_t vertices = coarsest ? view.info->coarsest_vertices : view.grid[g].vertices;
    table.rows.push_back({g == 0     ? "finest"
                          : coarsest ? "coarsest"
                                     : fmt::format("{}", g),
                          readable_count(vertices), g == 0 ? readable_count(view.info->tetrahedra) : nothing,
                          coarsest ? "factor" : readable_count(view.grid[g].columns.size()),
                          coarsest ? nothing : readable_count(view.grid[g].parents.size())});
  }
  return table;
}

std::vector<FactGroup> elastic_facts(const MultigridView& view) {
  constexpr const char* strains[] = {"linear", "corotational", "Green's"};
  const layout::MultigridInfo& info = *view.info;
  return {{"Body",
           {{"tetrahedra", readable_count(info.tetrahedra)},
            {"vertices", readable_count(info.vertices)},
            {"free vertices", readable_count(info.free)},
            {"shown vertices", readable_count(info.shown)},
            {"materials", readable_count(info.matters)}}},
          {"Motion",
           {{"strain", strains[info.strain]},
            {"time step", readable(info.time_step * 1e3) + "\u202fms"},
            {"mass damping", readable(static_cast<double>(info.mass_damping)) + "\u202f1/s"},
            {"stiffness damping", readable(static_cast<double>(info.stiffness_damping) * 1e3) + "\u202fms"},
            {"numerical damping", readable(static_cast<double>(info.numerical_damping))}}}};
}

/// Cycles of greenloop-loop --script drag --trace.
struct DragTrace {
  std::vector<double> time, force, displacement, residual;
  std::size_t misses = 0;
  double worst_share = 0;
};

DragTrace load_drag_trace(const std::filesystem::path& path) {
  const CsvTable table = CsvTable::load(path);
  DragTrace trace{
      table.numbers("time"), table.numbers("force"), table.numbers("displacement"), table.numbers("residual"), 0, 0};
  if (trace.time.empty()) throw std::runtime_error(path.string() + ": there is no cycle in it");
  const auto work = table.numbers("work"), budget = table.numbers("budget");
  const auto status = table.texts("status");
  for (std::size_t i = 0; i < work.size(); ++i) {
    trace.misses += work[i] > budget[i] || status[i] == "held_over_budget" ? 1 : 0;
    if (budget[i] > 0) trace.worst_share = std::max(trace.worst_share, work[i] / budget[i]);
  }
  return trace;
}

std::vector<Vector3d> load_dragged(const std::filesystem::path& path, std::size_t shown) {
  const CsvTable table = CsvTable::load(path);
  const auto x = table.numbers("x"), y = table.numbers("y"), z = table.numbers("z");
  if (x.size() != shown) {
    throw std::runtime_error(fmt::format("{}: {} vertices, but the model shows {}; take a snapshot of this model",
                                         path.string(), x.size(), shown));
  }
  std::vector<Vector3d> displacement;
  for (std::size_t v = 0; v < shown; ++v) displacement.emplace_back(x[v], y[v], z[v]);
  return displacement;
}

Figure run_figure(const DragTrace& trace, const std::string& name, const std::string& title, const std::string& caption,
                  const std::vector<double>& values, const PlotAxis& axis) {
  const PanelFrame frame = panel_frame(false, {});
  SvgCanvas canvas(panel_width, frame.height, title, caption, panel_text);
  SvgPlot plot(
      canvas, frame.area,
      {.label = "time [s]", .min = trace.time.front(), .max = std::max(trace.time.back(), trace.time.front() + 1e-3)},
      axis);
  std::vector<Point> points;
  for (std::size_t i = 0; i < values.size(); ++i) points.push_back({trace.time[i], values[i]});
  plot.curve(points, {paint::blue, 2});
  return {name, title, caption, {canvas}};
}

std::vector<Figure> run_figures(const DragTrace& trace) {
  const auto largest = [](const std::vector<double>& values) {
    return *std::max_element(values.begin(), values.end());
  };
  return {run_figure(trace, "force", "Force of the tool", "0 where it has let go.", trace.force,
                     axis_from_zero("force", "N", largest(trace.force))),
          run_figure(trace, "displacement", "Largest displacement", "Of any vertex, from rest.", trace.displacement,
                     axis_from_zero("displacement", "m", largest(trace.displacement)))};
}

Verdict elastic_verdict(const ModelFile& file, const Model& model, const std::optional<DragTrace>& trace) {
  const Multigrid::Requirement need = Multigrid::required(model, {});
  Verdict verdict;
  verdict.rows = {{"work of a step with one cycle, units", nothing, readable_count(need.least_work)},
                  {"of each cycle more", nothing, readable_count(need.cycle_work)},
                  {"RAM of a body", nothing, readable_bytes(static_cast<double>(need.bytes))},
                  {"file", nothing, readable_bytes(static_cast<double>(file.bytes.size()))}};
  verdict.sentence = "What was asked is not in the file; this is what a step takes.";
  if (!trace) return verdict;
  verdict.good = trace->misses == 0;
  verdict.sentence = trace->misses == 0 ? "The run held its budget in every cycle." : "The run missed its budget.";
  verdict.rows.push_back({"missed cycles of the run", "0",
                          fmt::format("{} of {}", readable_count(trace->misses), readable_count(trace->time.size())),
                          verdict.good});
  verdict.rows.push_back({"its dearest cycle, of the budget", "100\u202f%", readable_percent(trace->worst_share)});
  return verdict;
}

void require_inputs(const ReportInputs& inputs) {
  for (const auto& other : {inputs.build, inputs.stability}) {
    if (!other) continue;
    throw std::runtime_error(fmt::format("{}: of an elastostatic model, but {} is a multigrid model; leave it out",
                                         other->string(), inputs.model.string()));
  }
  if (inputs.mask || !inputs.more_traces.empty()) {
    throw std::runtime_error(inputs.model.string() + ": a multigrid model has no masks, and one trace");
  }
}

}  // namespace

Report make_elastic_report(const ModelFile& file, const ReportInputs& inputs) {
  require_inputs(inputs);
  const Model model = Model::open(file.bytes.span()).model;
  const MultigridView& view = model.view().multigrid;
  std::optional<DragTrace> trace;
  if (inputs.trace) trace = load_drag_trace(*inputs.trace);
  const VisibleSurface surface = surface_of(view);
  const ViewFrame frame = frame_of(view, surface);
  Report report;
  HtmlPage page(inputs.model.filename().string(),
                fmt::format("{} tetrahedra · {} vertices · {} grids · {}", readable_count(view.info->tetrahedra),
                            readable_count(view.info->vertices), view.info->grids,
                            readable_bytes(static_cast<double>(file.bytes.size()))));
  const auto add = [&](std::vector<Figure> group) {
    std::erase_if(group, [](const Figure& figure) { return figure.panels.empty(); });
    page.figures(group);
    for (Figure& figure : group) report.figures.push_back(std::move(figure));
  };
  page.verdict(elastic_verdict(file, model, trace));
  page.heading("The body");
  const Sag sag = sag_of(model);
  add({materials_figure(view, surface, frame),
       displaced_figure("sag", fmt::format("After {}\u202fs under its weight", readable(sag.seconds, 3)), surface,
                        sag.displacement, frame)});
  if (trace || inputs.snapshot) page.heading("The run");
  if (inputs.snapshot) {
    add({displaced_figure("dragged", "When the tool pulled most", surface,
                          load_dragged(*inputs.snapshot, view.info->shown), frame)});
  }
  if (trace) add(run_figures(*trace));
  page.heading("The solver");
  add({convergence_figure(convergence_of(model)), bytes_figure(bytes_by_kind(file.view))});
  page.table(grid_table(view), "Grids, finest first: blocks of 3 × 3 beside the diagonal, and weights to the next.");
  page.begin_fold("The model in numbers");
  page.facts(elastic_facts(view));
  page.end_fold();
  if (inputs.provenance) {
    page.begin_fold("How it was built");
    page.facts(facts_of_json({file.view.provenance.data(), file.view.provenance.size()}, "provenance"));
    page.end_fold();
  }
  if (!trace || !inputs.snapshot) {
    const std::string name = inputs.model.string();
    report.missing = {{"The body as a tool drags it: --trace and --snapshot were not both given",
                       fmt::format("greenloop-loop {} --script drag --trace trace.csv --snapshot snapshot.csv\n"
                                   "greenloop report {} --trace trace.csv --snapshot snapshot.csv",
                                   name, name)}};
  }
  page.missing(report.missing);
  report.html = page.str();
  return report;
}

}  // namespace greenloop::offline
