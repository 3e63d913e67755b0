#include "offline/report/motion_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "formats/write/aligned_bytes.hpp"
#include "offline/report/axis.hpp"
#include "offline/report/body_figures.hpp"
#include "offline/report/csv_table.hpp"
#include "offline/report/evening_light.hpp"
#include "offline/report/mesh_picture.hpp"
#include "offline/report/model_facts.hpp"
#include "offline/report/model_figures.hpp"
#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"
#include "runtime/impulse_response.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::json;

constexpr const char* nothing = "–";

VisibleSurface surface_of(const ImpulseResponseView& view) {
  VisibleSurface surface;
  for (std::size_t v = 0; v < view.info->vertices; ++v) {
    surface.positions.emplace_back(view.shape[3 * v], view.shape[3 * v + 1], view.shape[3 * v + 2]);
  }
  for (std::size_t t = 0; t < view.info->triangles; ++t) {
    const std::uint32_t* const corner = view.triangles + 3 * t;
    surface.triangles.push_back(
        {static_cast<int>(corner[0]), static_cast<int>(corner[1]), static_cast<int>(corner[2])});
  }
  surface.fixed.assign(surface.positions.size(), 0);
  return surface;
}

/// What an impulse does from rest, when most is displaced.
struct Swing {
  std::uint32_t impulse = 0;
  int steps = 0;  ///< from the impulse on
  std::vector<Vector3d> displacement;
};

/// A body at rest, in memory of its own.
struct RestingBody {
  explicit RestingBody(const Model& model) : need(ImpulseResponse::required(model, {})), memory(need.bytes) {
    const auto created = ImpulseResponse::create(model, {}, {memory.data(), memory.size()});
    if (!created) throw std::runtime_error("no body of motions for this model");
    body = created.body;
  }

  ImpulseResponse::Requirement need;
  AlignedBytes memory;
  ImpulseResponse body;
};

Swing swing_of(const Model& model, std::uint32_t impulse) {
  constexpr double shown_seconds = 2;
  const ImpulseResponseView& view = model.view().impulse_response;
  const auto rate = static_cast<double>(view.info->rate);
  RestingBody resting(model);
  std::vector<Vec3> moved(view.info->vertices), most_moved(moved.size());
  Swing swing{.impulse = impulse, .displacement = {}};
  double most = -1;
  for (int i = 0; i < std::max(1, static_cast<int>(shown_seconds * rate)); ++i) {
    const std::uint32_t now = i == 0 ? impulse : ImpulseResponse::no_impulse;
    if (!answered(resting.body.step(now, {resting.need.worst_work}, {{}, {}, moved, {}, {}}).status)) return swing;
    double sum = 0;
    for (const Vec3& u : moved) sum += static_cast<double>(u.x * u.x + u.y * u.y + u.z * u.z);
    if (sum <= most) continue;
    most = sum;
    most_moved = moved;
    swing.steps = i + 1;
  }
  for (const Vec3& u : most_moved) swing.displacement.emplace_back(u.x, u.y, u.z);
  return swing;
}

/// The radiance of all vertices when a swing is at its largest.
std::vector<Vec3> radiance_of(const Model& model, const Swing& swing, const Light& light) {
  RestingBody resting(model);
  std::vector<Vec3> colour(model.view().impulse_response.info->vertices);
  for (int i = 0; i < swing.steps; ++i) {
    const std::uint32_t now = i == 0 ? swing.impulse : ImpulseResponse::no_impulse;
    static_cast<void>(resting.body.step(now, {resting.need.worst_work}, {.colour = colour, .light = &light}));
  }
  return colour;
}

/// What pictures of swings have in common.
struct ShownSwings {
  VisibleSurface surface;
  std::vector<Swing> swings;  ///< of each impulse that may follow rest, four at most
  ViewFrame frame;
  double largest = 0;  ///< m
};

SvgCanvas picture_panel(const ImpulseResponseView& view, const Swing& swing, const Picture& picture) {
  constexpr double height = 330, key = 1.6 * panel_text;
  const std::string impulse = view.impulses[swing.impulse].name;
  const double seconds = swing.steps / static_cast<double>(view.info->rate);
  const std::string text = fmt::format("{}, {}\u202fs later", impulse, readable(seconds, 3));
  SvgCanvas canvas(panel_width, height + 1.5 * key, "After " + impulse, text, panel_text);
  const double shrink = std::min((panel_width - 40) / picture.image.width, (height - 20) / picture.image.height);
  const double width = shrink * picture.image.width, tall = shrink * picture.image.height;
  canvas.image({(panel_width - width) / 2, (height - tall) / 2, width, tall}, png_data_uri(picture.image));
  canvas.text({panel_width / 2, height + key}, text, {.anchor = Anchor::middle, .bold = true});
  return canvas;
}

ShownSwings shown_swings(const Model& model) {
  constexpr std::size_t most_frames = 4;
  const ImpulseResponseView& view = model.view().impulse_response;
  ShownSwings shown{surface_of(view), {}, {}, 0};
  for (std::uint32_t i = 0; i < view.info->impulses && shown.swings.size() < most_frames; ++i) {
    Swing swing = swing_of(model, i);
    if (swing.displacement.empty()) continue;
    for (const Vector3d& u : swing.displacement) shown.largest = std::max(shown.largest, u.norm());
    shown.swings.push_back(std::move(swing));
  }
  if (shown.swings.empty()) return shown;
  // a little from the side: what moves towards the viewer is not seen to move
  const ViewFrame facing = choose_view(shown.surface, shown.swings.front().displacement);
  shown.frame = view_frame(facing.towards + 0.7 * facing.right + 0.5 * facing.up, facing.up);
  return shown;
}

Figure frames_figure(const ImpulseResponseView& view, const ShownSwings& shown) {
  const SiPrefix prefix = si_prefix(shown.largest);
  Figure figure{"frames",
                "What the impulses do",
                fmt::format("Each from rest, when most is displaced, at true scale and by all {} modes; the outline is "
                            "the scene at rest. Coloured by displacement, the largest {}\u202f{}m.",
                            view.modes, readable(shown.largest / prefix.factor, 3), prefix.symbol),
                {}};
  for (const Swing& swing : shown.swings) {
    std::vector<float> value;
    for (const Vector3d& u : swing.displacement)
      value.push_back(shown.largest > 0 ? static_cast<float>(u.norm() / shown.largest) : 0.0F);
    const Picture picture = deformed_picture(shown.surface, swing.displacement, value, shown.frame, 800);
    figure.panels.push_back(picture_panel(view, swing, picture));
  }
  return figure;
}

/// The same in light, of a model with an appearance.
Figure light_figure(const Model& model, const ShownSwings& shown) {
  const ImpulseResponseView& view = model.view().impulse_response;
  Figure figure{
      "light",
      "In the evening sun",
      fmt::format("The colours that a step answers, by all {} modes of the light on {} states: a low sun from "
                  "the upper left and the sky, with shadows and the colours that parts give one another.",
                  view.appearance.modes, readable_count(view.info->transfer_states)),
      {}};
  if (view.appearance.modes == 0) return figure;
  const Light light = evening_light(shown.frame);
  for (const Swing& swing : shown.swings) {
    const auto colours = displayed(radiance_of(model, swing, light));
    const Picture picture = coloured_picture(shown.surface, swing.displacement, colours, shown.frame, 800);
    figure.panels.push_back(picture_panel(view, swing, picture));
  }
  return figure;
}

Figure rank_figure(const ImpulseResponseView& view) {
  std::vector<Point> data;
  std::vector<double> errors;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (std::uint32_t m = 0; m < view.group[q].counts->modes; ++m) {
      const auto error = static_cast<double>(view.group[q].amplitudes[m].truncation_error);
      if (error <= 0) continue;
      data.push_back({static_cast<double>(data.size() + 1), error});
      errors.push_back(error);
    }
  }
  const std::string title = "Error against modes";
  const std::string caption =
      "Truncation error of displacements by so many modes, relative, root mean square over all states; dots where a "
      "level of the file ends.";
  Figure figure{"rank", title, caption, {}};
  if (data.empty()) return figure;
  const PanelFrame frame = panel_frame(false, {});
  SvgCanvas canvas(panel_width, frame.height, title, caption, panel_text);
  SvgPlot plot(canvas, frame.area,
               {.label = "modes", .min = 0, .max = static_cast<double>(data.size()) + 0.5, .whole = true},
               logarithmic_axis("truncation error", "%", errors));
  plot.curve(data, {paint::blue, 2});
  std::vector<Point> ends;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const std::uint32_t end = view.group[q].counts->mode_end;
    if (end > 0 && end <= data.size()) ends.push_back(data[end - 1]);
  }
  plot.dots(ends, 4, paint::blue);
  figure.panels.push_back(canvas);
  return figure;
}

double frame_bytes(const layout::ImpulseInfo& info) { return 12.0 * info.vertices; }

Figure size_figure(const ModelView& model) {
  const layout::ImpulseInfo& info = *model.impulse_response.info;
  const auto file = static_cast<double>(model.header->file_bytes);
  const double frames = frame_bytes(info) * static_cast<double>(info.source_rows), texture = frames / 2;
  const auto text = [&](double bytes) {
    return fmt::format("{}, {}×", readable_bytes(bytes), readable(bytes / file, 3));
  };
  const std::vector<Bar> bars{{"this model", file, readable_bytes(file), paint::blue},
                              {"16-bit vertex animation texture", texture, text(texture), paint::rule},
                              {"frames as float32", frames, text(frames), paint::rule}};
  const std::string title = "Size against the frames it stands for";
  const std::string caption =
      fmt::format("{} states of {} vertices.", readable_count(info.source_rows), readable_count(info.vertices));
  const double height = 2.6 * panel_text * static_cast<double>(bars.size());
  SvgCanvas canvas(panel_width, height + 4, title, caption, panel_text);
  horizontal_bars(canvas, {8, 0, panel_width - 16, height}, bars);
  return {"size", title, caption, {canvas}};
}

Table impulse_table(const ImpulseResponseView& view) {
  Table table{{"impulse", "orbits", "median distance", "worst distance", "may follow itself"}, {}};
  for (std::uint32_t i = 0; i < view.info->impulses; ++i) {
    std::vector<float> distances;
    for (std::uint32_t row = 0; row < view.info->rows; ++row) {
      const auto& reference = view.references[std::size_t{row} * view.info->impulses + i];
      if (reference.orbit != layout::none) distances.push_back(reference.distance);
    }
    std::sort(distances.begin(), distances.end());
    const auto length = [&](std::size_t at) {
      if (distances.empty()) return std::string(nothing);
      const auto value = static_cast<double>(distances[at]);
      const SiPrefix prefix = si_prefix(value);
      return fmt::format("{}\u202f{}m", readable(value / prefix.factor, 3), prefix.symbol);
    };
    const auto orbits = std::count_if(view.orbits.begin(), view.orbits.end(),
                                      [&](const layout::OrbitRecord& orbit) { return orbit.impulse == i; });
    const bool again = view.successions[std::size_t{i} * view.info->impulses + i] != 0;
    table.rows.push_back({view.impulses[i].name, readable_count(static_cast<unsigned long long>(orbits)),
                          length(distances.size() / 2), length(distances.empty() ? 0 : distances.size() - 1),
                          again ? "yes" : "no"});
  }
  return table;
}

std::vector<FactGroup> motion_facts(const ImpulseResponseView& view) {
  const layout::ImpulseInfo& info = *view.info;
  const auto rests = std::count_if(view.orbits.begin(), view.orbits.end(),
                                   [](const auto& orbit) { return orbit.next_orbit == layout::none; });
  return {{"Scene",
           {{"vertices", readable_count(info.vertices)},
            {"triangles", readable_count(info.triangles)},
            {"states simulated", readable_count(info.source_rows)},
            {"time step", readable(info.time_step * 1e3) + "\u202fms"}}},
          {"Model",
           {{"modes (rank)", fmt::format("{} of {}, {} bits", view.modes, info.modes, 8 * info.planes)},
            {"states", readable_count(info.rows)},
            {"orbits", fmt::format("{}, {} of them come to rest", readable_count(info.orbits), rests)},
            {"impulses", readable_count(info.impulses)},
            {"modes of light", view.appearance.modes == 0
                                   ? "none"
                                   : fmt::format("{} of {} states", view.appearance.modes, info.transfer_states)}}},
          {"Loop",
           {{"rate", readable(static_cast<double>(info.rate)) + "\u202fHz"},
            {"differences die out at", readable(static_cast<double>(info.blend_rate)) + "\u202f1/s"}}}};
}

/// Cycles of greenloop-loop --script impulses --trace.
struct MotionTrace {
  std::vector<double> time, position, blend;
  std::vector<std::string> status;
  std::vector<char> over;  ///< beyond its budget
  double worst_share = 0;

  [[nodiscard]] bool missed(std::size_t i) const { return over[i] != 0 || status[i] == "held_over_budget"; }
};

MotionTrace load_motion_trace(const std::filesystem::path& path) {
  const CsvTable table = CsvTable::load(path);
  MotionTrace trace{
      table.numbers("time"), table.numbers("position"), table.numbers("blend"), table.texts("status"), {}, 0};
  if (trace.time.empty()) throw std::runtime_error(path.string() + ": there is no cycle in it");
  const auto work = table.numbers("work"), budget = table.numbers("budget");
  for (std::size_t i = 0; i < work.size(); ++i) {
    trace.over.push_back(work[i] > budget[i] ? 1 : 0);
    if (budget[i] > 0) trace.worst_share = std::max(trace.worst_share, work[i] / budget[i]);
  }
  return trace;
}

Figure run_figure(const MotionTrace& trace) {
  const std::vector<LegendEntry> legend{{"displacement", {paint::blue, 2}},
                                        {"left of differences", {paint::vermilion, 2}},
                                        {"refused impulse", {paint::ink, 2}}};
  const std::string title = "The scene over time";
  const std::string caption =
      "Euclidean norms over the modes: of the displacement, and of what blending still adds to the orbit that is "
      "played.";
  const PanelFrame frame = panel_frame(false, legend);
  SvgCanvas canvas(panel_width, frame.height, title, caption, panel_text);
  double largest = 0;
  std::vector<Point> position, blend, refused;
  for (std::size_t i = 0; i < trace.time.size(); ++i) {
    largest = std::max({largest, trace.position[i], trace.blend[i]});
    position.push_back({trace.time[i], trace.position[i]});
    if (trace.status[i].starts_with("held")) {
      refused.push_back(position.back());
    } else {
      blend.push_back({trace.time[i], trace.blend[i]});
    }
  }
  SvgPlot plot(
      canvas, frame.area,
      {.label = "time [s]", .min = trace.time.front(), .max = std::max(trace.time.back(), trace.time.front() + 1e-3)},
      axis_from_zero("displacement", "m", largest));
  plot.curve(position, {paint::blue, 2});
  plot.curve(blend, {paint::vermilion, 2});
  plot.crosses(refused, paint::ink);
  plot.legend(legend);
  return {"run", title, caption, {canvas}};
}

Verdict motion_verdict(const ModelFile& file, const Model& model, const Json& provenance,
                       const std::optional<MotionTrace>& trace) {
  const ImpulseResponseView& view = model.view().impulse_response;
  const auto percent = [](float x) { return readable_percent(static_cast<double>(x)); };
  Verdict verdict;
  verdict.rows = {
      {"modes", nothing, fmt::format("{}", view.modes)},
      {"truncation error, RMS over all states", nothing, percent(view.group[view.levels - 1].counts->truncation_error)},
      {"quantisation error, RMS", nothing, percent(view.info->quantisation_error)}};
  if (view.appearance.modes > 0) {
    verdict.rows.push_back({"light on states that it was not computed for, of what varies, RMS", nothing,
                            percent(view.info->transfer_error)});
  }
  const Json replay = provenance.is_object() ? provenance.value("replay_error", Json()) : Json();
  const bool replayed = replay.is_object() && replay.value("median", Json()).is_number();
  verdict.rows.push_back({"replay error against the simulator, median of held-out orbits", nothing,
                          replayed ? readable_percent(replay["median"].get<double>()) : "no orbit was held out"});
  const ImpulseResponse::Requirement need = ImpulseResponse::required(model, {});
  verdict.rows.push_back({"work of a step, units: states, with all displacements", nothing,
                          fmt::format("{}, {}", readable_count(need.least_work), readable_count(need.frame_work))});
  verdict.rows.push_back({"RAM of a body", nothing, readable_bytes(static_cast<double>(need.bytes))});
  verdict.rows.push_back({"file", nothing, readable_bytes(static_cast<double>(file.bytes.size()))});
  verdict.sentence = "What was asked is not in the file; this is what is reached.";
  if (!trace) return verdict;
  std::size_t misses = 0;
  for (std::size_t i = 0; i < trace->time.size(); ++i) misses += trace->missed(i) ? 1 : 0;
  verdict.good = misses == 0;
  verdict.sentence = misses == 0 ? "The run held its budget in every cycle." : "The run missed its budget.";
  verdict.rows.push_back({"missed cycles of the run", "0",
                          fmt::format("{} of {}", readable_count(misses), readable_count(trace->time.size())),
                          verdict.good});
  verdict.rows.push_back({"its dearest cycle, of the budget", "100\u202f%", readable_percent(trace->worst_share)});
  return verdict;
}

void require_inputs(const ReportInputs& inputs) {
  for (const auto& other : {inputs.snapshot, inputs.build, inputs.stability}) {
    if (!other) continue;
    throw std::runtime_error(fmt::format("{}: of an elastostatic model, but {} is one of motions; leave it out",
                                         other->string(), inputs.model.string()));
  }
  if (inputs.mask || !inputs.more_traces.empty()) {
    throw std::runtime_error(inputs.model.string() + ": a model of motions has no masks, and one trace");
  }
}

}  // namespace

Report make_motion_report(const ModelFile& file, const ReportInputs& inputs) {
  require_inputs(inputs);
  const Model model = Model::open(file.bytes.span()).model;
  const ImpulseResponseView& view = model.view().impulse_response;
  const std::string text{file.view.provenance.data(), file.view.provenance.size()};
  const Json provenance = Json::parse(text, nullptr, false);
  std::optional<MotionTrace> trace;
  if (inputs.trace) trace = load_motion_trace(*inputs.trace);
  Report report;
  const auto add = [&](HtmlPage& page, std::vector<Figure> group) {
    std::erase_if(group, [](const Figure& figure) { return figure.panels.empty(); });
    page.figures(group);
    for (Figure& figure : group) report.figures.push_back(std::move(figure));
  };
  const auto bytes = static_cast<double>(file.bytes.size());
  const double frames = frame_bytes(*view.info) * static_cast<double>(view.info->source_rows);
  HtmlPage page(inputs.model.filename().string(),
                fmt::format("{} vertices · {} modes · {} orbits · {}, {}× smaller than its frames",
                            readable_count(view.info->vertices), view.modes, readable_count(view.info->orbits),
                            readable_bytes(bytes), readable(frames / bytes, 3)));
  page.verdict(motion_verdict(file, model, provenance, trace));
  page.heading("The motions");
  const ShownSwings shown = shown_swings(model);
  for (Figure pictures : {frames_figure(view, shown), light_figure(model, shown)}) {
    if (pictures.panels.empty()) continue;
    page.figure(pictures);
    report.figures.push_back(std::move(pictures));
  }
  if (trace) {
    page.heading("The run");
    add(page, {run_figure(*trace)});
  }
  page.heading("Details");
  add(page, {rank_figure(view), size_figure(file.view)});
  page.table(
      impulse_table(view),
      "Distances of states, by displacement and velocity, from the start of the orbit that an impulse leads to.");
  page.begin_fold("The model in numbers");
  page.facts(motion_facts(view));
  add(page, {bytes_figure(bytes_by_kind(file.view))});
  page.end_fold();
  if (inputs.provenance) {
    page.begin_fold("How it was built");
    page.facts(facts_of_json(text, "provenance"));
    page.end_fold();
  }
  if (!trace) {
    const std::string name = inputs.model.string();
    report.missing = {{"The scene over time: no --trace was given",
                       fmt::format("greenloop-loop {} --script impulses --trace trace.csv\ngreenloop report {} --trace "
                                   "trace.csv",
                                   name, name)}};
  }
  page.missing(report.missing);
  report.html = page.str();
  return report;
}

}  // namespace greenloop::offline
