#pragma once

#include <filesystem>
#include <iosfwd>

namespace CLI {
class App;
}

namespace greenloop::offline {

/// `greenloop inspect MODEL [--provenance] [--json]`
struct InspectArguments {
  std::filesystem::path file;
  bool json = false;
  bool provenance = false;  ///< in the table too
};

/// Prints what a model file holds: what was asked and is reached (model_quality.hpp), counts, bytes against the dense
/// matrix, compression errors, material; and what its budget is on this machine, which steps are run for.
/// Returns the exit code. Throws std::runtime_error naming the file if it cannot be read or is not valid.
int run_inspect(const InspectArguments& arguments, std::ostream& out);

/// Adds the command; it sets `exit_code` when it runs. Both must outlive the parsing.
void add_inspect(CLI::App& parent, int& exit_code);

}  // namespace greenloop::offline
