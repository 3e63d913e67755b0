#include "offline/pipeline/build_motion_model.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <string>

#include "formats/output/json_text.hpp"
#include "formats/output/output_file.hpp"
#include "formats/output/output_paths.hpp"
#include "formats/write/nested_json.hpp"
#include "offline/pipeline/motion_appearance.hpp"
#include "offline/reduce/impulse_model.hpp"
#include "offline/reduce/replay.hpp"
#include "runtime/greenloop.h"

namespace greenloop::offline {
namespace {

using nlohmann::json;

constexpr std::size_t shown_singular_values = 64;

json replay_record(const std::vector<double>& errors) {
  if (errors.empty()) return nullptr;
  return {{"orbits", errors.size()},
          {"seconds", replay_seconds},
          {"median", quantile(errors, 0.5)},
          {"p95", quantile(errors, 0.95)},
          {"worst", errors.back()}};
}

json penetration_record(const PenetrationCount& count) {
  return {{"frames", count.frames},
          {"crossing_frames", count.crossing_frames},
          {"crossings", count.crossings},
          {"inside_frames", count.inside_frames},
          {"deepest", count.deepest}};
}

json penetrations_record(const std::optional<ReplayPenetrations>& penetrations) {
  if (!penetrations) return nullptr;
  return {{"simulated", penetration_record(penetrations->simulated)},
          {"replayed", penetration_record(penetrations->replayed)}};
}

json dead_ends_record(const std::vector<DeadEnd>& dead_ends) {
  json record = json::array();
  for (const DeadEnd& end : dead_ends) record.push_back({{"orbit", end.source_orbit}, {"distance", end.distance}});
  return record;
}

json provenance_of(const TrajectoryScene& trajectories, const std::string& file) {
  require_shallow(trajectories.provenance, file + ": provenance");
  const json parsed = json::parse(trajectories.provenance, nullptr, false);
  return parsed.is_discarded() ? json(trajectories.provenance) : parsed;
}

/// What the model stands for, of what the trajectories hold.
json reduction_record(const ImpulseModel& model) {
  std::vector<double> singular_values = model.singular_values;
  if (singular_values.size() > shown_singular_values) singular_values.resize(shown_singular_values);
  return {{"singular_values", singular_values},
          {"unread", model.unread},
          {"dead_ends", dead_ends_record(model.dead_ends)},
          {"quantisation_error", model.data.info.quantisation_error},
          {"bits", 8 * model.data.info.planes}};
}

ImpulseModelGoal goal_of(const MotionScene& scene) {
  ImpulseModelGoal goal;
  goal.reduction.truncation = scene.truncation;
  goal.reduction.memory = scene.memory;
  goal.quantisation = scene.quantisation;
  goal.dead_end = scene.dead_end;
  goal.blend_rate = scene.blend_rate;
  goal.rate = scene.rate.value_or(0);
  if (scene.sheet) goal.rigid = scene.sheet->rigid;
  return goal;
}

void require_files(const std::filesystem::path& scene_file, const MotionScene& scene,
                   const std::filesystem::path& model, const std::filesystem::path& record) {
  CommandFiles files{.inputs = {{"the scene", scene_file}, {"the trajectories", scene.trajectories}},
                     .outputs = {{"the model", model}}};
  if (!is_special(model)) files.outputs.push_back({"the record of the build", record});
  require_writable(files);
}

ImpulseModel reduced_model(const MotionScene& scene, const TrajectoryFile& file, ProgressBar& progress) {
  progress.begin("reduce");
  ImpulseModel model = build_impulse_model(file, goal_of(scene), [&](double part) { progress.update(part); });
  std::size_t modes = 0;
  for (const ModeGroupData& group : model.data.groups) modes += group.amplitudes.size();
  progress.end(fmt::format("{} modes of {} values, {} orbits, truncation error {:.3g} %, quantisation {:.3g} %", modes,
                           model.singular_values.size(), model.data.orbits.size(),
                           100 * model.data.groups.back().counts.truncation_error,
                           100 * model.data.info.quantisation_error));
  if (!model.dead_ends.empty()) {
    progress.warn(
        fmt::format("{} orbits were left out: they neither come to rest nor end near a state of another "
                    "orbit of their impulse; the first is orbit {}, {:.3g} m away",
                    model.dead_ends.size(), model.dead_ends.front().source_orbit, model.dead_ends.front().distance));
  }
  return model;
}

}  // namespace

json build_motion_model(const std::filesystem::path& scene_file, const MotionScene& scene,
                        const std::filesystem::path& model_file, ProgressBar& progress) {
  const auto record_file = std::filesystem::path(model_file).replace_extension(".build.json");
  require_files(scene_file, scene, model_file, record_file);
  const auto trajectories = TrajectoryFile::open(scene.trajectories);
  ImpulseModel model = reduced_model(scene, trajectories, progress);
  json record{{"kind", "impulse_response"},
              {"trajectories", provenance_of(trajectories.scene(), scene.trajectories.string())},
              {"scene_text", canonical_text(scene)},
              {"reduction", reduction_record(model)},
              {"replay_error", replay_record(model.replay_errors)},
              {"penetrations", penetrations_record(model.penetrations)}};
  if (scene.appearance) record["appearance"] = add_appearance(*scene.appearance, model.data, progress);
  record["tool"] =
      fmt::format("greenloop {}.{}.{}", GREENLOOP_VERSION_MAJOR, GREENLOOP_VERSION_MINOR, GREENLOOP_VERSION_PATCH);
  model.data.provenance = json_text(record, -1);
  const ModelFile file = encoded_file(model.data);
  write_file(model_file, file.bytes.span());

  record["scene"] = scene_file.filename().string();
  record["bytes"] = file.bytes.size();
  record["modes"] = file.view.impulse_response.modes;
  record["rows"] = file.view.impulse_response.info->rows;
  record["truncation_error"] = model.data.groups.back().counts.truncation_error;
  record["up_to_date"] = false;
  record["warnings"] = progress.warnings();
  for (const auto& stage : progress.stages()) {
    record["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
  }
  if (!is_special(model_file)) write_text_file(record_file, json_text(record) + "\n");
  return record;
}

}  // namespace greenloop::offline
