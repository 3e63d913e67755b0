#include "offline/cli/simulate_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "formats/output/json_text.hpp"
#include "formats/output/streams.hpp"
#include "offline/pipeline/simulate_scene.hpp"

namespace greenloop::offline {
namespace {

struct SimulateArguments {
  SimulateRequest request;
  bool json = false;
};

int run_simulate(SimulateArguments& arguments) {
  auto& request = arguments.request;
  ProgressBar progress(arguments.json);
  const auto record = simulate_scene(request, progress);
  print_result(arguments.json
                   ? json_text(record) + "\n"
                   : fmt::format("{}: {} orbits, {} of them held out, {} frames of {} vertices\n",
                                 record["file"].get<std::string>(), record["orbits"].dump(), record["held_out"].dump(),
                                 record["frames"].dump(), record["vertices"].dump()));
  return 0;
}

}  // namespace

void add_simulate(CLI::App& parent, int& exit_code) {
  auto* command = parent.add_subcommand("simulate", "Simulate the motions of a scene; resumes after a kill");
  auto arguments = std::make_shared<SimulateArguments>();
  auto& request = arguments->request;
  command->add_option("scene", request.scene, "The scene, a TOML file with a [simulate] section")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("-o,--output", request.trajectories,
                      "The trajectory file to write or go on with, HDF5 [as the scene says in [trajectories]]");
  command->add_flag("--overwrite", request.overwrite, "Begin again even if there are trajectories");
  command->add_flag("--json", arguments->json, "Print the record as JSON, no progress");
  command->callback([arguments, &exit_code] { exit_code = run_simulate(*arguments); });
}

}  // namespace greenloop::offline
