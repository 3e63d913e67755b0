#include "offline/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "formats/output/output_file.hpp"
#include "formats/write/describe.hpp"
#include "offline/report/axis.hpp"
#include "offline/report/body_figures.hpp"
#include "offline/report/build_record.hpp"
#include "offline/report/level_frontiers.hpp"
#include "offline/report/load_figures.hpp"
#include "offline/report/loop_figures.hpp"
#include "offline/report/mask_figure.hpp"
#include "offline/report/model_facts.hpp"
#include "offline/report/model_figures.hpp"
#include "offline/report/model_surface.hpp"
#include "offline/report/pattern_figures.hpp"
#include "offline/report/stability_figure.hpp"
#include "offline/report/trace.hpp"
#include "offline/report/verdict.hpp"

namespace greenloop::offline {
namespace {

/// Everything that was read.
struct Material {
  const ModelView& model;
  ModelSurface surface;
  std::optional<std::vector<TraceCycle>> trace;
  std::optional<TraceSummary> summary;
  std::optional<std::vector<Eigen::Vector3d>> snapshot;
  std::optional<BuildRecord> build;
  std::vector<Figure> other_runs{};  ///< their forces
  std::optional<Figure> stability{};
};

// of greenloop-loop, which runs no other models
void require_run(const ModelView& model, const ReportInputs& inputs) {
  if (model.problem == layout::Problem::elastostatic) return;
  for (const auto& record : {inputs.trace, inputs.snapshot, inputs.stability}) {
    if (!record) continue;
    throw std::runtime_error(fmt::format("{}: a run of an elastostatic model, but {} is a {} one; leave it out",
                                         record->string(), inputs.model.string(), problem_name(model.problem)));
  }
}

// A record names the request that its model carries; those of earlier versions, only the length of the file.
void require_same_build(const BuildRecord& build, const ModelView& model, const ReportInputs& inputs) {
  const std::string request = text_in_json({model.provenance.data(), model.provenance.size()}, "request");
  const bool whole = model.levels == model.info->levels && model.ready.read == nullptr;
  const bool same = build.request.empty() || request.empty()
                        ? !whole || !build.model_bytes || *build.model_bytes == model.header->file_bytes
                        : build.request == request;
  if (same) return;
  throw std::runtime_error(
      fmt::format("{}: is the record of another model than {}", inputs.build->string(), inputs.model.string()));
}

void require_levels(const std::vector<TraceCycle>& trace, const ModelView& model, const std::filesystem::path& path) {
  for (const TraceCycle& cycle : trace) {
    if (std::max(cycle.level, cycle.field_level) < model.levels) continue;
    throw std::runtime_error(fmt::format("{}: level {} in a model of {}; is it the trace of another model?",
                                         path.string(), std::max(cycle.level, cycle.field_level), model.levels));
  }
}

Material read_material(const ModelView& model, const ReportInputs& inputs) {
  require_run(model, inputs);
  Material material{model, model_surface(model), {}, {}, {}, {}};
  if (inputs.trace) {
    material.trace = load_trace(*inputs.trace);
    require_levels(*material.trace, model, *inputs.trace);
    material.summary = summarise(*material.trace);
  }
  for (const auto& path : inputs.more_traces) {
    const auto trace = load_trace(path);
    require_levels(trace, model, path);
    material.other_runs.push_back(force_figure(trace, path.stem().string()));
  }
  if (inputs.stability) material.stability = stability_figure(load_stability(*inputs.stability));
  if (inputs.snapshot) material.snapshot = load_snapshot(*inputs.snapshot, model.node_count);
  if (inputs.build) {
    material.build = load_build_record(*inputs.build);
    require_same_build(*material.build, model, inputs);
  }
  return material;
}

/// The model in a line.
std::string summary_text(const Material& material) {
  const auto file = static_cast<double>(material.model.header->file_bytes);
  std::string text =
      fmt::format("{} surface nodes · {}, {}× smaller than dense", readable_count(material.model.node_count),
                  readable_bytes(file), readable(static_cast<double>(dense_bytes(material.model)) / file, 3));
  if (material.build && !material.build->scene.empty()) text += " · scene " + material.build->scene;
  return text;
}

/// How often each refusal occurred, in words; empty if none did.
std::string held_text(const std::vector<TraceCycle>& trace) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  for (const TraceCycle& cycle : trace) {
    if (!cycle.held()) continue;
    auto at =
        std::find_if(counts.begin(), counts.end(), [&](const auto& entry) { return entry.first == cycle.status; });
    if (at == counts.end()) at = counts.insert(counts.end(), {cycle.status, 0});
    ++at->second;
  }
  std::string text;
  for (const auto& [status, count] : counts) {
    text += fmt::format("{}{}: {}", text.empty() ? "Held cycles: " : ", ", status, readable_count(count));
  }
  return text.empty() ? text : text + ".";
}

/// Adds figures of one panel to the page, and to all figures.
void add_figures(std::vector<Figure> group, HtmlPage& page, std::vector<Figure>& figures) {
  page.figures(group);
  for (Figure& figure : group) figures.push_back(std::move(figure));
}

void add_figure(Figure figure, HtmlPage& page, std::vector<Figure>& figures) {
  page.figure(figure);
  figures.push_back(std::move(figure));
}

/// The deformed body if there is a snapshot; the meshes always.
std::vector<Figure> body_pictures(const Material& material) {
  const VisibleSurface finest = material.surface.level(material.surface.mesh.finest_level());
  if (!material.snapshot) return {mesh_figure(material.surface, choose_view(finest, {}))};
  const DrawnDisplacement drawn = drawn_displacement(finest.positions, *material.snapshot);
  const ViewFrame frame = choose_view(finest, drawn.magnified);
  const TraceCycle* cycle = material.trace ? &(*material.trace)[material.summary->strongest] : nullptr;
  return {body_figure(finest, drawn, frame, cycle), mesh_figure(material.surface, frame)};
}

void add_loads(const Material& material, HtmlPage& page, std::vector<Figure>& figures) {
  if (material.model.loads.empty()) return;
  page.begin_fold("What its loads do");
  add_figure(loads_figure(material.model, material.surface.level(material.surface.mesh.finest_level())), page, figures);
  page.end_fold();
}

void add_masks(const ModelFile& model, const Material& material, double radius, HtmlPage& page,
               std::vector<Figure>& figures) {
  page.begin_fold("How stiff it is to a fingertip");
  const VisibleSurface finest = material.surface.level(material.surface.mesh.finest_level());
  add_figure(masked_stiffness_figure(model, finest, radius), page, figures);
  page.end_fold();
}

void add_run(const Material& material, HtmlPage& page, std::vector<Figure>& figures) {
  if (!material.trace) return;
  page.heading("The run");
  add_figures({force_figure(*material.trace), work_figure(*material.trace),
               levels_figure(*material.trace, material.model.levels)},
              page, figures);
  const std::string held = held_text(*material.trace);
  if (!held.empty()) page.paragraph(held);
}

void add_other_runs(Material& material, HtmlPage& page, std::vector<Figure>& figures) {
  if (!material.other_runs.empty()) {
    page.heading("Other runs");
    add_figures(std::move(material.other_runs), page, figures);
  }
  if (material.stability) {
    page.heading("A hand in the loop");
    add_figure(*std::move(material.stability), page, figures);
  }
}

void add_errors(const Material& material, HtmlPage& page, std::vector<Figure>& figures) {
  page.begin_fold("Errors, level by level");
  page.table(
      level_table(material.model, material.summary),
      "Compression error of a level's compliance against the exact one; blocks and bytes of scales and couplings from "
      "level 0 up to it; patch force: worst relative error of the nodal forces that hold a sampled 64-node patch.");
  const auto errors = level_errors(material.model);
  if (has_level_errors(errors)) add_figure(level_errors_figure(errors), page, figures);
  if (has_patterns(material.model)) add_figure(patterns_figure(material.model), page, figures);
  const Table mesh = mesh_error_table(material.model);
  if (!mesh.rows.empty()) {
    page.table(
        mesh,
        "Mesh error: the forces of pressed patches, of linear tetrahedra over those of quadratic elements on the "
        "same tetrahedra, less 1; by place and direction, the worst first.");
  }
  page.end_fold();
}

void add_frontiers(const Material& material, HtmlPage& page, std::vector<Figure>& figures) {
  const bool frontier = material.build && has_frontier(*material.build);
  const bool by_level = material.build && has_level_frontiers(*material.build);
  if (!frontier && !by_level) return;
  page.begin_fold("Other thresholds: size and speed against error");
  if (frontier) add_figure(frontier_figure(*material.build), page, figures);
  if (by_level) add_figure(level_frontiers_figure(*material.build), page, figures);
  page.end_fold();
}

void add_size(const Material& material, HtmlPage& page, std::vector<Figure>& figures) {
  page.begin_fold("The model in numbers");
  page.facts(model_facts(material.model, material.surface));
  std::vector<Figure> bars{bytes_figure(bytes_by_kind(material.model))};
  if (material.build && !material.build->stages.empty()) bars.push_back(stages_figure(material.build->stages));
  add_figures(std::move(bars), page, figures);
  page.end_fold();
}

/// Provenance in the model, completed by the record of the build.
void add_provenance(const Material& material, HtmlPage& page) {
  auto groups = facts_of_json({material.model.provenance.data(), material.model.provenance.size()}, "provenance");
  if (material.build) merge_facts(groups, material.build->groups);
  if (groups.empty()) return;
  page.begin_fold("How it was built");
  page.facts(groups);
  page.end_fold();
}

std::vector<MissingInput> missing_inputs(const Material& material, const std::filesystem::path& model) {
  if (material.model.problem != layout::Problem::elastostatic) return {};  // nothing builds or runs others
  const std::string name = model.string();
  const std::string loop = fmt::format(
      "greenloop-loop {} --trace trace.csv --snapshot snapshot.csv\ngreenloop report {} --trace "
      "trace.csv --snapshot snapshot.csv",
      name, name);
  const std::string record = std::filesystem::path(model).replace_extension(".build.json").string();
  std::vector<MissingInput> missing;
  if (!material.snapshot) missing.push_back({"The deformed body: no --snapshot was given", loop});
  if (!material.trace) missing.push_back({"Force, work and levels over time: no --trace was given", loop});
  const std::string build =
      fmt::format("greenloop build scene.toml -o {}\ngreenloop report {} --build {}", name, name, record);
  if (!material.build) {
    missing.push_back({"Size and speed against error and the build's own figures: no --build was given", build});
  } else if (!has_frontier(*material.build)) {
    missing.push_back({"Size and speed against error: the build record has no frontier of bytes or work", build});
  }
  return missing;
}

}  // namespace

Report make_report(const ModelFile& model, const ReportInputs& inputs) {
  Material material = read_material(model.view, inputs);
  Report report;
  HtmlPage page(inputs.model.filename().string(), summary_text(material));
  page.verdict(verdict_of(model, material.build, material.summary));
  page.heading("The body");
  add_figures(body_pictures(material), page, report.figures);
  add_run(material, page, report.figures);
  add_other_runs(material, page, report.figures);
  page.heading("Details");
  add_loads(material, page, report.figures);
  if (inputs.mask) add_masks(model, material, *inputs.mask, page, report.figures);
  add_errors(material, page, report.figures);
  add_frontiers(material, page, report.figures);
  add_size(material, page, report.figures);
  if (inputs.provenance) add_provenance(material, page);
  report.missing = missing_inputs(material, inputs.model);
  page.missing(report.missing);
  report.html = page.str();
  return report;
}

std::filesystem::path figure_path(const std::filesystem::path& folder, const Figure& figure) {
  return folder / (figure.name + ".svg");
}

void write_figures(const std::filesystem::path& folder, const std::vector<Figure>& figures) {
  std::filesystem::create_directories(folder);
  for (const Figure& figure : figures)
    write_text_file(figure_path(folder, figure), standalone_svg(figure.panels, figure.columns));
}

}  // namespace greenloop::offline
