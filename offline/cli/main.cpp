#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <system_error>

#include "formats/output/program.hpp"
#include "offline/cli/build_command.hpp"
#include "offline/cli/convert_command.hpp"
#include "offline/cli/inspect_command.hpp"
#include "offline/cli/simulate_command.hpp"
#include "offline/cli/verify_command.hpp"
#include "offline/report/report_command.hpp"

namespace {

/// As git does: `greenloop loop ...` runs the program greenloop-loop that stands beside this one. Returns only if there
/// is none.
void run_sibling(char** arguments) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto sibling = self.parent_path() / (std::string("greenloop-") + arguments[1]);
  if (std::filesystem::exists(sibling, error)) {
    execv(sibling.c_str(), arguments + 1);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && argv[1][0] != '-') {
    run_sibling(argv);
  }
  CLI::App app("Greenloop turns a mesh and a scene into a model that answers contact within a fixed budget.",
               "greenloop");
  app.footer("Also: greenloop loop, greenloop bench, greenloop stress, greenloop calibrate. Each command has --help.");
  app.require_subcommand(1);
  int exit_code = 0;
  greenloop::offline::add_build(app, exit_code);
  greenloop::offline::add_simulate(app, exit_code);
  greenloop::offline::add_inspect(app, exit_code);
  greenloop::offline::add_verify(app, exit_code);
  greenloop::offline::add_convert(app, exit_code);
  greenloop::offline::add_report(app, exit_code);
  return greenloop::run_program(app, argc, argv, [&] { return exit_code; });
}
