#pragma once

#include <filesystem>
#include <iosfwd>

namespace CLI {
class App;
}

namespace greenloop::offline {

/// `greenloop inspect MODEL [--json]`
struct InspectArguments {
  std::filesystem::path file;
  bool json = false;
};

/// Prints what a model file holds: counts, bytes against the dense matrix, measured errors, material, provenance; and
/// what its budget is on this machine, which steps are run for.
/// Returns the exit code. Throws std::runtime_error naming the file if it cannot be read or is not valid.
int run_inspect(const InspectArguments& arguments, std::ostream& out);

/// Adds the command; it sets `exit_code` when it runs. Both must outlive the parsing.
void add_inspect(CLI::App& parent, int& exit_code);

}  // namespace greenloop::offline
