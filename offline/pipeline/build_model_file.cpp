#include "offline/pipeline/build_model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "formats/layout.hpp"
#include "formats/output/json_text.hpp"
#include "formats/output/output_file.hpp"
#include "formats/store/green_store.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"
#include "formats/write/nested_json.hpp"
#include "formats/write/writer.hpp"
#include "offline/compress/encode/load_columns.hpp"
#include "offline/compress/encode/ready_model.hpp"
#include "offline/compress/model_builder.hpp"
#include "offline/compress/wavelet_choice.hpp"
#include "offline/pipeline/before_solving.hpp"
#include "offline/pipeline/body_geometry.hpp"
#include "offline/pipeline/body_problem.hpp"
#include "offline/pipeline/build_files.hpp"
#include "offline/pipeline/least_work.hpp"
#include "offline/pipeline/model_quality.hpp"
#include "offline/pipeline/scene_loads.hpp"
#include "offline/pipeline/stage_records.hpp"
#include "offline/pipeline/vertex_map.hpp"
#include "offline/scene/fingerprint.hpp"
#include "offline/scene/scene.hpp"
#include "offline/sources/fem/green_functions.hpp"
#include "offline/sources/fem/mesh_error.hpp"
#include "offline/sources/reciprocity.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/greenloop.h"

namespace greenloop::offline {
namespace {

using nlohmann::json;

// linear tetrahedra are too stiff by tens of per cent above (docs/solving.md)
constexpr double locking_poisson = 0.45;

std::string request_fingerprint(const Scene& scene, const std::string& mesh) {
  return fingerprint(canonical_text(scene), fingerprint(mesh, fingerprint(pipeline_version))).hex();
}

/// The record of the last build if its model is still what `request` asks for.
json up_to_date_record(const BuildRequest& request, const std::string& wanted) {
  std::error_code unreadable;
  if (request.force || is_passed_on(request) || !std::filesystem::exists(request.model, unreadable) ||
      !std::filesystem::exists(build_record_path(request.model), unreadable)) {
    return {};
  }
  try {
    const auto model = open_model_file(request.model);
    const auto provenance = json::parse(model.view.provenance);
    if (provenance.value("request", "") != wanted) {
      return {};
    }
    const std::string record = read_text(build_record_path(request.model));
    require_shallow(record, build_record_path(request.model).string());
    return json::parse(record);
  } catch (const std::exception&) {
    return {};  // a damaged leftover is simply built again
  }
}

/// The store on disk if it is that of the scene's columns; none if it may be replaced.
std::optional<GreenStore> open_store(const BuildRequest& request, const std::string& columns) {
  auto store = GreenStore::open(request.store, GreenStore::Access::kReadWrite);
  if (store.contents().fingerprint == columns) {
    if (request.overwrite_store) require_sound(store);
    return store;
  }
  const bool empty = store.missing_columns().size() == static_cast<std::size_t>(store.column_count());
  if (!request.overwrite_store && !empty) {
    throw std::runtime_error(
        fmt::format("{}: holds the Green's functions of another scene, mesh or version; name another file with "
                    "--store, or pass --overwrite-store to replace it",
                    request.store.string()));
  }
  return std::nullopt;
}

/// What is wrong with a store, with what there is to be done.
std::string with_remedy(const std::string& fault) {
  constexpr std::string_view option = "--overwrite-store";
  return fault.find(option) != std::string::npos ? fault : fmt::format("{}; pass {} to replace it", fault, option);
}

std::optional<GreenStore> kept_store(const BuildRequest& request, const std::string& columns) try {
  return open_store(request, columns);
} catch (const std::runtime_error& error) {
  throw std::runtime_error(with_remedy(error.what()));
}

std::optional<GreenStore> usable_store(const BuildRequest& request, const std::string& columns) {
  if (!std::filesystem::exists(request.store)) return std::nullopt;
  if (!request.overwrite_store) return kept_store(request, columns);
  GreenStore::require_free(request.store);
  try {
    return open_store(request, columns);
  } catch (const std::runtime_error&) {
    return std::nullopt;  // damaged, or no store at all
  }
}

/// The store of the scene's columns: the one on disk if it is that, else a new one with nothing solved.
GreenStore open_or_create_store(const BuildRequest& request, const Scene& scene, const std::string& columns,
                                ProgressBar& progress) {
  if (auto store = usable_store(request, columns)) {
    require_buildable(request, scene, *store, progress);
    return std::move(*store);
  }
  auto body = make_body_geometry(scene, progress);
  require_buildable(request, scene, body, progress);
  const auto contents = describe_problem(scene, std::move(body), columns, progress);
  require_solvable(contents);  // before the store takes its room
  return GreenStore::create(request.store, contents);
}

SolveReport solve_missing_columns(GreenStore& store, ProgressBar& progress) {
  progress.begin("solve");
  const auto missing = store.missing_columns().size();
  const auto report = solve_green_functions(store, [&](const FillProgress& at) { progress.update(at.fraction); });
  progress.end(fmt::format("{} columns, {} of them from the store, asymmetry {:.1e}", store.column_count(),
                           static_cast<std::size_t>(store.column_count()) - missing, report.largest_asymmetry));
  return report;
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

/// Surface nodes that may be touched.
std::vector<int> touched_nodes(const GreenStoreContents& contents) {
  std::vector<int> touched;
  for (std::size_t i = 0; i < contents.flags.size(); ++i) {
    if ((contents.flags[i] & layout::node_touchable) != 0) touched.push_back(static_cast<int>(i));
  }
  return touched;
}

/// What lessens the mesh error of a contact of one size. Elements of half the length have about half of it.
std::string better_mesh(const Scene& scene, double error) {
  if (scene.elements == Elements::linear) return "[solve] elements = \"quadratic\" lessens it most";
  if (scene.mesh.tetrahedra) return "tetrahedra half as long about halve it";
  const int levels =
      scene.remesh.levels + static_cast<int>(std::ceil(std::log2(error / scene.accuracy.tolerated_mesh_error())));
  const char* const halving = "each further level about halves it";
  return levels <= most_levels ? fmt::format("{}: remesh.levels = {} should do", halving, levels)
                               : fmt::format("{}; no remesh.levels up to {} would do", halving, most_levels);
}

std::string asked_of_mesh(const AccuracyGoal& accuracy) {
  if (accuracy.mesh_error) return fmt::format("accuracy.mesh_error = {} asks for less", *accuracy.mesh_error);
  return fmt::format(
      "accuracy.patch_force = {} bounds the compression error, which is apart from it; accuracy.mesh_error would have "
      "it judged",
      accuracy.patch_force);
}

MeshError measure_mesh(const Scene& scene, const GreenStore& store, ProgressBar& progress) {
  progress.begin("mesh error");
  const GreenStoreContents& contents = store.contents();
  MeshError error = estimate_mesh_error(fem_problem(contents), touched_nodes(contents),
                                        [&](double fraction) { progress.update(fraction); });
  const std::string found =
      fmt::format("forces of pressed patches up to {}{:.3g} % too large, extrapolated from quadratic elements",
                  error.settled ? "" : "more than ", 100 * error.force());
  progress.end(found);
  if (error.force() > scene.accuracy.tolerated_mesh_error()) {
    const Eigen::Vector3d& at = error.patches.front().center;
    progress.warn(fmt::format(
        "mesh error: {}, the worst at ({:.3g}, {:.3g}, {:.3g}) m; {}. For contacts of the same size in metres {}",
        found, at.x(), at.y(), at.z(), asked_of_mesh(scene.accuracy), better_mesh(scene, error.force())));
  }
  return error;
}

/// What was asked and is reached, at the speed that the scene states, or the nominal one.
json quality_record(const Scene& scene, std::span<const std::byte> bytes) {
  const ModelFile file = verified_model(AlignedBytes(bytes), scene.mesh.name);
  const Model model = Model::open(file.bytes.span()).model;
  const auto intent = Elastostatic::intended(model);
  const double speed = scene.budget.speed();
  return quality_of(file.view, {.arena_bytes = Elastostatic::required(model, intent.limits).bytes,
                                .us = static_cast<double>(intent.budget.work) / speed,
                                .asked_us = scene.budget.step_us(),
                                .speed = fmt::format("at {} units per us", speed)});
}

layout::Info scene_facts(const Scene& scene, double asymmetry) {
  layout::Info facts{};
  facts.young = scene.material.young;
  facts.poisson = scene.material.poisson;
  facts.store_asymmetry = asymmetry;
  facts.rate = static_cast<float>(scene.budget.rate);
  facts.share = static_cast<float>(scene.budget.share.value_or(0));
  facts.max_contacts = static_cast<std::uint32_t>(scene.budget.contacts);
  facts.step_work = static_cast<std::uint64_t>(scene.budget.asked_work().value_or(0));
  facts.coarsest_constraint_level = static_cast<std::uint32_t>(scene.coarsest_constraints);
  return facts;
}

BuiltModel compress(const Scene& scene, const GreenStore& store, double asymmetry, const std::string& provenance,
                    ProgressBar& progress) {
  progress.begin("compress");
  const auto& contents = store.contents();
  const std::vector<std::size_t> column_nodes(contents.column_node.begin(), contents.column_node.end());
  const CompressionInput input{.mesh = contents.surface,
                               .flags = contents.flags,
                               .area = contents.area,
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
                               .facts = scene_facts(scene, asymmetry),
                               .provenance = provenance,
                               .step_work = worst_step_work};
  const Progress update = [&](double fraction, std::string_view stage) { progress.update(fraction, stage); };
  auto built = scene.wavelet ? build_model(input, update) : build_with_best_wavelet(input, update);
  const auto& finest = built.report.levels.back();
  progress.end(
      fmt::format("{} wavelets, {:.1f} times fewer blocks, compression error: field {:.2f} % RMS, patch force {:.1f} %",
                  wavelet_name(built.model.info.wavelet),
                  static_cast<double>(finest.dense_blocks) / static_cast<double>(finest.kept_blocks),
                  100 * finest.field_rms_error, 100 * finest.patch_force_error));
  return built;
}

/// Puts what the scene's loads do into the model.
void load(const Scene& scene, GreenStore& store, ModelData& model, ProgressBar& progress) {
  progress.begin("loads");
  auto loads = load_displacements(scene, store);
  std::string names;
  for (const layout::LoadRecord& record : loads.records) {
    names += (names.empty() ? "" : ", ") + load_name(record);
  }
  if (scene.gravity) names += fmt::format("; a mass of {:.4g} kg", loads.records.front().resultant[0]);
  add_loads(std::move(loads.records), loads.displacement, model);
  progress.end(names);
}

}  // namespace

std::filesystem::path build_record_path(const std::filesystem::path& model) {
  return std::filesystem::path(model).replace_extension(".build.json");
}

BuildOutcome build_model_file(const BuildRequest& asked, ProgressBar& progress) {
  BuildRequest request = asked;
  const Scene scene = read_scene(request.scene);
  if (request.store.empty()) {
    request.store = scene.store.value_or(std::filesystem::path(request.model).replace_extension(".h5"));
  }
  const std::string mesh = mesh_bytes(scene);
  const std::string wanted = request_fingerprint(scene, mesh);
  if (auto record = up_to_date_record(request, wanted); !record.empty()) {
    record["up_to_date"] = true;
    return {.up_to_date = true, .record = std::move(record)};
  }

  require_build_files(request, scene);
  if (scene.elements == Elements::linear && scene.material.poisson > locking_poisson) {
    progress.warn(fmt::format(
        "material.poisson = {}: linear tetrahedra lock above {}: too stiff by about 10 % at 0.49 and 43 % at "
        "0.499 even where nothing is thin, by several times where it is; [solve] elements = \"quadratic\" does not",
        scene.material.poisson, locking_poisson));
  }
  auto store = open_or_create_store(request, scene, column_fingerprint(scene, mesh), progress);
  const json thickness = say_thickness(scene, store.contents(), progress);
  const SolveReport solved = solve_missing_columns(store, progress);
  require_shallow(store.contents().provenance, request.store.string() + ": provenance");
  json record = json::parse(store.contents().provenance);
  record["scene"] = request.scene.filename().string();
  record["solve"] = solve_record(solved, store);
  record["mesh_error"] = mesh_error_record(measure_mesh(scene, store, progress));

  json provenance = record;
  provenance["tool"] =
      fmt::format("greenloop {}.{}.{}", GREENLOOP_VERSION_MAJOR, GREENLOOP_VERSION_MINOR, GREENLOOP_VERSION_PATCH);
  provenance["request"] = wanted;
  provenance["scene_text"] = canonical_text(scene);
  provenance["solve"].erase("factor_seconds");  // the model's bytes do not depend on the clock
  provenance["solve"].erase("solve_seconds");
  provenance["solve"].erase("columns_solved");
  provenance["solve"].erase("factor_entries");  // known to who factorised only
  auto built = compress(scene, store, solved.largest_asymmetry, json_text(provenance, -1), progress);
  provenance["frontier"] = frontier_record(built.report);
  provenance["wavelets"] = wavelets_record(built.report);
  provenance["frontier_contacts"] = built.model.info.max_contacts;
  provenance["patches"] = built.report.patches;
  built.model.provenance = json_text(provenance, -1);
  if (scene.mesh.keep_vertex_map) built.model.vertices = vertex_map(scene.mesh, store.contents().surface);
  if (scene.gravity || !scene.pressures.empty()) load(scene, store, built.model, progress);
  if (!scene.budget.asked_work()) {
    built.model.info.step_work = worst_step_work(AlignedBytes(encode(built.model)).span()).back();
  }
  const auto plain = encode(built.model);
  const auto bytes = scene.ready ? ready_model(plain) : plain;
  require_work(scene, request.scene, least_work(bytes), LeastOf::this_wavelet);
  write_file(request.model, bytes);

  record["sizes"] = sizes_record(store.contents());
  record["thinnest_part"] = thickness;
  record["compression"] = compression_record(built.report, built.model.info.max_contacts);
  record["compression"]["wavelet"] = wavelet_name(built.model.info.wavelet);
  record["request"] = wanted;
  record["bytes"] = bytes.size();
  record["step_work"] = built.model.info.step_work;
  record["units_per_us"] = scene.budget.speed();
  record["period_us"] = 1e6 / scene.budget.rate;
  record["quality"] = quality_record(scene, bytes);
  record["verdict"] = record["quality"]["verdict"];
  record["warnings"] = progress.warnings();
  for (const auto& stage : progress.stages()) {
    record["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
  }
  if (!is_passed_on(request)) write_text_file(build_record_path(request.model), json_text(record) + "\n");
  return {.up_to_date = false, .bytes = bytes.size(), .dense_bytes = built.report.dense_bytes, .record = record};
}

}  // namespace greenloop::offline
