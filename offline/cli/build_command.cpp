#include "offline/cli/build_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "formats/output/json_text.hpp"
#include "formats/output/streams.hpp"
#include "offline/pipeline/build_model_file.hpp"
#include "offline/pipeline/build_motion_model.hpp"
#include "offline/pipeline/build_multigrid_model.hpp"
#include "offline/pipeline/model_quality.hpp"
#include "offline/scene/motion_scene.hpp"

namespace greenloop::offline {
namespace {

struct BuildArguments {
  BuildRequest request;
  bool json = false;
};

/// What the budget comes to at the speed that the scene states, or the nominal one.
void print_budget(const nlohmann::json& record) {
  const double work = record["step_work"];
  const double speed = record["units_per_us"], period = record["period_us"];
  print_result(fmt::format("budget: {} units a step, {:.4g} us at {} units per us; the period is {:.4g} us{}\n",
                           record["step_work"].dump(), work / speed, speed, period,
                           work > period * speed ? ": [budget] share would bound it" : ""));
}

void print_outcome(const BuildArguments& arguments, const BuildOutcome& outcome) {
  if (arguments.json) {
    print_result(json_text(outcome.record) + "\n");
    return;
  }
  const auto& model = arguments.request.model;
  if (outcome.up_to_date) {
    print_result(model.string() + " is up to date\n");
    return;
  }
  print_result(
      fmt::format("{}: {} bytes; the dense matrix has {}\n", model.string(), outcome.bytes, outcome.dense_bytes));
  std::ostringstream quality;
  print_quality(outcome.record["quality"], quality);
  print_result(quality.str());
  print_budget(outcome.record);
}

void print_motion(const std::filesystem::path& model, const nlohmann::json& record) {
  print_result(fmt::format("{}: {} bytes, {} modes, {} states; truncation error {:.3g} %, quantisation {:.3g} %\n",
                           model.string(), record["bytes"].dump(), record["modes"].dump(), record["rows"].dump(),
                           100 * record["truncation_error"].get<double>(),
                           100 * record["reduction"]["quantisation_error"].get<double>()));
  const auto& replay = record["replay_error"];
  if (replay.is_null()) return;
  print_result(fmt::format("replay of {} held-out orbits: error {:.3g} % median, {:.3g} % in 95 of 100\n",
                           replay["orbits"].dump(), 100 * replay["median"].get<double>(),
                           100 * replay["p95"].get<double>()));
}

int build_motion(const BuildArguments& arguments, const MotionScene& scene, ProgressBar& progress) {
  const auto& request = arguments.request;
  if (!request.store.empty() || request.overwrite_store) {
    throw std::runtime_error(request.scene.string() + ": is made of trajectories, not of a store; leave --store out");
  }
  const auto record = build_motion_model(request.scene, scene, request.model, progress);
  arguments.json ? print_result(json_text(record) + "\n") : print_motion(request.model, record);
  return 0;
}

int build_multigrid(const BuildArguments& arguments, const MultigridBody& body, ProgressBar& progress) {
  const auto& request = arguments.request;
  if (!request.store.empty() || request.overwrite_store) {
    throw std::runtime_error(request.scene.string() + ": is simulated in the loop and has no store; leave --store out");
  }
  const auto record = build_multigrid_model(request.scene, body, request.model, progress);
  print_result(arguments.json
                   ? json_text(record) + "\n"
                   : fmt::format("{}: {} bytes, {} tetrahedra on {} grids; a step takes at least {} units, {} "
                                 "for each cycle more\n",
                                 request.model.string(), record["bytes"].dump(), record["tetrahedra"].dump(),
                                 record["grids"].dump(), record["least_work"].dump(), record["cycle_work"].dump()));
  return 0;
}

int run_build(BuildArguments& arguments) {
  auto& request = arguments.request;
  if (request.model.empty()) {
    request.model = request.scene.filename().replace_extension(".gloop");
  }
  ProgressBar progress(arguments.json);
  if (const auto motion = read_motion_scene(request.scene)) return build_motion(arguments, *motion, progress);
  if (const auto body = read_multigrid_scene(request.scene)) return build_multigrid(arguments, *body, progress);
  print_outcome(arguments, build_model_file(request, progress));
  return 0;
}

}  // namespace

void add_build(CLI::App& parent, int& exit_code) {
  auto* command = parent.add_subcommand("build", "Build a model file from a scene; resumes after a kill");
  auto arguments = std::make_shared<BuildArguments>();
  auto& request = arguments->request;
  command->add_option("scene", request.scene, "The scene, a TOML file")->required()->check(CLI::ExistingFile);
  command->add_option("-o,--output", request.model, "The model file to write [SCENE.gloop in this folder]");
  command->add_option("--store", request.store,
                      "HDF5 store of the exact Green's functions [as the scene says, else beside the model]");
  command->add_flag("--overwrite-store", request.overwrite_store,
                    "Replace a store that is damaged or belongs to another scene");
  command->add_flag("--allow-large", request.allow_large, "Even if the store or the memory take more than 5 GB");
  command->add_flag("--force", request.force, "Compress and write again even if the model is up to date");
  command->add_flag("--json", arguments->json, "Print the record of the build as JSON, no progress");
  command->callback([arguments, &exit_code] { exit_code = run_build(*arguments); });
}

}  // namespace greenloop::offline
