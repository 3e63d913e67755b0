#include "offline/pipeline/build_model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "formats/layout.hpp"
#include "formats/store/green_store.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"
#include "formats/write/writer.hpp"
#include "offline/compress/model_builder.hpp"
#include "offline/compress/wavelet_choice.hpp"
#include "offline/pipeline/body_geometry.hpp"
#include "offline/pipeline/body_problem.hpp"
#include "offline/pipeline/store_room.hpp"
#include "offline/pipeline/vertex_map.hpp"
#include "offline/scene/fingerprint.hpp"
#include "offline/scene/scene.hpp"
#include "offline/solve/green_functions.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::offline {
namespace {

using nlohmann::json;

std::string request_fingerprint(const Scene& scene, const std::string& mesh) {
  return fingerprint(canonical_text(scene), fingerprint(mesh, fingerprint(pipeline_version))).hex();
}

/// The record of the last build if its model is still what `request` asks for.
json up_to_date_record(const BuildRequest& request, const std::string& wanted) {
  if (request.force || !std::filesystem::exists(request.model) ||
      !std::filesystem::exists(build_record_path(request.model))) {
    return {};
  }
  try {
    const auto model = open_model_file(request.model);
    const auto provenance = json::parse(model.view.provenance);
    if (provenance.value("request", "") != wanted) {
      return {};
    }
    return json::parse(read_text(build_record_path(request.model)));
  } catch (const std::exception&) {
    return {};  // a damaged leftover is simply built again
  }
}

/// The store of the scene's columns: the one on disk if it is that, else a new one with nothing solved.
GreenStore open_or_create_store(const BuildRequest& request, const Scene& scene, const std::string& columns,
                                ProgressBar& progress) {
  if (std::filesystem::exists(request.store)) {
    auto store = GreenStore::open(request.store, GreenStore::Access::kReadWrite);
    const auto missing = store.missing_columns().size();
    if (store.contents().fingerprint == columns) {
      require_store_room(request.store, static_cast<std::size_t>(store.row_count()), missing);
      return store;
    }
    const bool empty = missing == static_cast<std::size_t>(store.column_count());
    if (!request.overwrite_store && !empty) {
      throw std::runtime_error(
          fmt::format("{}: holds the Green's functions of another scene, mesh or version; name another file with "
                      "--store, or pass --overwrite-store to replace it",
                      request.store.string()));
    }
  }
  auto body = make_body_geometry(scene, progress);
  require_store_room(request.store, domain_size(body), domain_size(body));  // before the body is filled and solved
  return GreenStore::create(request.store, describe_problem(scene, std::move(body), columns, progress));
}

json solve_missing_columns(GreenStore& store, ProgressBar& progress) {
  progress.begin("solve");
  const auto missing = store.missing_columns().size();
  const auto report = solve_green_functions(store, [&](const SolveProgress& at) { progress.update(at.fraction); });
  progress.end(fmt::format("{} columns, {} of them from the store, asymmetry {:.1e}", store.column_count(),
                           static_cast<std::size_t>(store.column_count()) - missing, report.largest_asymmetry));
  return {{"columns", store.column_count()},
          {"columns_solved", report.columns_solved},
          {"rows", store.row_count()},
          {"unknowns", report.unknowns},
          {"factor_entries", report.factor_entries},
          {"factor_seconds", report.factor_seconds},
          {"solve_seconds", report.solve_seconds},
          {"largest_asymmetry", report.largest_asymmetry}};
}

/// Enough digits for a picture; records stand in model files.
double rounded(double error) { return std::stod(fmt::format("{:.4g}", std::min(error, 1e9))); }

/// What `of` comes to: bytes, errors and work.
template <class Tried>
json trial_record(const Tried& of, std::uint64_t step_work) {
  return {{"bytes", of.bytes},
          {"kept_blocks", of.blocks},
          {"rms_error", rounded(of.rms)},
          {"worst_column_error", rounded(of.worst_column)},
          {"worst_patch_force_error", rounded(of.patch_force)},
          {"step_work", step_work}};
}

/// What was tried, from fewer bytes to more, with the figures of every constraint level; those of trials that were not
/// chosen are measured on a sample of patches and columns.
json frontier(const CompressionReport& report) {
  json points = json::array();
  for (const auto& trial : report.frontier) {
    json point = trial_record(trial, trial.levels.back().step_work);
    const bool chosen = trial.encoding.threshold == report.encoding.threshold;
    point.update({{"threshold", trial.encoding.threshold},
                  {"quantum", trial.encoding.quantum},
                  {"chosen", chosen},
                  {"sampled", !chosen}});
    for (const auto& level : trial.levels) {
      point["levels"].push_back(trial_record(level, level.step_work));
      point["levels"].back()["level"] = level.level;
    }
    points.push_back(std::move(point));
  }
  return points;
}

/// What each wavelet would have cost, if they were compared.
json wavelet_comparison(const CompressionReport& report) {
  json wavelets = json::array();
  for (const auto& [wavelet, nodes, trial] : report.wavelets) {
    json record = {
        {"wavelet", wavelet_name(static_cast<std::uint32_t>(wavelet))}, {"nodes", nodes}, {"meets", trial.bytes > 0}};
    if (trial.bytes > 0) record.update(trial_record(trial, trial.step_work));
    wavelets.push_back(record);
  }
  return wavelets;
}

json compression_record(const CompressionReport& report, std::uint32_t contacts) {
  json levels = json::array();
  for (const auto& level : report.levels) {
    levels.push_back({{"level", level.level},
                      {"columns", level.nodes},
                      {"kept_blocks", level.kept_blocks},
                      {"dense_blocks", level.dense_blocks},
                      {"rms_error", level.rms_error},
                      {"worst_column_error", level.worst_column_error},
                      {"worst_patch_force_error", std::min(level.patch_force_error, 1e9)},
                      {"field_rms_error", level.field_rms_error},
                      {"field_column_error", level.field_column_error},
                      {"field_blocks", level.field.blocks},
                      {"longest_field_column", level.field.longest}});
  }
  return {{"threshold", report.encoding.threshold},
          {"quantum", report.encoding.quantum},
          {"lambda_min", report.lambda_min},
          {"patches", report.patches},
          {"dense_bytes", report.dense_bytes},
          {"frontier", frontier(report)},
          {"frontier_contacts", contacts},
          {"wavelets", wavelet_comparison(report)},
          {"constraint_levels", levels}};
}

/// Work units of a step resolved at each level: all contacts of the scene, with a fresh factor and the whole field.
std::vector<std::uint64_t> worst_step_work(std::span<const std::byte> bytes) {
  const auto opened = Model::open(bytes);
  if (!opened) {
    throw std::logic_error("compression: an encoded model does not open");
  }
  const auto need = Elastostatic::required(opened.model, Elastostatic::intended(opened.model).limits);
  return {need.worst_work, need.worst_work + opened.model.level_count()};
}

layout::Info scene_facts(const Scene& scene, const json& solve) {
  layout::Info facts{};
  facts.young = scene.material.young;
  facts.poisson = scene.material.poisson;
  facts.store_asymmetry = solve["largest_asymmetry"];
  facts.rate = static_cast<float>(scene.budget.rate);
  facts.max_contacts = static_cast<std::uint32_t>(scene.budget.contacts);
  facts.step_work = static_cast<std::uint64_t>(scene.budget.work.value_or(0));
  facts.coarsest_constraint_level = static_cast<std::uint32_t>(scene.coarsest_constraints);
  return facts;
}

BuiltModel compress(const Scene& scene, const GreenStore& store, const json& solve, const std::string& provenance,
                    ProgressBar& progress) {
  progress.begin("compress");
  const auto& contents = store.contents();
  const std::vector<std::uint32_t> flags(contents.flags.begin(), contents.flags.end());
  const std::vector<double> area(contents.area.data(), contents.area.data() + contents.area.size());
  const std::vector<std::size_t> column_nodes(contents.column_node.begin(), contents.column_node.end());
  const CompressionInput input{.mesh = contents.surface,
                               .flags = flags,
                               .area = area,
                               .column_nodes = column_nodes,
                               .columns =
                                   [&](std::size_t first, std::size_t count) {
                                     return store.read_columns(static_cast<int>(first), static_cast<int>(count));
                                   },
                               .accuracy = {.rms = scene.accuracy.rms,
                                            .worst_column = scene.accuracy.worst_column,
                                            .patch_force = scene.accuracy.patch_force,
                                            .field = scene.accuracy.field,
                                            .field_peak = scene.accuracy.field_peak,
                                            .field_rough = scene.accuracy.field_rough},
                               .wavelet = scene.wavelet.value_or(layout::Wavelet::lifted_linear),
                               .facts = scene_facts(scene, solve),
                               .provenance = provenance,
                               .step_work = worst_step_work};
  const Progress update = [&](double fraction, std::string_view stage) { progress.update(fraction, stage); };
  auto built = scene.wavelet ? build_model(input, update) : build_with_best_wavelet(input, update);
  const auto& finest = built.report.levels.back();
  progress.end(fmt::format("{} wavelets, {:.1f} times fewer blocks, field {:.2f} % RMS, worst patch force {:.1f} %",
                           wavelet_name(built.model.info.wavelet),
                           static_cast<double>(finest.dense_blocks) / static_cast<double>(finest.kept_blocks),
                           100 * finest.field_rms_error, 100 * finest.patch_force_error));
  return built;
}

/// Fills in the work per step where the scene leaves it open: enough for a fresh factor at the finest level. Refuses a
/// budget that could not hold the coarsest answer.
void settle_step_work(const Scene& scene, ModelData& model) {
  const AlignedBytes bytes(encode(model));
  const auto opened = Model::open(bytes.span());
  if (!opened) {
    throw std::runtime_error("the model just written does not verify; this is a defect of greenloop itself");
  }
  const auto need = Elastostatic::required(opened.model, Elastostatic::intended(opened.model).limits);
  if (!scene.budget.work) {
    model.info.step_work = need.worst_work[opened.model.level_count() - 1];
  } else if (model.info.step_work < need.least_work) {
    throw std::runtime_error(fmt::format(
        "[budget] work = {}: {} contacts need at least {} units at the coarsest level; raise work or lower contacts",
        model.info.step_work, model.info.max_contacts, need.least_work));
  }
}

}  // namespace

std::filesystem::path build_record_path(const std::filesystem::path& model) {
  return std::filesystem::path(model).replace_extension(".build.json");
}

json build_model_file(const BuildRequest& asked, ProgressBar& progress) {
  BuildRequest request = asked;
  const Scene scene = read_scene(request.scene);
  if (request.store.empty()) {
    request.store = scene.store.value_or(std::filesystem::path(request.model).replace_extension(".h5"));
  }
  const std::string mesh = read_text(scene.mesh.path);
  const std::string wanted = request_fingerprint(scene, mesh);
  if (auto record = up_to_date_record(request, wanted); !record.empty()) {
    record["up_to_date"] = true;
    return record;
  }

  auto store = open_or_create_store(request, scene, column_fingerprint(scene, mesh), progress);
  json record = json::parse(store.contents().provenance);
  record["scene"] = request.scene.filename().string();
  record["solve"] = solve_missing_columns(store, progress);

  json provenance = record;
  provenance["tool"] = pipeline_version;
  provenance["request"] = wanted;
  provenance["scene_text"] = canonical_text(scene);
  provenance["solve"].erase("factor_seconds");  // the model's bytes do not depend on the clock
  provenance["solve"].erase("solve_seconds");
  provenance["solve"].erase("columns_solved");
  auto built = compress(scene, store, record["solve"], provenance.dump(), progress);
  provenance["frontier"] = frontier(built.report);
  provenance["wavelets"] = wavelet_comparison(built.report);
  provenance["frontier_contacts"] = built.model.info.max_contacts;
  provenance["patches"] = built.report.patches;
  built.model.provenance = provenance.dump();
  if (scene.mesh.keep_vertex_map) built.model.vertices = vertex_map(scene.mesh, store.contents().surface);
  settle_step_work(scene, built.model);
  const auto bytes = encode(built.model);
  write_file(request.model, bytes);

  record["compression"] = compression_record(built.report, built.model.info.max_contacts);
  record["compression"]["wavelet"] = wavelet_name(built.model.info.wavelet);
  record["bytes"] = bytes.size();
  record["step_work"] = built.model.info.step_work;
  for (const auto& stage : progress.stages()) {
    record["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
  }
  const std::string text = record.dump(2) + "\n";
  write_file(build_record_path(request.model), {reinterpret_cast<const std::byte*>(text.data()),
                                                reinterpret_cast<const std::byte*>(text.data()) + text.size()});
  return record;
}

}  // namespace greenloop::offline
