#include "formats/output/program.hpp"

#include <CLI/CLI.hpp>
#include <exception>
#include <sstream>

#include "formats/output/streams.hpp"

namespace greenloop {
namespace {

void add_version(CLI::App& app) { app.set_version_flag("--version", program_version(), "Print the version and exit"); }

/// Help, the version, or what is wrong.
int say_usage(const CLI::App& app, const CLI::ParseError& error) {
  std::ostringstream out, errors;
  const bool wrong = app.exit(error, out, errors) != 0;
  say(errors.str());
  print_result(out.str());
  return wrong ? 2 : 0;
}

int run_parsed(CLI::App& app, int argc, char** argv, const std::function<int()>& run) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return say_usage(app, error);
  }
  return run();
}

/// What `work` returns; 1 if it throws.
int guarded(const CLI::App& app, const std::function<int()>& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    say(app.get_name() + ": " + error.what() + "\n");
  }
  return 1;
}

}  // namespace

std::string program_version() { return "greenloop " GREENLOOP_VERSION; }

int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& run) {
  prepare_streams();
  add_version(app);
  for (CLI::App* const command : app.get_subcommands({})) add_version(*command);
  const int status = guarded(app, [&] { return run_parsed(app, argc, argv, run); });
  const int told = guarded(app, [] {
    finish_results();
    return 0;
  });
  return status != 0 ? status : told;
}

}  // namespace greenloop
